"""A pour is over when no candy can leave any more: earlier than when all rest, and with the same outcome."""

from dataclasses import replace

import numpy as np
import pytest

from core.collision import CollisionModel
from core.imagination.bullet_world import BulletWorld
from core.imagination.capacity.finding import hollows_of_body
from core.imagination.cup_runs import CupRuns
from core.imagination.pours import Pour, PouredCup, in_turn_task, replay_task, target_of_pours
from core.parameters import Parameters, apply_settings
from tests.core.imagination.capacity.conftest import turned
from tests.core.imagination.here import here

FLOOR_M, RIM_M = 0.032, 0.092


@pytest.fixture(scope="module")
def goblet() -> CollisionModel:
    """A bowl, 60 mm deep and wide, on a stem of 30 mm: beside the stem is free room below the bowl."""
    profile = [
        (0, 0),
        (0.008, 0),
        (0.008, 0.03),
        (0.032, 0.03),
        (0.032, RIM_M),
        (0.03, RIM_M),
        (0.03, FLOOR_M),
    ]
    return CollisionModel.exact(turned([*profile, (0, FLOOR_M)]))


@pytest.fixture(scope="module")
def context():
    return here(apply_settings(Parameters(), {"pouring.n_pour": 6}))


@pytest.mark.parametrize(
    ("where", "position_m", "speed_m_s", "is_kept"),
    [
        ("rests on the floor", (0, 0, FLOOR_M + 0.0035), 0.0, True),
        ("rolls, 40 mm below the rim", (0.01, 0, 0.05), 0.5, True),
        ("could jump over the rim", (0.01, 0, 0.05), 0.7, False),
        ("on a heap above the rim", (0, 0, RIM_M + 0.001), 0.0, False),
        ("below the bowl, beside the stem", (0.02, 0, 0.015), 0.0, False),
        ("outside the wall", (0.036, 0, 0.05), 0.0, False),
        ("far outside", (0.5, 0.5, 0.05), 0.0, False),
        ("was taken out", (np.nan, np.nan, np.nan), np.nan, False),
    ],
)
def test_who_is_kept(context, goblet, where, position_m, speed_m_s, is_kept):
    hollows = hollows_of_body(context, goblet)
    assert hollows.keeps(np.array([position_m]), np.array([speed_m_s])).tolist() == [is_kept], where


def test_nothing_is_kept_where_a_candy_passes_the_floor(context):
    tube = turned([(0.03, 0), (0.032, 0), (0.032, 0.06), (0.03, 0.06), (0.03, 0)])
    hollows = hollows_of_body(context, CollisionModel.exact(tube))
    assert not np.isfinite(hollows.rim_m).any()


@pytest.mark.parametrize("settings", [{"solver.substeps": 1}, {}])
def test_the_released_physics_and_convex_parts_wait_for_rest(context, goblet, dish, settings):
    model = goblet if settings else dish
    assert hollows_of_body(context.reading(apply_settings(context.parameters, settings)), model) is None


def _counted_steps(monkeypatch, task):
    """The outcome of a task, and how many steps its worlds made."""
    made = []
    step = BulletWorld.step
    monkeypatch.setattr(BulletWorld, "step", lambda world: (made.append(1), step(world)))
    outcome = task.function(*task.arguments)
    monkeypatch.setattr(BulletWorld, "step", step)
    return outcome, len(made)


@pytest.mark.parametrize("is_try", [True, False])
@pytest.mark.parametrize("off_m", [0.0, 0.03])
def test_the_outcome_is_that_of_waiting_until_all_rest(monkeypatch, context, goblet, is_try, off_m):
    """Into the bowl, and half beside it, where some fall to the ground."""
    [run] = CupRuns().of_packings(context)
    pour = Pour(np.array([0.02 + off_m, 0.0, RIM_M + 0.02]), 0.0)
    target = target_of_pours(context, goblet)
    found = []
    for one in (target, replace(target, hollows=None)):
        cups = [PouredCup(run, pour.T_world_E)]
        task = in_turn_task(one, cups, context.parameters)
        if not is_try:
            task = replay_task(one, run, pour.T_world_E, context.parameters, record=True)
        found.append(_counted_steps(monkeypatch, task))
    (early, steps), (late, steps_to_rest) = found
    assert (early.n_in, early.n_spilled) == (late.n_in, late.n_spilled)
    assert (late.n_spilled > 0) == (off_m > 0)
    assert steps < steps_to_rest
    if not is_try:
        last_m = np.nanmax(np.abs(early.recording.positions_m[-1] - late.recording.positions_m[-1]))
        assert last_m < context.parameters.particle.diameter_m  # it ends with candies that look at rest
