"""The cup's path in the ground-truth simulation, and where the object is placed there."""

from dataclasses import replace

import numpy as np
import pytest

from app.operations.evaluation.ground_truth import ideal_path, planned_path, pour_into, pour_once
from app.operations.evaluation.placed_object import cell_for, place_object
from core.errors import MotionError
from core.geometry import transform_points
from core.imagination.cup import cup_pose, pivot_in_cup_m, pour_duration_s
from core.imagination.results import PourChoice
from core.parameters import Parameters
from core.progress import Reporter
from core.workers import RunHere
from hardware.cell.scene import pour_cell
from hardware.scanning.simulated import simulated_cell
from hardware.simulation.objects import builtin_object
from hardware.simulation.pour_outcome.candies import NO_CANDIES, Candies
from hardware.simulation.pour_outcome.driven_path import DrivenPath
from hardware.simulation.pour_outcome.outcome import TableOutcome
from hardware.simulation.pour_outcome.settings import OutcomeSettings
from hardware.simulation.pour_outcome.worlds import WORLDS

pytestmark = pytest.mark.system

POURING = Parameters().pouring
PIVOT_M = np.array([-0.05, -0.35, 0.2])


def test_the_cup_begins_upright_and_ends_as_imagined():
    path = ideal_path(POURING, PIVOT_M, 0.7)
    assert path.T_base_cup[0, 2, 2] == pytest.approx(1, abs=1e-6)
    assert path.T_base_cup[-1] == pytest.approx(
        cup_pose(POURING.cup, PIVOT_M, 0.7, POURING.gamma_0_rad), abs=1e-6
    )


def test_the_cup_is_tilted_just_above_the_pour_and_then_rotates_about_the_pivot_alone():
    path = ideal_path(POURING, PIVOT_M, 0.7)
    pivots = np.array(
        [transform_points(pose, pivot_in_cup_m(POURING.cup)[None])[0] for pose in path.T_base_cup]
    )
    rotating = path.times_s > path.times_s[-1] - pour_duration_s(POURING)
    assert pivots[rotating] == pytest.approx(np.tile(PIVOT_M, (rotating.sum(), 1)), abs=1e-6)
    assert pivots[0, 2] > PIVOT_M[2] + POURING.cup.length_m, "while it lies down it cannot touch the object"
    on_its_rim = [lowest_m(POURING.cup, pose) for pose in path.T_base_cup[:100]]
    assert on_its_rim == pytest.approx(100 * [PIVOT_M[2] + 0.03], abs=1e-3), "as low as an arm's"
    steps_m = np.linalg.norm(np.diff(path.T_base_cup[:, :3, 3], axis=0), axis=1)
    assert steps_m.max() / np.diff(path.times_s).min() < 0.5


def lowest_m(cup, T_base_cup):
    """Height of the lowest of many points of both ends."""
    angles = np.linspace(0, 2 * np.pi, 721)
    base_m, mouth_m = cup.base_inner_radius_m + cup.wall_m, cup.mouth_radius_m
    ends = [
        np.column_stack([r * np.cos(angles), r * np.sin(angles), np.full(len(angles), z)])
        for r, z in ((base_m, 0.0), (mouth_m, cup.length_m))
    ]
    return transform_points(T_base_cup, np.concatenate(ends))[:, 2].min()


def test_the_arm_pours_as_imagined_but_no_faster():
    bowl = place_object(builtin_object("bowl"), "mesh", 0).true
    aabb_m = np.array([bowl.aabb_min_m, bowl.aabb_max_m])
    middle_m = aabb_m.mean(axis=0)
    pivot_m = np.array([middle_m[0] + 0.02, middle_m[1], aabb_m[1, 2] + 0.01])
    choice = PourChoice(0, 0, 0.0, pivot_m, cup_pose(POURING.cup, pivot_m, 0.0, 0.0))
    cell = pour_cell(simulated_cell())
    path = planned_path(cell, aabb_m, choice, POURING)
    assert path.T_base_cup[0, 2, 2] == pytest.approx(1, abs=1e-4), "upright"
    imagined = cup_pose(POURING.cup, pivot_m, 0.0, POURING.gamma_0_rad)
    assert path.T_base_cup[-1] == pytest.approx(imagined, abs=2e-3)
    ideal = ideal_path(POURING, pivot_m, 0.0)
    assert _rotating_s(path, pivot_m) >= _rotating_s(ideal, pivot_m) - 0.1
    with pytest.raises(MotionError):
        planned_path(cell, aabb_m, replace(choice, pivot_m=4 * pivot_m), POURING)


def _rotating_s(path: DrivenPath, pivot_m: np.ndarray) -> float:
    """How long the cup moves with its pivot where it was imagined."""
    mouth = np.array(
        [transform_points(pose, pivot_in_cup_m(POURING.cup)[None])[0] for pose in path.T_base_cup]
    )
    there = np.linalg.norm(mouth - pivot_m, axis=1) < 0.002
    return float(path.times_s[there][-1] - path.times_s[there][0])


@pytest.mark.parametrize("world", WORLDS.values(), ids=WORLDS)
def test_a_good_pour_spills_nothing_and_one_beside_the_object_everything(world):
    placed = place_object(builtin_object("bowl"), "mesh", 0)
    middle = (placed.true.aabb_min_m + placed.true.aabb_max_m) / 2
    top_m = placed.true.aabb_max_m[2] + 0.01
    pouring = POURING.model_copy(update={"n_pour": 12})

    def spilled(beside_m: float) -> list[int]:
        pivot_m = np.array([middle[0] + 0.02 + beside_m, middle[1], top_m])
        path, settings = ideal_path(pouring, pivot_m, 0.0), world.model_copy(update={"seed": 3})
        found = pour_into(placed, path, pouring, [settings], 2, RunHere(), Reporter())
        assert [one.n_candies for one in found] == [12, 12]
        assert not np.array_equal(found[0].scales, found[1].scales), "each pour has other candies"
        return [one.n_spilled for one in found]

    assert spilled(0.0) == [0, 0]
    assert spilled(0.2) == [12, 12]


def test_what_one_cup_brought_lies_in_the_object_when_the_next_is_poured():
    placed = place_object(builtin_object("bowl"), "mesh", 0)
    middle = (placed.true.aabb_min_m + placed.true.aabb_max_m) / 2
    pivot_m = np.array([middle[0] + 0.02, middle[1], placed.true.aabb_max_m[2] + 0.01])

    def poured(n_candies: int, seed: int, lying: Candies) -> TableOutcome:
        cup, settings = POURING.model_copy(update={"n_pour": n_candies}), OutcomeSettings(seed=seed)
        path = ideal_path(cup, pivot_m, 0.0)
        return pour_once(placed, path, cup, settings, 0, RunHere(), Reporter(), lying)

    first = poured(12, 3, NO_CANDIES)
    second = poured(8, 1003, first.lying)
    assert (first.n_candies, second.n_candies) == (12, 20)
    assert (second.n_in_object, second.n_spilled) == (20, 0)
    assert second.scales[8:] == pytest.approx(first.scales)
    assert not np.allclose(first.T_given_stood, second.T_given_stood), "each pour has errors of its own"
    begun, lay = second.recording.positions_m[0, 8:], first.lying.moved(second.T_given_stood)
    assert np.linalg.norm(begun - lay.positions_m, axis=1).max() < 0.003, "they stay where they lay"


def test_the_crop_box_grows_for_what_does_not_fit_and_for_nothing_else():
    mug, cell = builtin_object("mug"), simulated_cell()
    assert cell_for(mug).place == cell.place
    tall = type(mug)(mug.vertices_m * [1, 1, 3.3], mug.faces)
    assert cell_for(tall).place.crop_max_m[2] > cell.place.crop_max_m[2]
    long = type(mug)(mug.vertices_m * [5, 1, 1], mug.faces)
    width_m = cell_for(long).place.crop_max_m[0] - cell_for(long).place.crop_min_m[0]
    assert width_m > long.extents_m[0]
    placed = place_object(long, "scan", 5)
    assert (placed.true.aabb_min_m[:2] > placed.place.crop_min_m[:2]).all()
    assert (placed.true.aabb_max_m[:2] < placed.place.crop_max_m[:2]).all()
