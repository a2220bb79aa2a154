"""The last check accepts a plan that is as it should be, and nothing else."""

from dataclasses import replace

import numpy as np
import pytest

from core.errors import MotionError
from core.geometry import rotation_z
from core.motion.clearance import axis_aligned_obstacle
from core.motion.kinematics import branch_of, flange_pose, inverse_kinematics
from core.motion.pour.plan import PourPlan, Segment
from core.parameters.imagination import PouringParameters
from tests.core.motion.pour.stage import POURING, Planned, planned, with_move


def joints_of(pour: Planned, name: str) -> np.ndarray:
    return pour.move(name).trajectory.joints_rad.copy()


def test_accepts_what_was_planned(pour: Planned):
    pour.check()


def test_refuses_a_shifted_sample(mug: Planned):
    joints = joints_of(mug, "carry")
    joints[len(joints) // 2, 1] += 0.001
    with pytest.raises(MotionError, match="'carry' a joint accelerates"):
        mug.check(with_move(mug.plan, "carry", joints))


def test_refuses_a_move_that_begins_elsewhere(mug: Planned):
    with pytest.raises(MotionError, match=r"'tilt' starts 0.57 degrees from the end of 'carry'"):
        mug.check(with_move(mug.plan, "lay", joints_of(mug, "lay") + 0.01))


def test_refuses_a_plan_that_rests_elsewhere(mug: Planned):
    with pytest.raises(MotionError, match="does not end at the home configuration"):
        mug.check(cell=replace(mug.cell, home_rad=mug.cell.home_rad + 0.1))


def test_refuses_moves_left_out_or_renamed(mug: Planned):
    without = replace(mug.plan, moves=mug.plan.moves[:3] + mug.plan.moves[4:])
    empty_handed = [replace(move, holds_cup=False) for move in mug.plan.moves]
    for plan in (without, replace(mug.plan, moves=tuple(empty_handed)), replace(mug.plan, moves=())):
        with pytest.raises(MotionError, match="not those of a pour"):
            mug.check(plan)


@pytest.mark.parametrize(
    "segment", [Segment.TO_CUP, Segment.CARRY, Segment.POUR, Segment.ROTATE_BACK, Segment.HOME]
)
def test_refuses_what_is_too_fast(mug: Planned, segment: Segment):
    joints = joints_of(mug, segment)
    moving = np.concatenate([[True], np.abs(np.diff(joints, axis=0)).max(axis=1) > 0])
    hurried = np.concatenate([joints[moving][:-1:3], joints[-1:]])
    with pytest.raises(MotionError, match=rf"'{segment.label}' .*(accelerates|moves|jumps|differ)"):
        mug.check(with_move(mug.plan, segment, hurried))


def test_refuses_a_turn_faster_than_imagined(mug: Planned):
    slower = POURING.model_copy(update={"turn_s": 3.0})
    with pytest.raises(MotionError, match="'pour' the cup rotates faster than imagined"):
        _check_with(mug, slower)


def test_refuses_another_angle_and_a_shorter_rest(mug: Planned):
    with pytest.raises(MotionError, match="whole imagined angle"):
        _check_with(mug, POURING.model_copy(update={"gamma_0_rad": 1.0}))
    with pytest.raises(MotionError, match="is not at rest as long"):
        _check_with(mug, POURING.model_copy(update={"wait_s": 1.0}))


def _check_with(pour: Planned, pouring: PouringParameters) -> None:
    pour.check(pouring=pouring)


def test_refuses_other_times(mug: Planned):
    moves = list(mug.plan.moves)
    for k in (3, 10):
        trajectory = moves[k].trajectory
        faster = replace(moves[k], trajectory=replace(trajectory, times_s=trajectory.times_s / 2))
        with pytest.raises(MotionError, match="not sampled every 8 ms"):
            mug.check(replace(mug.plan, moves=(*moves[:k], faster, *moves[k + 1 :])))


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_refuses_what_is_no_number(mug: Planned, value: float):
    joints = joints_of(mug, "carry")
    joints[5, 2] = value
    with pytest.raises(MotionError, match="'carry'"):
        mug.check(with_move(mug.plan, "carry", joints))


def test_refuses_an_object_that_has_moved(mug: Planned):
    with pytest.raises(MotionError, match=r"and object would (touch|come within)"):
        mug.check(object_aabb_m=mug.target.object_aabb_m + np.array([0, 0, 0.05]))


def test_refuses_an_obstacle_in_the_way(mug: Planned):
    carry = joints_of(mug, "carry")
    middle = (flange_pose(mug.cell.arm, carry[len(carry) // 2]) @ mug.cell.T_flange_grasp)[:3, 3]
    lamp = axis_aligned_obstacle("lamp", middle - 0.02, middle + 0.02)
    with pytest.raises(MotionError, match="lamp would touch"):
        mug.check(cell=replace(mug.cell, obstacles=(*mug.cell.obstacles, lamp)))


def test_refuses_an_obstacle_that_only_the_cup_meets(mug: Planned):
    """A needle in the cup's place above the station: the hand passes at its side."""
    above = mug.cell.cup_station_m + np.array([0, 0, mug.cell.limits.lift_m + 0.095])
    needle = axis_aligned_obstacle("needle", above - 0.001, above + 0.001)
    with pytest.raises(MotionError, match="'lift' cup and needle would touch"):
        mug.check(cell=replace(mug.cell, obstacles=(*mug.cell.obstacles, needle)))


def test_refuses_another_station(mug: Planned):
    beside = mug.cell.cup_station_m + np.array([0.01, 0, 0])
    with pytest.raises(MotionError, match=r"10.0 mm from the cup's station"):
        mug.check(cell=replace(mug.cell, cup_station_m=beside))


def test_refuses_another_pivot_or_direction(mug: Planned):
    with pytest.raises(MotionError, match=r"'pour' the pivot moves by 1.00 mm"):
        mug.check(pivot_m=mug.target.pivot_m + np.array([0, 0.001, 0]))
    with pytest.raises(MotionError, match="does not rotate about the pour's axis alone"):
        mug.check(theta_rad=mug.target.theta_rad + 0.01)


def test_refuses_a_cup_that_sits_otherwise(mug: Planned):
    turned, sunk, leaning = (mug.plan.T_grasp_cup.copy() for _ in range(3))
    turned[:3, :3] = turned[:3, :3] @ rotation_z(0.1)
    sunk[2, 3] -= 0.01
    leaning[2, 0] = 0.1
    with pytest.raises(MotionError, match="does not rotate about the pour's axis alone"):
        mug.check(replace(mug.plan, T_grasp_cup=turned))
    for wrong in (sunk, leaning):
        with pytest.raises(MotionError, match="does not sit in the hand as the cell file says"):
            mug.check(replace(mug.plan, T_grasp_cup=wrong))


def test_refuses_tighter_limits(mug: Planned):
    def with_limits(**limits: float):
        return replace(mug.cell, limits=mug.cell.limits.model_copy(update=limits))

    for limits, reason in [
        ({"min_clearance_m": mug.plan.clearance_m + 1e-4}, "would come within"),
        ({"cup_clearance_m": mug.plan.cup_clearance_m + 1e-4}, "cup and"),
        ({"min_singularity": mug.plan.singularity + 1e-4}, "singular"),
        ({"joint_speed_rad_s": 0.2}, "a joint moves"),
        ({"joint_acceleration_rad_s2": 0.5}, "a joint accelerates"),
        ({"tool_speed_m_s": 0.05}, "the hand moves"),
        ({"pour_acceleration_rad_s2": 1.0}, "'pour' a joint accelerates"),
    ]:
        with pytest.raises(MotionError, match=reason):
            mug.check(cell=with_limits(**limits))


def test_refuses_another_branch_and_a_whole_turn_more(mug: Planned):
    def other_branch(joints: np.ndarray) -> np.ndarray:
        branch = int(branch_of(mug.cell.arm, joints[0])) ^ 2
        return inverse_kinematics(mug.cell.arm, flange_pose(mug.cell.arm, joints), (branch,)).joints_rad[:, 0]

    with pytest.raises(MotionError, match="'lower' starts"):
        mug.check(with_move(mug.plan, "lower", other_branch(joints_of(mug, "lower"))))
    swapped = mug.plan
    for move in mug.plan.moves:
        if move.holds_cup:
            joints = np.unwrap(other_branch(move.trajectory.joints_rad), axis=0)
            swapped = with_move(swapped, move.name, joints)
    with pytest.raises(MotionError, match="starts"):
        mug.check(swapped)
    turned = mug.plan
    whole_turn = np.array([0, 0, 0, 0, 0, 2 * np.pi])
    for move in mug.plan.moves:
        turned = with_move(turned, move.name, move.trajectory.joints_rad + whole_turn)
    with pytest.raises(MotionError, match="does not end at the home configuration"):
        mug.check(turned)


def test_refuses_a_change_of_branch_with_the_cup(mug: Planned):
    """Joint 5 swings through 0 during the carry, slowly: everything else fits."""
    joints = joints_of(mug, "carry")
    swing = np.sin(np.linspace(0, np.pi, 4 * len(joints)))[:, None] ** 2
    far = joints[-1].copy()
    far[4] = -far[4]
    detour = joints[-1] + swing * (far - joints[-1])
    slow = np.concatenate([joints, detour[1:-1], joints[-1:]])
    with pytest.raises(MotionError, match=r"singular|changes its branch"):
        mug.check(with_move(mug.plan, "carry", slow))


def test_refuses_a_cup_that_tilts_while_it_is_carried(mug: Planned):
    joints = joints_of(mug, "carry")
    lean = np.sin(np.linspace(0, np.pi, 600))[:, None] ** 2 * np.radians(14)
    leaning = joints[-1] + lean * np.array([0, 0, 0, 1, 0, 0])
    leaning[-1] = joints[-1]
    with pytest.raises(MotionError, match=r"'carry' the cup tilts by 1\d\.\d degrees, where 10.0"):
        mug.check(with_move(mug.plan, "carry", np.concatenate([joints, leaning[1:]])))


def test_refuses_the_plan_of_another_object(mug: Planned):
    with pytest.raises(MotionError):
        mug.check(planned("bowl", 6, 0).plan)


def test_digest_changes_with_every_part(mug: Planned):
    plan = mug.plan
    joints = joints_of(mug, "carry")
    joints[7, 3] = np.nextafter(joints[7, 3], 1)
    others: list[PourPlan] = [
        with_move(plan, "carry", joints),
        replace(plan, clearance_m=plan.clearance_m + 1e-9),
        replace(plan, i=plan.i + 1),
        replace(plan, T_grasp_cup=np.eye(4)),
        replace(plan, moves=plan.moves[:-1]),
    ]
    assert len({plan.digest, *(other.digest for other in others)}) == len(others) + 1
