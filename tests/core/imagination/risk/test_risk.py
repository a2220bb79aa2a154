import numpy as np
import pytest
from scipy.special import betaincinv

from core.geometry import make_pose, rotation_z
from core.imagination.packing import cup_holds
from core.imagination.risk.drawing import draw_cups, draw_set_up, with_camera_error, with_scan_error
from core.imagination.risk.result import PourRisk, lower_bound
from core.imagination.set_up import as_planned
from core.parameters import Parameters, apply_settings
from core.pipeline.in_memory import imagine
from core.progress import Reporter
from core.workers import WorkerPool

CENTER_M = np.array([0.35, -0.17, 0.12])
SMALL_CANDIES = {
    "containability.verdict": "capacity",
    "pouring.amount": "number",
    "pouring.n_packings": 1,
    "particle.diameter_m": 0.0119,
    "particle.height_m": 0.0063,
    "particle.mass_kg": 0.0006,
}
"""Of which the dish holds 119, and as many are poured as are asked for."""


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


def test_a_camera_that_is_calibrated_worse_moves_and_turns_the_object_farther():
    parameters = apply_settings(Parameters(), {"risk.object_error_m": 0.001, "risk.object_error_rad": 0.003})
    raised = with_camera_error(parameters, 0.002, 0.004)
    assert raised.risk.object_error_m == pytest.approx(np.hypot(0.001, 0.002))
    assert raised.risk.object_error_rad == pytest.approx(0.005)
    assert with_camera_error(parameters, 0.0, 0.0) == parameters


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


def test_several_cups_are_filled_from_one_bag_and_poured_into_one_object():
    parameters = apply_settings(Parameters(), {"risk.object_error_m": 0.005, "risk.candy_spread": 0.1})
    first, second, third = draw_cups(parameters, 3, 3, CENTER_M)
    alone = draw_set_up(parameters, 3, CENTER_M)
    assert first.packing == alone.packing and np.array_equal(first.T_E_slipped, alone.T_E_slipped)
    assert first.candy_scale == second.candy_scale == third.candy_scale != 1
    assert np.array_equal(first.T_base_moved, third.T_base_moved)
    assert len({one.packing for one in (first, second, third)}) == 3
    assert not np.array_equal(first.T_E_slipped, second.T_E_slipped), "it is grasped anew"


@pytest.fixture(scope="module")
def two_cups(dish, quick, pool):
    """150 candies for a dish that holds 119, in two cups of which the first fits."""
    errors = dict.fromkeys(("object_error_m", "object_error_rad", "cup_error_m", "cup_error_rad"), 0.0)
    settings = (
        SMALL_CANDIES
        | {f"risk.{name}": value for name, value in errors.items()}
        | {
            "risk.n_tries": 4,
            "risk.candy_spread": 0.0,
            "pouring.n_pour": 150,
        }
    )
    return imagine(dish, apply_settings(quick, settings), pool, Reporter())


@pytest.mark.system
def test_a_later_cup_runs_over_where_the_first_fits(two_cups):
    risk, n_cups = two_cups.risk, two_cups.grid.n_cups
    assert n_cups > 1 and risk.n_cups == n_cups
    tried = risk.n_tries >= 4
    assert tried.any() and (two_cups.grid.n_spilled[tried] == 0).all(), "there the first cup fits"
    assert (risk.n_clean[tried] == 0).all()
    assert risk.n_tries[two_cups.choice.i, two_cups.choice.j] > 0, "what nobody tried is not chosen"


@pytest.mark.system
def test_a_clean_first_cup_is_no_try_of_the_whole_amount(two_cups):
    planned = PourRisk.as_planned(two_cups.grid)
    assert (planned.n_tries == (two_cups.grid.n_spilled[..., 0] > 0)).all()
    assert np.isfinite(planned.mean_spilled).all()


@pytest.fixture(scope="module")
def doubtful(dish, quick, pool):
    """120 candies for a dish that holds 119, from one side."""
    settings = SMALL_CANDIES | {
        "risk.n_tries": 8,
        "risk.wanted_clean": 0.7,
        "pouring.n_pour": 120,
        "pouring.theta_fixed_rad": 0.0,
    }
    return imagine(dish, apply_settings(quick, settings), pool, Reporter())


@pytest.mark.system
def test_where_no_pour_is_sure_enough_fewer_candies_are_tried(doubtful, tmp_path):
    risk = doubtful.risk
    assert risk.clean_at_least.max() < 0.7
    assert risk.fewer is not None and risk.fewer.n_candies < 120
    assert risk.fewer.clean_at_least >= 0.7
    assert risk.fewer.n_clean <= risk.fewer.n_tries <= 12
    risk.save(tmp_path)
    assert PourRisk.load(tmp_path).fewer == risk.fewer


def test_where_a_pour_is_sure_enough_no_other_amount_is_tried(dish_tried):
    assert dish_tried.risk.clean_at_least.max() < 0.6 or dish_tried.risk.fewer is None


def test_the_lower_bound_is_the_quantile_of_the_beta_distribution():
    n_clean, n_tries = np.array([0, 0, 1, 13, 24, 12, 4990]), np.array([0, 5, 1, 13, 24, 24, 5000])
    wanted = betaincinv(n_clean + 1, n_tries - n_clean + 1, 0.05)
    np.testing.assert_allclose(lower_bound(n_clean, n_tries), wanted, rtol=1e-12)
