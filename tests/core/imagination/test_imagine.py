from dataclasses import replace

import numpy as np
import pytest

from core.errors import StageError
from core.imagination.body import body_files
from core.imagination.cup import cup_parts
from core.imagination.cup_run import packing_task
from core.imagination.pours import Pour, full_task, replay_task
from core.imagination.results import Drop, PourGrid
from core.parameters import Parameters, apply_settings
from core.pipeline.in_memory import imagine
from core.progress import Reporter
from core.workers import WorkerPool
from tests.core.imagination.here import at_rest


def same(one, other):
    """Whether two imaginations are the same to the last bit, recordings included."""
    drops = one.containability, other.containability
    pairs = [(drops[0].retained, drops[1].retained), (drops[0].drop_positions_m, drops[1].drop_positions_m)]
    recordings = [(drops[0].recording, drops[1].recording)]
    if one.grid is not None:
        pairs.append((one.grid.n_in, other.grid.n_in))
        for row, other_row in zip(one.grid.recordings, other.grid.recordings, strict=True):
            recordings += list(zip(row, other_row, strict=True))
    pairs += [(a.positions_m, b.positions_m) for a, b in recordings]
    pairs += [(a.quaternions, b.quaternions) for a, b in recordings]
    return all(np.array_equal(a, b, equal_nan=a.dtype.kind == "f") for a, b in pairs)


@pytest.fixture(scope="module")
def dish_imagined(dish, quick, pool):
    return imagine(dish, quick, pool, Reporter())


def test_a_dish_is_an_open_container_and_a_block_is_none(dish_imagined, block, quick, pool):
    assert dish_imagined.containability.omega > 0.3
    assert dish_imagined.containability.is_open_container
    solid = imagine(block, quick, pool, Reporter())
    assert solid.containability.omega < 0.1
    at_rest = apply_settings(quick, {"containability.omega_threshold": 0.2})
    refused = imagine(block, at_rest, pool, Reporter())
    assert (refused.grid, refused.choice) == (None, None)


def test_the_footprint_lies_along_the_dish(dish_imagined):
    footprint = dish_imagined.containability.footprint
    assert footprint.center_m == pytest.approx([0.35, -0.17, 0.14], abs=0.009)  # the pitch
    assert abs(footprint.axis_rad) < 0.15


def test_the_choice_pours_into_the_dish(dish_imagined):
    grid, choice = dish_imagined.grid, dish_imagined.choice
    assert grid.p.shape == (8, 3)
    assert grid.p[choice.i, choice.j] > 0.9
    assert grid.p[:, 2].min() < grid.p[:, 0].max()  # the outermost pours across the dish miss
    assert choice.T_world_cup[:3, 3] != pytest.approx(choice.pivot_m)


def test_results_do_not_depend_on_the_number_of_workers(dish_imagined, dish, quick):
    with WorkerPool(1) as alone:
        assert same(dish_imagined, imagine(dish, quick, alone, Reporter()))


def test_results_do_not_depend_on_the_order(dish, quick, pool):
    with body_files(object=(dish.parts, False), cup=(cup_parts(quick.pouring.cup), False)) as files:
        target = at_rest(dish, files["object"], quick)
        runs = pool.run([packing_task(files["cup"], quick, k) for k in range(2)], "cup", Reporter())
        pours = [Pour(np.array([0.35, -0.17, 0.15]), angle) for angle in np.linspace(0, 5, 6)]
        tasks = [
            replay_task(target, runs[k % 2], pour.T_world_E, quick, True) for k, pour in enumerate(pours)
        ]
        tasks += [packing_task(files["cup"], quick, 0)]
        straight = pool.run(tasks, "pours", Reporter())
        order = np.random.default_rng(3).permutation(len(tasks))
        shuffled = pool.run([tasks[k] for k in order], "pours", Reporter())
    for place, k in enumerate(order):
        one, other = straight[k], shuffled[place]
        assert getattr(one, "n_in", None) == getattr(other, "n_in", None)
        for field in ("positions_m", "quaternions", "T_world_body"):
            a, b = getattr(one.recording, field), getattr(other.recording, field)
            assert np.array_equal(a, b, equal_nan=True)


def test_another_seed_gives_another_drop(dish_imagined, dish, quick, pool):
    other = imagine(dish, quick.model_copy(update={"seed": 1}), pool, Reporter())
    assert not same(dish_imagined, other)
    assert other.containability.omega == pytest.approx(dish_imagined.containability.omega, abs=0.1)


@pytest.mark.system
def test_replayed_pours_agree_with_cup_and_object_together(dish, quick, pool):
    """Over cells where some candies miss; the seed noise of one cell is the spread over the packings."""
    parameters = apply_settings(quick, {"pouring.n_pour": 40, "pouring.n_packings": 4})
    packings = range(parameters.pouring.n_packings)
    center = np.array([0.35, -0.17, 0.15])
    angles_and_indents = [(0.0, 0.01), (np.pi / 2, 0.04), (np.pi / 2, 0.05), (0.0, 0.07), (np.pi / 4, 0.06)]
    pours = [
        Pour(center + indent * np.array([np.cos(angle), np.sin(angle), 0]), angle)
        for angle, indent in angles_and_indents
    ]
    with body_files(object=(dish.parts, False), cup=(cup_parts(parameters.pouring.cup), False)) as files:
        target = at_rest(dish, files["object"], parameters)
        runs = pool.run([packing_task(files["cup"], parameters, k) for k in packings], "cup", Reporter())
        replayed = [
            replay_task(target, runs[k], pour.T_world_E, parameters, False)
            for pour in pours
            for k in packings
        ]
        full = [
            full_task(target, files["cup"], k, pour, parameters, False) for pour in pours for k in packings
        ]
        outcomes = pool.run([*replayed, *full], "pours", Reporter())
    counts = np.array([outcome.n_in for outcome in outcomes]).reshape(2, len(pours), len(packings))
    means, spreads = counts.mean(axis=2), counts.std(axis=2, ddof=1)
    noise = np.sqrt((spreads**2).sum(axis=0) / len(packings)) + 0.5
    assert (np.abs(means[0] - means[1]) < 3 * noise).all(), (counts, noise)
    assert means.min() < 36 and means.max() > 39, "the cells must differ to say something"


def test_theta_fixed_pours_from_one_direction(dish, quick, pool):
    fixed = apply_settings(quick, {"pouring.theta_fixed_rad": 1.0})
    result = imagine(dish, fixed, pool, Reporter())
    assert result.grid.p.shape == (1, 3)
    assert result.choice.theta_rad == 1.0


@pytest.mark.parametrize("shape", ["ellipsoid", "sphere"])
def test_other_candies_stay_in_a_dish_too(shape, dish, quick, pool):
    candies = {"particle.shape": shape, "particle.diameter_m": 0.012, "particle.height_m": 0.007}
    still = {"containability.rotation_rad": 0, "containability.translation_m_s2": 0}
    result = imagine(dish, apply_settings(quick, candies | still), pool, Reporter())
    assert result.containability.omega > 0.3


def test_an_object_smaller_than_a_candy_is_a_sentence(block, pool):
    huge = apply_settings(Parameters(), {"particle.shape": "sphere", "particle.diameter_m": 0.05})
    small = replace(
        block,
        parts=tuple(replace(p, vertices_m=p.vertices_m / 10) for p in block.parts),
        surface=replace(block.surface, vertices_m=block.surface.vertices_m / 10),
    )
    with pytest.raises(StageError, match="smaller than a candy"):
        imagine(small, huge, pool, Reporter())


def test_results_survive_saving(dish_imagined, tmp_path):
    dish_imagined.containability.save(tmp_path)
    dish_imagined.grid.save(tmp_path)
    drop, grid = Drop.load(tmp_path), PourGrid.load(tmp_path)
    assert drop.omega == dish_imagined.containability.omega
    assert (drop.retained == dish_imagined.containability.retained).all()
    assert drop.footprint.axis_rad == dish_imagined.containability.footprint.axis_rad
    assert (grid.n_in == dish_imagined.grid.n_in).all()
    kept, original = grid.recordings[2][1], dish_imagined.grid.recordings[2][1]
    gap = np.abs(kept.positions_m - original.positions_m)
    assert np.nanmax(gap) < 1e-4
    assert sum(path.stat().st_size for path in tmp_path.iterdir()) < 5e6
