"""The kinematic twin by the clock: it moves, stops and refuses as the real arm does."""

from __future__ import annotations

import time

import numpy as np
import numpy.typing as npt
import pytest

from core.motion.arm_models import UR5
from core.motion.kinematics import flange_pose
from core.motion.trajectory import JointTrajectory
from hardware.errors import MoveRefused, RobotError, RobotStopped
from hardware.grippers.simulated import SimulatedGripper
from hardware.interfaces import Kinematics, RobotState
from hardware.robots.kinematic import KinematicRobot

HOME = np.array([0.0, -1.5, -0.6, -2.25, 1.5, 0.7])
NEAR = HOME + np.array([0.4, -0.2, 0.1, 0.0, 0.3, -0.1])
SPEED, ACCELERATION = 1.0, 4.0
TIMES_S = np.arange(0, 0.8001, 0.008)
# Bent, so that leaving the way shows; at rest at both ends.
SHARE = (1 - np.cos(np.pi * TIMES_S / TIMES_S[-1])) / 2
TRAJECTORY = JointTrajectory(
    TIMES_S, HOME + np.outer(SHARE, NEAR - HOME) + np.outer(np.sin(np.pi * SHARE) ** 2, np.full(6, 0.05))
)


def robot(is_instant: bool = False) -> KinematicRobot:
    return KinematicRobot(Kinematics(UR5), HOME, is_instant)


def watch(arm: KinematicRobot, for_s: float) -> list[RobotState]:
    states = [arm.state()]
    while states[-1].time_s < states[0].time_s + for_s:
        time.sleep(0.002)
        states.append(arm.state())
    return states


def test_it_takes_its_time_and_arrives_exactly() -> None:
    arm = robot()
    began_s = time.monotonic()
    move = arm.move_joints([HOME, NEAR], SPEED, ACCELERATION)
    assert not move.is_done
    move.wait(5.0)
    assert time.monotonic() - began_s >= 0.4 / SPEED + SPEED / ACCELERATION
    state = arm.state()
    assert move.is_done
    assert move.progress == 1
    np.testing.assert_array_equal(state.joints_rad, NEAR)
    np.testing.assert_array_equal(state.joint_speeds_rad_s, 0)
    np.testing.assert_allclose(state.T_base_flange, flange_pose(UR5, NEAR))


def test_progress_only_grows() -> None:
    arm = robot()
    move = arm.move_joints([HOME, NEAR, HOME], SPEED, ACCELERATION)
    seen = []
    while not move.is_done:
        seen.append(move.progress)
        time.sleep(0.005)
    assert len(seen) > 10
    assert (np.diff([0.0, *seen, move.progress]) >= 0).all()
    assert 0.2 < seen[len(seen) // 2] < 0.8
    assert move.progress == 1


@pytest.mark.parametrize("by", ["move", "robot"])
def test_stopped_on_its_way_it_slows_down_without_a_jump(by: str) -> None:
    arm = robot()
    move = arm.move_joints([HOME, NEAR], SPEED, ACCELERATION)
    time.sleep(0.3)
    at_stop = arm.state()
    assert np.abs(at_stop.joint_speeds_rad_s).max() > 0.5
    (move if by == "move" else arm).stop()
    states = [at_stop, *watch(arm, SPEED / ACCELERATION + 0.05)]
    times = np.array([state.time_s for state in states])
    joints = np.array([state.joints_rad for state in states])
    speeds = np.array([np.abs(state.joint_speeds_rad_s).max() for state in states])
    steps_s = np.diff(times)
    assert (np.abs(np.diff(joints, axis=0)).max(axis=1) <= speeds[:-1] * steps_s + 1e-4).all()
    assert (np.abs(np.diff(speeds)) <= ACCELERATION * steps_s + 1e-3).all()
    assert (np.diff(speeds[1:]) <= 1e-9).all()
    assert speeds[-1] == 0
    # It stands on its way, not beside it.
    share = (joints[-1] - HOME) / np.where(NEAR == HOME, np.inf, NEAR - HOME)
    moved = HOME != NEAR
    np.testing.assert_allclose(share[moved], share[0], atol=1e-6)
    assert 0 < share[0] < 1
    assert move.is_done
    assert move.progress < 1
    with pytest.raises(RobotStopped, match="was stopped before it arrived"):
        move.wait(1.0)


@pytest.mark.parametrize("is_instant", [True, False])
def test_after_a_stop_it_moves_only_when_it_is_recovered(is_instant: bool) -> None:
    arm = robot(is_instant)
    arm.stop()
    with pytest.raises(MoveRefused, match=r"was stopped.*recover"):
        arm.move_joints([HOME, NEAR], SPEED, ACCELERATION)
    with pytest.raises(MoveRefused, match=r"was stopped.*recover"):
        arm.follow(TRAJECTORY)
    np.testing.assert_array_equal(arm.state().joints_rad, HOME)
    arm.recover()
    arm.follow(TRAJECTORY).wait(5.0)
    np.testing.assert_array_equal(arm.state().joints_rad, NEAR)
    arm.stop()
    with arm:
        arm.move_joints([NEAR, HOME], SPEED, ACCELERATION).wait(5.0)


def test_stopping_twice_and_stopping_a_standing_arm_change_nothing() -> None:
    arm = robot()
    arm.stop()
    np.testing.assert_array_equal(arm.state().joints_rad, HOME)
    arm.recover()
    arm.move_joints([HOME, NEAR], SPEED, ACCELERATION)
    time.sleep(0.25)
    arm.stop()
    time.sleep(0.05)
    arm.stop()
    speeds = [np.abs(state.joint_speeds_rad_s).max() for state in watch(arm, SPEED / ACCELERATION)]
    assert speeds[-1] == 0
    where = arm.state().joints_rad
    arm.stop()
    np.testing.assert_array_equal(arm.state().joints_rad, where)
    arm.recover()
    arm.move_joints([where, HOME], SPEED, ACCELERATION).wait(5.0)


def test_leaving_it_stops_it() -> None:
    with robot() as arm:
        move = arm.move_joints([HOME, NEAR], SPEED, ACCELERATION)
        time.sleep(0.1)
    with pytest.raises(RobotStopped):
        move.wait(1.0)


def test_who_waits_too_briefly_is_told() -> None:
    arm = robot()
    move = arm.move_joints([HOME, NEAR], SPEED, ACCELERATION)
    with pytest.raises(RobotError, match=r"did not arrive within 0\.05 s"):
        move.wait(0.05)
    arm.stop()


def test_instantly_it_is_there() -> None:
    arm = robot(is_instant=True)
    move = arm.move_joints([HOME, NEAR, HOME + 1], SPEED, ACCELERATION)
    assert move.is_done
    assert move.progress == 1
    move.wait(0.0)
    np.testing.assert_array_equal(arm.state().joints_rad, HOME + 1)
    np.testing.assert_array_equal(arm.state().joint_speeds_rad_s, 0)
    move.stop()
    np.testing.assert_array_equal(arm.state().joints_rad, HOME + 1)


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ([NEAR, HOME], "not where the motion begins"),
        ([HOME, HOME + 7], "cannot take these joint angles"),
        ([HOME, np.full(6, np.nan)], "cannot take these joint angles"),
        (np.empty((0, 6)), "cannot take these joint angles"),
        (HOME, "cannot take these joint angles"),
        ([HOME[:5], HOME[:5]], "cannot take these joint angles"),
    ],
    ids=["from elsewhere", "outside the limits", "not a number", "nothing", "no path", "five joints"],
)
@pytest.mark.parametrize("is_instant", [True, False])
def test_what_it_refuses(path: npt.ArrayLike, said: str, is_instant: bool) -> None:
    arm = robot(is_instant)
    with pytest.raises(RobotError, match=said):
        arm.move_joints(path, SPEED, ACCELERATION)
    np.testing.assert_array_equal(arm.state().joints_rad, HOME)


def test_a_moving_arm_takes_no_second_motion() -> None:
    arm = robot()
    first = arm.move_joints([HOME, NEAR], SPEED, ACCELERATION)
    time.sleep(0.1)
    with pytest.raises(RobotError, match="still moving"):
        arm.move_joints([arm.state().joints_rad, HOME], SPEED, ACCELERATION)
    first.wait(5.0)
    np.testing.assert_array_equal(arm.state().joints_rad, NEAR)


def test_the_gripper_does_what_it_is_told() -> None:
    with SimulatedGripper() as gripper:
        assert not gripper.is_closed
        gripper.close()
        assert gripper.is_closed
        gripper.open()
        assert not gripper.is_closed


def test_it_follows_a_timed_motion_by_the_clock() -> None:
    arm = robot()
    began_s = time.monotonic()
    move = arm.follow(TRAJECTORY)
    states = watch(arm, TRAJECTORY.duration_s + 0.05)
    for state in states:
        # The clock is read a moment before the motion begins.
        lag_s = np.linspace(0.0, 0.05, 26)
        expected = np.array([TRAJECTORY.at(state.time_s - began_s - lag) for lag in lag_s])
        assert np.abs(expected - state.joints_rad).max(axis=1).min() < 2e-3
    speeds = np.array([state.joint_speeds_rad_s for state in states])
    steps = np.diff([state.joints_rad for state in states], axis=0)
    steps_s = np.diff([state.time_s for state in states])
    assert (np.abs(steps) <= (np.abs(speeds).max() + 0.1) * steps_s[:, None]).all()
    assert move.is_done
    assert move.progress == 1
    np.testing.assert_array_equal(arm.state().joints_rad, TRAJECTORY.end_rad)


def test_stopped_while_it_follows_it_stands_on_the_way_soon() -> None:
    arm = robot()
    move = arm.follow(TRAJECTORY)
    time.sleep(0.4)
    assert 0.3 < move.progress < 0.9
    arm.stop()
    time.sleep(0.05)
    arm.stop()
    time.sleep(0.15)
    state = arm.state()
    np.testing.assert_array_equal(state.joint_speeds_rad_s, 0)
    fine = np.array([TRAJECTORY.at(t) for t in np.linspace(0.3, 0.7, 4000)])
    assert np.abs(fine - state.joints_rad).max(axis=1).min() < 1e-3
    assert move.is_done
    assert move.progress < 0.9
    with pytest.raises(RobotStopped):
        move.wait(0.0)


def test_a_timed_motion_is_refused_as_a_joint_move_is() -> None:
    arm = robot()
    with pytest.raises(RobotError, match="not where the motion begins"):
        arm.follow(TRAJECTORY.reversed())
    with pytest.raises(RobotError, match="cannot take these joint angles"):
        arm.follow(JointTrajectory(np.array([0.0, 1.0]), np.array([HOME, HOME + 7])))
    arm.follow(TRAJECTORY)
    time.sleep(0.1)
    with pytest.raises(RobotError, match="still moving"):
        arm.follow(TRAJECTORY)


def test_instantly_it_is_at_the_end_of_a_timed_motion() -> None:
    arm = robot(is_instant=True)
    move = arm.follow(TRAJECTORY)
    move.wait(0.0)
    assert move.progress == 1
    np.testing.assert_array_equal(arm.state().joints_rad, NEAR)
    np.testing.assert_array_equal(arm.state().joint_speeds_rad_s, 0)


def test_the_tool_is_at_the_flange_unless_said_otherwise() -> None:
    T_flange_tool = np.eye(4)
    T_flange_tool[:3, 3] = 0.01, -0.02, 0.15
    state = KinematicRobot(Kinematics(UR5), HOME, True, T_flange_tool).state()
    np.testing.assert_allclose(state.T_base_tool, flange_pose(UR5, HOME) @ T_flange_tool)
    np.testing.assert_array_equal(robot().state().T_base_tool, robot().state().T_base_flange)
