import numpy as np
import pytest

from core.geometry import make_pose, rotation_z
from core.imagination.packing import cup_holds
from core.imagination.risk import draw_set_up, with_scan_error
from core.imagination.set_up import as_planned
from core.parameters import Parameters, apply_settings
from core.pipeline.in_memory import imagine
from core.progress import Reporter
from core.workers import WorkerPool

CENTER_M = np.array([0.35, -0.17, 0.12])


@pytest.fixture(scope="module")
def tried(quick):
    """Few tries with large errors, over a dish that is small against them."""
    settings = {"risk.n_tries": 8, "risk.object_error_m": 0.02, "pouring.n_packings": 1}
    return apply_settings(quick, settings)


@pytest.fixture(scope="module")
def dish_tried(dish, tried, pool):
    return imagine(dish, tried, pool, Reporter())


def test_a_moved_object_sees_the_pour_where_it_is_to_itself():
    parameters = apply_settings(Parameters(), {"risk.object_error_m": 0.01, "risk.object_error_rad": 0.3})
    set_up = draw_set_up(parameters, 3, CENTER_M)
    T_base_E = make_pose(rotation_z(0.7), np.array([0.4, -0.2, 0.2]))
    seen = set_up.seen_from_object(T_base_E)
    assert set_up.T_base_moved @ seen == pytest.approx(T_base_E @ set_up.T_E_slipped)
    moved_center = set_up.T_base_moved[:3, :3] @ CENTER_M + set_up.T_base_moved[:3, 3]
    assert 0.0005 < np.linalg.norm(moved_center - CENTER_M) < 0.05, "it turns about its own middle"
    assert moved_center[2] == pytest.approx(CENTER_M[2]), "it stays on the platform"
    assert np.array_equal(as_planned(0).seen_from_object(T_base_E), T_base_E)


def test_errors_have_the_size_that_is_asked_for():
    parameters = apply_settings(
        Parameters(), {"risk.object_error_m": 0.005, "risk.cup_error_m": 0.002, "risk.candy_spread": 0.1}
    )
    drawn = [draw_set_up(parameters, k, CENTER_M) for k in range(400)]
    slips = np.array([one.T_E_slipped[:3, 3] for one in drawn])
    assert slips.std(axis=0) == pytest.approx([0.002] * 3, rel=0.15)
    scales = np.array([one.candy_scale for one in drawn])
    assert 0.9 <= scales.min() < 0.91
    assert scales.max() <= 1.1


def test_candies_that_the_cup_cannot_hold_are_not_drawn():
    parameters = apply_settings(Parameters(), {"risk.candy_spread": 0.4})
    drawn = [draw_set_up(parameters, k, CENTER_M) for k in range(20)]
    assert all(cup_holds(one.parameters(parameters)) for one in drawn)
    larger = apply_settings(parameters, {"particle.diameter_m": 0.0185, "particle.height_m": 0.0098})
    assert not cup_holds(larger), "some of the candies drawn at first were too large"


def test_a_scan_with_worse_poses_moves_the_object_farther():
    parameters = apply_settings(Parameters(), {"risk.object_error_m": 0.001})
    raised = with_scan_error(parameters, 0.012, 9)
    assert raised.risk.object_error_m == pytest.approx(np.hypot(0.001, 0.004))
    assert with_scan_error(parameters, None, 9) == parameters


def test_tries_are_spent_and_told(dish_tried, tried):
    risk, choice = dish_tried.risk, dish_tried.choice
    assert risk.n_tries.sum() == 24 + tried.risk.n_tries
    assert (risk.spilled[..., 0] == dish_tried.grid.n_spilled[..., 0]).all(), (
        "the pours themselves come first"
    )
    tried_with_errors = risk.n_tries > 1
    assert risk.spilled[tried_with_errors][:, 1:].max() > 0, "2 cm beside the plan something must be spilled"
    assert risk.clean_at_least[choice.i, choice.j] == risk.clean_at_least.max()


def test_the_risk_does_not_depend_on_the_number_of_workers(dish_tried, dish, tried):
    with WorkerPool(1) as alone:
        again = imagine(dish, tried, alone, Reporter())
    assert np.array_equal(again.risk.spilled, dish_tried.risk.spilled)


def test_without_tries_the_papers_rule_chooses(dish, quick, pool):
    plain = imagine(dish, apply_settings(quick, {"risk.n_tries": 0}), pool, Reporter())
    assert plain.risk is None
    assert (plain.choice.i, plain.choice.j) == (plain.paper_choice.i, plain.paper_choice.j)
