"""Backing off after a stop: only along checked paths, whatever move was stopped, and where."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from core.errors import MotionError
from core.motion.pour.plan import MOVES, MovePhase, PlannedMove, PourPlan, Segment
from core.motion.pour.recovery import check_rejoining, on_the_way_back, plan_back_off
from core.motion.pour.scene import PourScene
from core.motion.trajectory import SAMPLE_S, JointTrajectory

CORNERS = np.cumsum(np.random.default_rng(3).uniform(-0.4, 0.4, (8, 6)), axis=0)


def a_move(start, goal, duration_s=1.0):
    u = np.linspace(0, 1, round(duration_s / SAMPLE_S) + 1)
    share = u * u * (3 - 2 * u)
    return JointTrajectory(np.arange(len(u)) * SAMPLE_S, start + share[:, None] * (goal - start))


@pytest.fixture(scope="module")
def plan():
    out = [a_move(CORNERS[k], CORNERS[k + 1]) for k in range(7)]
    everything = out + [part.reversed() for part in out[::-1]]
    moves = tuple(PlannedMove(n, p, t, h, g) for (n, p, h, g), t in zip(MOVES, everything, strict=True))
    return PourPlan(0, 0, moves, np.eye(4), 0.02, ("a", "b"), 0.005, 0.0, 0.1, 1.0, 1.0)


def samples(moves):
    return np.concatenate([move.trajectory.joints_rad for move in moves])


@pytest.mark.parametrize("index", range(14))
@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_it_leads_home_along_the_plan(plan, index, share):
    trajectory = plan.moves[index].trajectory
    stopped_rad = trajectory.joints_rad[int(share * (len(trajectory.times_s) - 1))]
    moves = plan_back_off(plan, plan.moves, index, stopped_rad)
    assert moves[0].trajectory.start_rad == pytest.approx(stopped_rad)
    assert moves[-1].trajectory.end_rad == pytest.approx(plan.start_rad)
    for before, after in pairwise(moves):
        assert before.trajectory.end_rad == pytest.approx(after.trajectory.start_rad)
    allowed = samples(plan.moves)
    for joints_rad in samples(moves)[::7]:
        assert np.abs(allowed - joints_rad).max(axis=1).min() < 0.005, "off every checked path"
    assert all(move.phase is MovePhase.BACK for move in moves)


@pytest.mark.parametrize("index", range(14))
def test_the_gripper_opens_once_if_the_cup_is_in_the_hand_and_never_closes(plan, index):
    moves = plan_back_off(plan, plan.moves, index, plan.moves[index].trajectory.joints_rad[40])
    actions = [move.gripper_after for move in moves if move.gripper_after]
    assert actions == (["open"] if plan.moves[index].holds_cup else [])


def test_a_cup_that_is_being_taken_is_let_go_before_the_arm_leaves_its_station(plan):
    index = next(k for k, move in enumerate(plan.moves) if move.gripper_after == "close")
    moves = plan_back_off(plan, plan.moves, index, plan.moves[index].trajectory.end_rad + 9e-4)
    assert moves[0].gripper_after == "open"
    assert np.ptp(moves[0].trajectory.joints_rad, axis=0).max() == 0
    assert not moves[1].gripper_after


def test_it_begins_and_ends_at_rest_and_is_slower_than_the_plan(plan):
    planned = plan.moves[3].trajectory
    first = plan_back_off(plan, plan.moves, 3, planned.joints_rad[60])[0].trajectory
    speeds = np.abs(np.diff(first.joints_rad, axis=0)).max(axis=1) / SAMPLE_S
    fastest = np.abs(np.diff(planned.joints_rad, axis=0)).max() / SAMPLE_S
    assert speeds[0] < 0.02 * fastest
    assert speeds[-1] < 0.02 * fastest
    assert speeds.max() < fastest


def test_an_arm_slightly_off_rejoins_its_path_slowly(plan):
    off_rad = plan.moves[3].trajectory.joints_rad[60] + [0.0, 0.03, 0.0, 0.0, 0.0, 0.0]
    join = plan_back_off(plan, plan.moves, 3, off_rad)[0]
    assert join.name is Segment.REJOIN
    assert join.label == "return to the path"
    assert join.trajectory.start_rad == pytest.approx(off_rad)
    assert join.holds_cup
    speeds = np.abs(np.diff(join.trajectory.joints_rad, axis=0)) / SAMPLE_S
    assert speeds.max() < 0.15


def test_an_arm_that_somebody_pushed_away_is_left_to_people(plan):
    far_rad = plan.moves[3].trajectory.joints_rad[60] + [0.0, 0.3, 0.0, 0.0, 0.0, 0.0]
    with pytest.raises(MotionError, match="by hand"):
        plan_back_off(plan, plan.moves, 3, far_rad)


def test_a_back_off_that_is_stopped_itself_continues_from_there(plan):
    moves = plan_back_off(plan, plan.moves, 5, plan.moves[5].trajectory.joints_rad[50])
    again = plan_back_off(plan, moves, 2, moves[2].trajectory.joints_rad[100])
    assert [move.name for move in again] == [move.name for move in moves[2:]]
    assert again[-1].trajectory.end_rad == pytest.approx(plan.start_rad)


@pytest.mark.parametrize("is_down", [True, False])
def test_joining_the_path_is_checked_for_what_is_in_between(mug, is_down):
    plan, scene = mug.plan, PourScene(mug.cell, mug.target.object_aabb_m, mug.target.pouring.cup)
    index = next(k for k, move in enumerate(plan.moves) if move.name is Segment.LOWER)
    end_rad = plan.moves[index].trajectory.end_rad
    aside_rad = np.array([0.0, 0.04, 0.0, 0.0, 0.0, 0.0])
    higher_m = scene.held_cups(np.array([end_rad + aside_rad, end_rad - aside_rad]))[:, 2, 3]
    is_plus = bool(higher_m[0] > higher_m[1]) != is_down
    moves = plan_back_off(plan, plan.moves, index, end_rad + (aside_rad if is_plus else -aside_rad))
    assert moves[0].name is Segment.REJOIN
    if not is_down:
        check_rejoining(mug.cell, mug.target, moves)
        return
    with pytest.raises(MotionError, match=r"the way to it is not clear: .* (cup|gripper).* Take the cup out"):
        check_rejoining(mug.cell, mug.target, moves)


def test_an_arm_is_found_on_the_way_back_with_the_cup_or_nowhere(plan):
    for index, move in enumerate(plan.moves):
        if move.holds_cup:
            found = on_the_way_back(plan, move.trajectory.joints_rad[60])
            assert found is not None
            assert plan.moves[found].phase is MovePhase.BACK
            back = plan_back_off(plan, plan.moves, found, move.trajectory.joints_rad[60])
            assert back[0].name == plan.moves[max(index, 13 - index)].name
    assert on_the_way_back(plan, plan.moves[3].trajectory.joints_rad[60] + 1.0) is None


def test_an_arm_that_was_pushed_close_to_the_object_may_leave_but_come_no_closer(mug):
    plan, scene = mug.plan, PourScene(mug.cell, mug.target.object_aabb_m, mug.target.pouring.cup)
    index = next(k for k, move in enumerate(plan.moves) if move.name is Segment.POUR)
    on_path_rad = plan.moves[index].trajectory.joints_rad[40]
    pushed_rad = on_path_rad + np.linspace(0, 0.1, 400)[:, None] * _towards_object(scene, on_path_rad)
    gap_m = scene.cup_clearance(scene.held_cups(pushed_rad), pushed_rad).distance_m
    close = int(np.flatnonzero((gap_m > 0) & (gap_m < mug.cell.limits.cup_clearance_m / 2))[0])
    leaving = plan_back_off(plan, plan.moves, index, pushed_rad[close])
    assert leaving[0].name is Segment.REJOIN
    check_rejoining(mug.cell, mug.target, leaving)
    joining = leaving[0].trajectory
    turned = replace(
        leaving[0], trajectory=replace(joining, joints_rad=2 * pushed_rad[close] - joining.joints_rad)
    )
    with pytest.raises(MotionError, match=r"the way to it is not clear: .* cup and object would"):
        check_rejoining(mug.cell, mug.target, (turned, *leaving[1:]))


def _towards_object(scene, joints_rad):
    """The shoulder's direction (6,) of turning that brings the held cup closer to anything."""
    shoulder = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    both = joints_rad + 0.01 * np.stack([shoulder, -shoulder])
    gap_m = scene.cup_clearance(scene.held_cups(both), both).distance_m
    return shoulder if gap_m[0] < gap_m[1] else -shoulder
