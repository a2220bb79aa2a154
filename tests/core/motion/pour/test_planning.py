"""Which pours can be made, and the reasons for those that cannot."""

from dataclasses import asdict

import numpy as np
import pytest

from core.errors import Cancelled, MotionError
from core.motion.clearance import axis_aligned_obstacle
from core.motion.pour.cell import PourCell
from core.motion.pour.feasibility import PourFeasibility
from core.motion.pour.planning import judge_pours, plan_pour
from core.progress import Reporter
from core.workers import WorkerPool
from tests.awake import within
from tests.core.motion.pour.stage import (
    BOXES,
    POURING,
    box_m,
    cell_with_limits,
    pours_onto,
    shipped_cell,
    target_of,
)

pytestmark = pytest.mark.system

A_SENTENCE_S = 10.0
"""Twice what is promised: other programs run during the tests."""


@pytest.fixture(scope="module")
def pool():
    with WorkerPool(2) as pool:
        yield pool


def judge(
    cell: PourCell, box: np.ndarray, pool: WorkerPool, reporter: Reporter | None = None
) -> tuple[PourFeasibility, ...]:
    thetas, pivots = pours_onto(box)
    return judge_pours(cell, box, thetas, pivots, POURING, cell.home_rad, pool, reporter or Reporter())


def plan(cell: PourCell, box: np.ndarray, i: int, j: int):
    return plan_pour(cell, target_of(box, i, j), cell.home_rad)


@pytest.fixture(scope="module")
def judged(pool) -> dict[str, tuple[PourFeasibility, ...]]:
    return {name: judge(shipped_cell(), box_m(name), pool) for name in BOXES}


@pytest.mark.parametrize("name", BOXES)
def test_every_object_has_several_feasible_directions(judged, name: str):
    assert [(pour.i, pour.j) for pour in judged[name]] == [(i, j) for i in range(8) for j in range(3)]
    assert len({pour.i for pour in judged[name] if pour.is_feasible}) >= 4


@pytest.mark.parametrize("name", BOXES)
def test_what_is_judged_feasible_can_be_planned_and_the_rest_cannot(judged, name: str):
    cell, box = shipped_cell(), box_m(name)
    fine = [pour for pour in judged[name] if pour.is_feasible]
    for pour in fine[::6]:
        made = plan(cell, box, pour.i, pour.j)
        assert (made.clearance_m, made.turn_s) == (pour.clearance_m, pour.turn_s)
        assert made.duration_s == pytest.approx(pour.duration_s)
    for pour in [pour for pour in judged[name] if not pour.is_feasible][:2]:
        with pytest.raises(MotionError) as error:
            plan(cell, box, pour.i, pour.j)
        assert str(error.value) == pour.reason


@pytest.mark.parametrize("name", BOXES)
def test_reasons_are_sentences_and_figures_are_numbers(judged, name: str):
    for pour in judged[name]:
        assert pour.is_feasible == (not pour.reason)
        assert np.isfinite([pour.clearance_m, pour.turn_s, pour.duration_s]).all()
        if pour.is_feasible:
            assert pour.clearance_m >= shipped_cell().limits.min_clearance_m
        else:
            assert pour.reason[0].isupper()
            assert pour.reason.endswith(".")


def test_same_with_one_worker(judged):
    with WorkerPool(1) as alone:
        assert judge(shipped_cell(), box_m("mug"), alone) == judged["mug"]


def test_saved_as_a_table(judged):
    pour = judged["mug"][0]
    assert PourFeasibility(**asdict(pour)) == pour


def test_progress_reaches_the_end(pool):
    reported = []

    class Listening(Reporter):
        def progress(self, stage: str, done: float, total: float) -> None:
            reported.append((stage, done / total))

    judge(shipped_cell(), box_m("mug"), pool, Listening())
    assert {stage for stage, _ in reported} == {"motion"}
    assert reported[-1][1] == pytest.approx(1)


def test_cancelled(pool):
    reporter = Reporter()
    reporter.cancel()
    with pytest.raises(Cancelled):
        judge(shipped_cell(), box_m("mug"), pool, reporter)


def test_object_out_of_reach_is_the_reason_for_every_pour(pool):
    far = box_m("mug") + np.array([0.0, -1.5, 0.0])
    with within(A_SENTENCE_S):
        pours = judge(shipped_cell(), far, pool)
    assert {pour.reason for pour in pours} == {
        "The arm cannot reach this pour, whichever side of the cup its hand is on."
    }


def refused(cell: PourCell, box: np.ndarray) -> str:
    """The reason why nothing can be poured in a cell."""
    with within(A_SENTENCE_S), pytest.raises(MotionError) as error:
        plan(cell, box, 0, 0)
    assert "\n" not in str(error.value)
    return str(error.value)


def test_station_out_of_reach_is_named():
    cell = shipped_cell(cup_station_m=np.array([-1.5, 0.1, 0.015]))
    assert "cannot reach the cup at its station" in refused(cell, box_m("mug"))


def test_station_inside_of_something_is_named():
    shelf = axis_aligned_obstacle("shelf", (-0.6, 0.0, 0.015), (-0.4, 0.2, 0.1))
    cell = shipped_cell()
    blocked = shipped_cell(obstacles=(*cell.obstacles, shelf))
    assert "the cup would stand in the shelf" in refused(blocked, box_m("mug"))
    sunk = shipped_cell(cup_station_m=cell.cup_station_m - [0, 0, 0.02])
    assert "the cup would stand in the table" in refused(sunk, box_m("mug"))
    on_it = box_m("mug") + np.array([-0.45, 0.45, 0])
    assert "the cup would stand in the object" in refused(cell, on_it)


def test_walled_in_station_is_named():
    walls = [axis_aligned_obstacle("wall", (-0.70, y, 0.0), (-0.30, y + 0.01, 0.5)) for y in (-0.01, 0.2)] + [
        axis_aligned_obstacle("lid", (-0.70, 0.0, 0.3), (-0.30, 0.2, 0.31))
    ]
    cell = shipped_cell()
    sentence = refused(shipped_cell(obstacles=(*cell.obstacles, *walls)), box_m("mug"))
    assert "at its station" in sentence


def test_start_that_touches_something_is_named():
    folded = np.radians([0.0, -90, 165, 0, 90, 0])
    with pytest.raises(MotionError, match=r"start of the move.*is not allowed"):
        plan_pour(shipped_cell(), target_of(box_m("mug"), 0, 0), folded)


@pytest.mark.parametrize(
    ("limits", "reason"),
    [
        ({"min_clearance_m": 0.2}, "are required"),
        ({"min_singularity": 0.2}, "In the move"),
        ({"lift_m": 0.4, "min_clearance_m": 0.1}, "are required"),
    ],
)
def test_limits_that_cannot_be_met_are_named(limits: dict[str, float], reason: str):
    assert reason in refused(cell_with_limits(**limits), box_m("mug"))


def test_slow_joints_make_a_slow_rotation_and_the_plan_says_so():
    slow = plan(cell_with_limits(pour_joint_speed_rad_s=0.3), box_m("mug"), 0, 1)
    assert slow.turn_s > 1.4 * slow.imagined_turn_s


def test_fast_limits_never_tear_the_samples_apart():
    fast = cell_with_limits(
        joint_speed_rad_s=np.pi,
        joint_acceleration_rad_s2=20.0,
        tool_speed_m_s=1.0,
        pour_joint_speed_rad_s=np.pi,
    )
    assert plan(fast, box_m("mug"), 0, 1).duration_s < 20
