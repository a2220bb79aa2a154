"""What happens during a move: the arm stands, the error says why, nothing goes on, and recovery works."""

from __future__ import annotations

import time

import pytest

from hardware.errors import (
    EmergencyStop,
    NotInRemoteControl,
    ProgramStopped,
    ProtectiveStop,
    RobotError,
    RobotLost,
    RobotNotReady,
    RobotStopped,
    TrackingLost,
)
from hardware.grippers.tool_output import ToolOutputGripper
from hardware.robots.ur.link import WorkerLink
from hardware.simulation.ur_controller.process import ControllerProcess
from tests.awake import AwakeClock, in_time, within
from tests.hardware.robots.ur.bench import (
    HOME,
    NEAR,
    STANDS_WITHIN_S,
    Bench,
    bent_way,
    driver,
)
from tests.patience import HANG_S, wait_until

pytestmark = [pytest.mark.system, pytest.mark.punctual]

NOTICED_WITHIN_S = 0.3
NOTICED_MOVING_S = 0.45
"""A program that moves the arm nearly along its path is told from a lagging arm somewhat later."""
KINDS = pytest.mark.parametrize("kind", ["move_joints", "follow"])


def stops_with(bench: Bench, kind: str, fault: str, error: type[RobotError], said: str) -> None:
    """A fault in the middle of a move: the arm stands in time, who waits is told, further moves refused."""
    move = bench.begin(kind)
    bench.controller.command(fault)
    began_s = time.monotonic()
    in_time(bench.seconds_to_rest(), STANDS_WITHIN_S, "coming to rest")
    with pytest.raises(error, match=said) as caught:
        move.wait(HANG_S)
    assert type(caught.value) is error
    in_time(time.monotonic() - began_s, STANDS_WITHIN_S + 0.5, "being told")
    assert move.is_done
    assert move.progress < 1
    assert bench.stays_where_it_is(0.1)
    here = bench.joints()
    with pytest.raises(RobotError, match="recover"):
        bench.robot.move_joints([here, HOME], 1.0, 1.0)
    assert bench.stays_where_it_is(0.1)


@KINDS
def test_a_protective_stop(fast_bench: Bench, kind: str) -> None:
    stops_with(fast_bench, kind, "protective stop", ProtectiveStop, r"protective stop; see what .* recover")
    fast_bench.dashboard("unlock protective stop", "play")
    assert fast_bench.stays_where_it_is(), "the old move is gone"
    fast_bench.works_again()


def test_an_emergency_stop(fast_bench: Bench) -> None:
    bench = fast_bench
    stops_with(bench, "follow", "emergency stop", EmergencyStop, r"emergency stop is pressed; .*release it")
    with pytest.raises(EmergencyStop, match="is pressed"):
        bench.robot.recover()
    bench.controller.command("emergency release")
    bench.works_again()


def test_a_safety_fault_is_for_the_panel(fast_bench: Bench) -> None:
    bench = fast_bench
    stops_with(bench, "move_joints", "safety fault", RobotNotReady, "'fault'.* panel")
    with pytest.raises(RobotNotReady, match="panel"):
        bench.robot.recover()
    bench.dashboard("restart safety")
    bench.works_again()


def test_a_program_that_does_not_start_is_said_and_a_protective_stop_waits_for_its_time(
    fast_bench: Bench,
) -> None:
    fast_bench.controller.command("protective stop")
    began_s = fast_bench.truth()["time_s"]
    wait_until(lambda: not fast_bench.robot.state().safety_mode.may_move)
    with pytest.raises(ProtectiveStop):
        fast_bench.robot.move_joints([HOME, NEAR], 1.0, 1.0)
    fast_bench.robot.recover()
    assert fast_bench.truth()["time_s"] - began_s >= 5
    fast_bench.controller.command("ignore uploads")
    with pytest.raises(RobotNotReady, match="does not start"):
        fast_bench.robot.recover()
    fast_bench.controller.command("heed uploads")
    fast_bench.works_again()


def test_a_recovery_asked_for_before_the_worker_has_said_what_happened_ends_our_paused_program(
    fast_bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(WorkerLink, "_take", lambda self, message: None)
    fast_bench.controller.command("protective stop")
    wait_until(lambda: not fast_bench.robot.state().safety_mode.may_move)
    monkeypatch.undo()
    fast_bench.robot.recover()
    fast_bench.works_again()


@pytest.mark.parametrize(
    ("kind", "fault"),
    [("follow", "program stop"), ("move_joints", "program pause"), ("follow", "program pause")],
)
def test_a_program_that_is_stopped_or_paused(bench: Bench, kind: str, fault: str) -> None:
    stops_with(bench, kind, fault, ProgramStopped, "was stopped or paused")
    bench.dashboard("play")
    assert bench.stays_where_it_is(), "the old move is gone"
    bench.works_again()


@KINDS
def test_a_joint_that_does_not_follow(bench: Bench, kind: str) -> None:
    stops_with(bench, kind, "stick 1", TrackingLost, r"The base joint was \d\.\d degrees from")
    bench.controller.command("unstick")
    time.sleep(0.2)
    bench.works_again()


def test_local_control_is_named() -> None:
    with (
        ControllerProcess(version="5.11", joints_rad=HOME) as controller,
        driver(controller.address) as robot,
    ):
        bench = Bench(controller, robot)
        move = bench.begin("move_joints")
        controller.command("local")
        controller.command("program stop")
        with pytest.raises(NotInRemoteControl, match="choose remote control"):
            move.wait(HANG_S)
        with pytest.raises(NotInRemoteControl, match="choose remote control"):
            robot.recover()
        controller.command("remote")
        bench.works_again()


@pytest.mark.parametrize(("kind", "fault"), [("move_joints", "link drop 1.5"), ("follow", "link silent 1.5")])
def test_a_lost_link(bench: Bench, kind: str, fault: str) -> None:
    move = bench.begin(kind)
    began_s = time.monotonic()
    bench.controller.command(fault)
    with pytest.raises(RobotLost, match=r"look at the arm .* recover"):
        move.wait(HANG_S)
    in_time(time.monotonic() - began_s, 0.7, "being noticed")
    in_time(bench.seconds_to_rest(), STANDS_WITHIN_S, "coming to rest")
    with pytest.raises(RobotLost):
        bench.robot.state()
    with pytest.raises(RobotLost):
        bench.robot.move_joints([HOME, NEAR], 1.0, 1.0)
    with pytest.raises(RobotLost, match="press the emergency stop"):
        bench.robot.stop()
    time.sleep(max(began_s + 1.6 - time.monotonic(), 0))
    bench.works_again()
    gripper = ToolOutputGripper(bench.robot, 0, 0.0)
    gripper.close()
    assert bench.truth()["tool_outputs"] == [True, False]


def test_a_link_that_is_lost_while_the_arm_stands_is_noticed(bench: Bench) -> None:
    bench.controller.command("link drop 2")
    time.sleep(0.6)
    with pytest.raises(RobotLost, match="look at the arm"):
        bench.robot.state()
    with pytest.raises(RobotLost):
        ToolOutputGripper(bench.robot, 0, 0.0).close()
    with pytest.raises(RobotError):
        bench.robot.recover()


def test_a_slow_and_uneven_link_does_not_matter(bench: Bench) -> None:
    bench.controller.command("latency 30 20")
    bench.robot.follow(bent_way(0.8)).wait(HANG_S)
    bench.robot.move_joints([NEAR, HOME], 1.0, 4.0).wait(HANG_S)
    move = bench.begin("follow")
    bench.robot.stop()
    in_time(bench.seconds_to_rest(), STANDS_WITHIN_S, "coming to rest")
    with pytest.raises(RobotStopped):
        move.wait(1)


@KINDS
@pytest.mark.parametrize(
    "fault", ["foreign still", "foreign moving", "foreign gap still", "foreign gap moving"]
)
def test_another_program_that_takes_over_is_noticed_and_the_arm_stands(
    bench: Bench, kind: str, fault: str
) -> None:
    move = bench.begin(kind)
    with AwakeClock() as clock:
        began_s = clock.now_s()
        bench.controller.command(fault)
        with pytest.raises(RobotError):
            move.wait(HANG_S)
        if kind == "follow":  # all that is driven to scan and to pour
            limit_s = NOTICED_MOVING_S if fault == "foreign moving" else NOTICED_WITHIN_S
            in_time(clock.now_s() - began_s, limit_s, "being noticed")
        in_time(bench.seconds_to_rest(), 1, "coming to rest")
    assert bench.stays_where_it_is(0.5)
    assert bench.truth()["runtime_state"] == "STOPPED"
    bench.works_again()


def test_a_control_thread_that_is_stuck_is_noticed(bench: Bench) -> None:
    move = bench.begin("follow")
    with within(NOTICED_WITHIN_S):
        bench.controller.command("program hangs")
        with pytest.raises(RobotError):
            move.wait(HANG_S)
    wait_until(lambda: bench.truth()["runtime_state"] == "STOPPED", STANDS_WITHIN_S)
    assert bench.stays_where_it_is()
    bench.works_again()


@pytest.mark.parametrize("slider", [0.05, 0.5])
def test_a_speed_slider_that_is_moved_is_no_fault(bench: Bench, slider: float) -> None:
    move = bench.begin("follow")
    bench.controller.command(f"slider {slider:g}")
    time.sleep(0.7)
    assert not move.is_done
    bench.controller.command("slider 0")
    time.sleep(0.5)
    bench.controller.command("slider 1")
    move.wait(HANG_S)


def test_power_that_is_switched_off(either_bench: Bench) -> None:
    stops_with(either_bench, "move_joints", "power off", RobotNotReady, "power")
    either_bench.works_again()
