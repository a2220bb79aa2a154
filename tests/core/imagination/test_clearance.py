"""Of pours that look alike, the one whose candies fall farthest from the edge is tried first."""

import numpy as np
import pytest

from core.collision import CollisionModel
from core.imagination.clearance import clearances_m, clearest_first, entry_clearance_m
from core.imagination.hollow_map import HollowMap
from core.imagination.pours import target_of_pours
from core.imagination.recording import Recording
from core.parameters import Parameters, apply_settings
from core.pipeline.in_memory import imagine
from core.progress import Reporter
from tests.core.imagination.capacity.conftest import turned
from tests.core.imagination.here import here

RIM_M, PITCH_M, IN_M = 0.1, 0.001, 0.0066


@pytest.fixture
def box() -> HollowMap:
    """A hollow 60 mm wide from 0 to 0.06 m, in a map that reaches 20 mm farther on all sides."""
    cells = np.arange(-20, 81)
    inside = (cells >= 0) & (cells <= 60)
    held = inside[:, None] & inside[None, :]
    return HollowMap(
        np.array([-0.02, -0.02]), PITCH_M, np.where(held, RIM_M, -np.inf), np.where(held, 0.05, np.inf), held
    )


def falling(starts_m, ends_m) -> Recording:
    """A recording of candies that go straight from one place to another, and stay there."""
    starts, ends = np.array(starts_m, dtype=np.float32), np.array(ends_m, dtype=np.float32)
    positions = np.stack([starts, ends, ends])
    n_times, n_candies = positions.shape[:2]
    return Recording(
        np.arange(n_times, dtype=np.float32) / 24,
        positions,
        np.zeros((n_times, n_candies, 4), dtype=np.float32),
        np.tile(np.eye(4, dtype=np.float32), (n_times, 1, 1)),
    )


@pytest.mark.parametrize("edge_m", [0.005, 0.02])
def test_it_is_the_distance_from_the_edge_where_a_candy_is_below_the_rim(box, edge_m):
    straight = falling([(edge_m, 0.03, 0.15)], [(edge_m, 0.03, 0.06)])
    assert entry_clearance_m(straight, box, IN_M) == pytest.approx(edge_m, abs=1.5 * PITCH_M)


def test_between_two_moments_a_candy_goes_straight(box):
    # 60 mm down and 30 mm along: 6.6 mm below the rim it has gone 56.6 / 60 of the way.
    slanted = falling([(0.0, 0.03, 0.15)], [(0.03, 0.03, 0.09)])
    assert entry_clearance_m(slanted, box, IN_M) == pytest.approx(0.0283, abs=1.5 * PITCH_M)


def test_what_falls_beside_or_stays_on_the_rim_is_at_the_edge(box):
    beside = falling([(-0.01, 0.03, 0.15)], [(-0.01, 0.03, 0.02)])
    resting = falling([(0.03, 0.03, 0.15)], [(0.03, 0.03, 0.097)])
    absent = falling([(np.nan, np.nan, np.nan)], [(np.nan, np.nan, np.nan)])
    assert [entry_clearance_m(one, box, IN_M) for one in (beside, resting, absent)] == [0.0, 0.0, 0.0]


def test_a_single_stray_candy_does_not_count_one_of_five_does(box):
    def of(n_stray):
        x = [0.002] * n_stray + [0.03] * (20 - n_stray)
        return entry_clearance_m(
            falling([(one, 0.03, 0.15) for one in x], [(one, 0.03, 0.06) for one in x]), box, IN_M
        )

    assert of(1) == pytest.approx(0.03, abs=1.5 * PITCH_M)
    assert of(4) == pytest.approx(0.002, abs=1.5 * PITCH_M)


def test_a_recording_that_was_kept_has_the_same(box):
    generator = np.random.default_rng(3)
    starts = generator.uniform((0, 0, 0.12), (0.06, 0.06, 0.15), (40, 3))
    fresh = falling(starts, starts - np.array([0, 0, 0.08]))
    kept = Recording.from_arrays(fresh.to_arrays())
    assert entry_clearance_m(kept, box, IN_M) == entry_clearance_m(fresh, box, IN_M)


def test_such_as_are_as_clear_keep_their_order():
    clearance_m = np.array([[0.01, 0.0297, 0.01], [0.02, 0.03, 0.0]])
    order = [(1, 2), (0, 0), (0, 1), (1, 0), (0, 2), (1, 1)]
    assert clearest_first(order, clearance_m) == [(0, 1), (1, 1), (1, 0), (0, 0), (0, 2), (1, 2)]
    assert clearest_first(order, np.zeros((2, 3))) == order, "none enters a hollow"


@pytest.fixture(scope="module")
def beaker() -> CollisionModel:
    profile = [(0, 0), (0.027, 0), (0.027, 0.08), (0.025, 0.08), (0.025, 0.002), (0, 0.002)]
    return CollisionModel.exact(turned(profile))


def test_the_clearest_of_equal_pours_is_tried_first(beaker):
    parameters = apply_settings(Parameters(), {"pouring.n_pour": 12, "pouring.amount": "number"})
    context = here(apply_settings(parameters, {"risk.n_tries": 4}))
    found = imagine(beaker, context.parameters, context.runner, Reporter())
    hollows = target_of_pours(context, beaker).hollows
    clearance_m = clearances_m(found.grid, hollows, parameters.particle.diameter_m)
    is_clean = found.grid.n_spilled.sum(axis=2) == 0
    assert is_clean.sum() > 1, "there is a choice"
    tried = np.argwhere(found.risk.n_tries > 1)
    assert len(tried) == 1
    assert clearance_m[tuple(tried[0])] >= 0.95 * clearance_m[is_clean].max() > 0
