"""Where nothing goes wrong: connecting, states, moves, stops, the gripper; on a CB3 and an e-Series."""

from __future__ import annotations

import threading
import time

import numpy as np
import numpy.typing as npt
import pytest

from core.motion.arm_models import UR5
from core.motion.kinematics import flange_pose
from core.motion.trajectory import JointTrajectory
from hardware.errors import MoveRefused, RobotError, RobotStopped
from hardware.grippers.tool_output import ToolOutputGripper
from hardware.interfaces import RobotState
from hardware.modes import RobotMode, SafetyMode
from hardware.realtime import take_precedence
from tests.awake import AwakeClock, in_time
from tests.hardware.robots.ur.bench import (
    ACCELERATION,
    HOME,
    NEAR,
    PAYLOAD_KG,
    SPEED,
    T_FLANGE_TOOL,
    Bench,
    bent_way,
)
from tests.patience import HANG_S, wait_until

pytestmark = [pytest.mark.system, pytest.mark.punctual]


def watch(bench: Bench, is_over: threading.Event, states: list[RobotState]) -> None:
    """Read like the driver, in a thread of its own: before what else runs on this machine."""
    take_precedence()
    while not is_over.is_set():
        state = bench.robot.state()
        if not states or state.controller_s != states[-1].controller_s:
            states.append(state)
        time.sleep(0.001)


def test_a_state_tells_all_that_the_interface_names(either_bench: Bench) -> None:
    state = either_bench.robot.state()
    np.testing.assert_allclose(state.joints_rad, HOME, atol=1e-9)
    np.testing.assert_allclose(state.target_joints_rad, HOME, atol=1e-9)
    np.testing.assert_array_equal(state.joint_speeds_rad_s, 0)
    np.testing.assert_allclose(state.T_base_flange, flange_pose(UR5, HOME), atol=1e-9)
    np.testing.assert_allclose(state.T_base_tool, flange_pose(UR5, HOME) @ T_FLANGE_TOOL, atol=1e-6)
    assert (state.robot_mode, state.safety_mode) == (RobotMode.RUNNING, SafetyMode.NORMAL)
    assert state.is_program_running
    assert state.speed_scaling == 1
    assert state.age_s < 0.2
    assert either_bench.truth()["payload_kg"] == PAYLOAD_KG


@pytest.mark.parametrize("moves", [True, False])
def test_states_come_125_times_a_second(either_bench: Bench, moves: bool) -> None:
    rate_hz = 125
    states: list[RobotState] = []
    over = threading.Event()
    watcher = threading.Thread(target=watch, args=(either_bench, over, states))
    with AwakeClock() as clock:
        began_s = clock.now_s()
        move = either_bench.robot.follow(bent_way()) if moves else None
        watcher.start()
        time.sleep(1.0)
        over.set()
        watcher.join()
        took_s = clock.now_s() - began_s
    passed_s = states[-1].controller_s - states[0].controller_s
    assert passed_s == pytest.approx(took_s, abs=0.1)
    # A reader on a busy machine misses some.
    assert 0.5 * rate_hz < (len(states) - 1) / passed_s < 1.01 * rate_hz
    assert (np.diff([state.controller_s for state in states]) > 0).all()
    if move is not None:
        move.wait(HANG_S)


def test_a_path_is_driven_from_corner_to_corner_in_its_time(either_bench: Bench) -> None:
    corner = HOME + np.array([0.3, 0.1, 0.0, -0.2, 0.0, 0.0])
    states: list[RobotState] = []
    began_s = either_bench.truth()["time_s"]
    move = either_bench.robot.move_joints([HOME, corner, corner, NEAR], SPEED, ACCELERATION)
    watcher = threading.Thread(target=watch, args=(either_bench, move._is_over, states))
    watcher.start()
    move.wait(HANG_S)
    took_s = either_bench.truth()["time_s"] - began_s
    watcher.join()
    ways = [0.3, np.abs(NEAR - corner).max()]
    least_s = sum(way / SPEED + SPEED / ACCELERATION for way in ways)
    assert least_s < took_s < least_s + 0.6
    np.testing.assert_allclose(either_bench.joints(), NEAR, atol=1e-3)
    assert move.is_done
    assert move.progress == 1
    joints = np.array([state.joints_rad for state in states])
    at_corner = np.abs(joints - corner).max(axis=1).argmin()
    assert np.abs(joints[at_corner] - corner).max() < 1e-3
    for start, end, part in ((HOME, corner, joints[:at_corner]), (corner, NEAR, joints[at_corner:])):
        share = ((part - start) @ (end - start)) / ((end - start) @ (end - start))
        assert np.abs(part - start - np.outer(share, end - start)).max() < 1e-3
        assert (np.diff(share) > -1e-6).all()
    assert np.abs([state.joint_speeds_rad_s for state in states]).max() < SPEED * 1.02


def test_progress_only_grows(bench: Bench) -> None:
    move = bench.robot.move_joints([HOME, NEAR, HOME], SPEED, ACCELERATION)
    seen = []
    while not move.is_done:
        seen.append(move.progress)
        time.sleep(0.01)
    assert (np.diff([0.0, *seen, move.progress]) >= 0).all()
    assert 0.2 < seen[len(seen) // 2] < 0.8
    assert move.progress == 1


def test_a_timed_motion_is_followed_on_its_way_and_in_its_time(either_bench: Bench) -> None:
    way = bent_way()
    states: list[RobotState] = []
    began_s = either_bench.truth()["time_s"]
    move = either_bench.robot.follow(way)
    watcher = threading.Thread(target=watch, args=(either_bench, move._is_over, states))
    watcher.start()
    move.wait(HANG_S)
    took_s = either_bench.truth()["time_s"] - began_s
    watcher.join()
    assert way.duration_s < took_s < way.duration_s + 0.5
    np.testing.assert_allclose(either_bench.joints(), NEAR, atol=1e-3)
    assert move.progress == 1
    fine = np.array([way.at(t) for t in np.linspace(0, way.duration_s, 2000)])
    beside_rad = [np.abs(fine - state.joints_rad).max(axis=1).min() for state in states]
    assert max(beside_rad) < 0.004
    assert len(states) > 50


@pytest.mark.parametrize(("kind", "by"), [("move_joints", "robot"), ("follow", "move")])
def test_stopped_from_another_thread_it_stands_in_a_fifth_of_a_second(
    either_bench: Bench, kind: str, by: str
) -> None:
    move = either_bench.begin(kind)
    errors: list[BaseException] = []

    def wait() -> None:
        try:
            move.wait(HANG_S)
        except RobotError as error:
            errors.append(error)

    waiting = threading.Thread(target=wait)
    waiting.start()
    stopping = threading.Thread(target=move.stop if by == "move" else either_bench.robot.stop)
    began_s = time.monotonic()
    stopping.start()
    took_s = either_bench.seconds_to_rest()
    stopping.join()
    waiting.join()
    said_s = time.monotonic() - began_s
    in_time(took_s, 0.2, "coming to rest")
    in_time(said_s, 0.6, "being told")
    assert [type(error) for error in errors] == [RobotStopped]
    assert move.is_done
    assert 0 < move.progress < 1
    assert either_bench.truth()["runtime_state"] == "PLAYING", "no need for the dashboard"
    assert either_bench.stays_where_it_is()
    here = either_bench.joints()
    with pytest.raises(RobotStopped, match=r"was stopped; .*recover"):
        either_bench.robot.move_joints([here, HOME], SPEED, ACCELERATION)
    either_bench.works_again()


def test_a_stop_between_two_moves_holds_off_the_next_one(bench: Bench) -> None:
    bench.robot.stop()
    with pytest.raises(RobotStopped, match="recover"):
        bench.robot.follow(bent_way())
    assert bench.stays_where_it_is(0.1)
    bench.works_again()


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
def test_what_it_refuses(bench: Bench, path: npt.ArrayLike, said: str) -> None:
    with pytest.raises(RobotError, match=said):
        bench.robot.move_joints(path, SPEED, ACCELERATION)
    if np.ndim(path) == 2 and len(np.array(path)):
        with pytest.raises(RobotError, match=said):
            bench.robot.follow(JointTrajectory(np.array([0.0, 1.0]), np.array(path)))
    assert bench.stays_where_it_is(0.05)


def test_a_moving_arm_takes_no_second_motion(bench: Bench) -> None:
    first = bench.robot.move_joints([HOME, NEAR], SPEED, ACCELERATION)
    with pytest.raises(RobotError, match="still moving"):
        bench.robot.move_joints([HOME, NEAR], SPEED, ACCELERATION)
    wait_until(bench.is_moving)
    with pytest.raises(RobotError, match="still moving"):
        bench.robot.follow(bent_way())
    first.wait(HANG_S)
    np.testing.assert_allclose(bench.joints(), NEAR, atol=1e-3)


def test_a_path_without_length_is_done_at_once(bench: Bench) -> None:
    bench.robot.move_joints([HOME], SPEED, ACCELERATION).wait(2)
    bench.robot.move_joints([HOME, HOME], SPEED, ACCELERATION).wait(2)
    np.testing.assert_allclose(bench.joints(), HOME, atol=1e-9)


def test_who_waits_too_briefly_is_told(bench: Bench) -> None:
    move = bench.robot.move_joints([HOME, NEAR], SPEED, ACCELERATION)
    with pytest.raises(RobotError, match=r"did not arrive within 0\.01 s"):
        move.wait(0.01)
    move.wait(HANG_S)


def test_the_speed_slider_stretches_both_kinds_of_motion(bench: Bench) -> None:
    bench.controller.command("slider 0.5")
    try:
        wait_until(lambda: bench.robot.state().speed_scaling == 0.5)
        way = bent_way(0.5)
        began_s = bench.truth()["time_s"]
        bench.robot.follow(way).wait(HANG_S)
        assert bench.truth()["time_s"] - began_s > 1.9 * way.duration_s
        bench.robot.move_joints([NEAR, HOME], SPEED, ACCELERATION).wait(HANG_S)
    finally:
        bench.controller.command("slider 1")
        wait_until(lambda: bench.robot.state().speed_scaling == 1)


@pytest.mark.parametrize("output", [0, 1])
def test_the_gripper_closes_and_opens_and_reads_back(either_bench: Bench, output: int) -> None:
    with ToolOutputGripper(either_bench.robot, output, action_s=0.1) as gripper:
        assert not gripper.is_closed
        began_s = time.monotonic()
        gripper.close()
        assert time.monotonic() - began_s >= 0.1
        assert gripper.is_closed
        assert either_bench.truth()["tool_outputs"] == [output == 0, output == 1]
    assert gripper.is_closed, "leaving it drops nothing"
    gripper.open()
    assert not gripper.is_closed
    assert either_bench.truth()["tool_outputs"] == [False, False]


def test_the_gripper_works_while_the_arm_moves(bench: Bench) -> None:
    move = bench.robot.follow(bent_way())
    gripper = ToolOutputGripper(bench.robot, 0, action_s=0.0)
    for _ in range(4):
        gripper.close()
        gripper.open()
    assert not move.is_done
    move.wait(HANG_S)
    np.testing.assert_allclose(bench.joints(), NEAR, atol=1e-3)


def test_an_output_that_something_else_sets_is_an_error(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Output 0 is asked for, output 1 changes.
    ask = bench.robot._connected().worker.ask
    monkeypatch.setattr(
        bench.robot._connected().worker,
        "ask",
        lambda name, output, value: ask(name, 1 - output, value),
    )
    with pytest.raises(MoveRefused, match=r"Tool output 0 .* did not change"):
        bench.robot.set_tool_output(0, True)
    monkeypatch.undo()
    bench.robot.set_tool_output(1, False)
