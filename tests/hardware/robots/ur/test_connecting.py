"""Who is at the address: nobody, somebody else, another arm, an arm that is not ready."""

from __future__ import annotations

import json
import os
import socket
import threading
from collections.abc import Iterator
from contextlib import ExitStack, suppress

import numpy as np
import pytest

from core.motion.arm_models import UR5, UR5E
from core.motion.kinematics import flange_pose
from core.motion.trajectory import JointTrajectory
from hardware.errors import (
    EmergencyStop,
    MoveRefused,
    NotInRemoteControl,
    ProtectiveStop,
    RobotError,
    RobotLost,
    RobotNotReady,
    RobotUnreachable,
    WrongRobot,
)
from hardware.interfaces import ReadyStep
from hardware.robots.ur import primary_interface
from hardware.robots.ur.probe import DASHBOARD_PORT, DATA_PORT, SCRIPT_PORT
from hardware.simulation.ur_controller.process import ControllerProcess
from tests.awake import in_time, within
from tests.hardware.robots.ur.bench import (
    HOME,
    STANDS_WITHIN_S,
    T_FLANGE_TOOL,
    VERSIONS,
    Bench,
    bent_way,
    driver,
)
from tests.patience import HANG_S, wait_until

pytestmark = [pytest.mark.system, pytest.mark.punctual]

NOBODYS_PORT = 30002
EMPTY_ADDRESS = f"127.83.{os.getpid() % 256}.7"
"""Each test process its own: what one listens on must be empty for the other."""


@pytest.fixture
def listeners() -> Iterator[list[socket.socket]]:
    """Somebody who listens on all ports and greets as a mail server does."""
    with ExitStack() as stack:
        sockets = [
            stack.enter_context(socket.create_server((EMPTY_ADDRESS, port)))
            for port in (DASHBOARD_PORT, SCRIPT_PORT, DATA_PORT)
        ]
        threading.Thread(target=greet_once, args=(sockets[0],), daemon=True).start()
        yield sockets


def greet_once(listener: socket.socket) -> None:
    with suppress(OSError), listener.accept()[0] as connection:
        connection.sendall(b"220 mail.example.org ESMTP: say hello first\r\n")


def refuses(address: str, error: type[RobotError], said: str) -> None:
    robot = driver(address)
    with within(5), pytest.raises(error, match=said), robot:
        pass
    with pytest.raises(RobotLost, match="not connected"):
        robot.state()


def test_nobody() -> None:
    refuses(EMPTY_ADDRESS, RobotUnreachable, f"Nobody answers at {EMPTY_ADDRESS} on its dashboard port 29999")


def test_no_address() -> None:
    refuses("no such host.", RobotUnreachable, "Nobody answers at no such host")
    refuses("a" * 70, RobotUnreachable, "Nobody answers")


def test_somebody_else(listeners: list[socket.socket]) -> None:
    refuses(EMPTY_ADDRESS, RobotUnreachable, "on port 29999 is no UR controller")


def test_somebody_else_with_one_port(listeners: list[socket.socket]) -> None:
    for listener in listeners[1:]:
        listener.close()
    refuses(EMPTY_ADDRESS, RobotUnreachable, "on port 29999 is no UR controller")


def test_a_controller_that_froze(controller: ControllerProcess) -> None:
    controller.command("link silent 6")
    refuses(controller.address, RobotUnreachable, "sends nothing: a controller that hangs .* restart it")


def test_another_model(controller: ControllerProcess) -> None:
    began = np.array(HOME)
    with (
        pytest.raises(WrongRobot, match=r"not the UR5e of the cell file: .* \d\d mm"),
        driver(controller.address, UR5E),
    ):
        pass
    controller.command("model UR5e")
    refuses(controller.address, WrongRobot, "not the UR5 of the cell file")
    np.testing.assert_array_equal(Bench(controller, driver(controller.address)).joints(), began)


def test_a_factory_calibration_is_tolerated_within_the_tolerance(controller: ControllerProcess) -> None:
    controller.command("model UR5e")
    with driver(controller.address, UR5, tolerance_m=0.2) as robot:
        assert robot.state().is_program_running


def test_an_arms_own_kinematics_are_read_and_used() -> None:
    with ControllerProcess(joints_rad=HOME, faults=["calibration 8"]) as controller:
        robot = driver(controller.address)
        assert robot.kinematics.model is UR5
        robot.look()
        assert robot.kinematics.checksum
        with robot:
            state, read = robot.state(), robot.kinematics
            assert read.checksum
            assert read.caution == ""
            np.testing.assert_allclose(state.T_base_flange @ T_FLANGE_TOOL, state.T_base_tool, atol=1e-9)
            apart_m = np.linalg.norm((flange_pose(UR5, state.joints_rad) - state.T_base_flange)[:3, 3])
            assert apart_m == pytest.approx(0.008)
            robot.move_joints([HOME, HOME + 0.1], 1.0, 4.0).wait(HANG_S)
            robot.recover()
            assert robot.kinematics is read, "read once"


def test_without_them_an_arm_beyond_the_tolerance_is_refused_and_another_one_cautioned(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(primary_interface, "PRIMARY_PORT", NOBODYS_PORT)
    with ControllerProcess(joints_rad=HOME, faults=["calibration 8"]) as controller:
        refuses(controller.address, WrongRobot, "puts the tool 8 mm")
        controller.command("calibration 2")
        with driver(controller.address) as robot:
            assert robot.kinematics.model is UR5
            assert "1 to 3 mm" in robot.kinematics.caution


def test_an_e_series_in_local_control() -> None:
    with ControllerProcess(version="5.11", faults=["local"]) as controller:
        refuses(controller.address, NotInRemoteControl, "choose remote control")


@pytest.mark.parametrize(
    ("fault", "error", "said"),
    [
        ("power off", RobotNotReady, "'power off'"),
        ("emergency stop", EmergencyStop, "release it"),
        ("protective stop", ProtectiveStop, "protective stop"),
        ("safety fault", RobotNotReady, "'fault'"),
        ("take registers", RobotNotReady, "Another program"),
    ],
)
def test_an_arm_that_is_not_ready(
    controller: ControllerProcess, fault: str, error: type[RobotError], said: str
) -> None:
    controller.command(fault)
    refuses(controller.address, error, said)


def test_a_second_driver_is_refused_and_the_first_goes_on(bench: Bench) -> None:
    refuses(bench.controller.address, RobotNotReady, "Another program")
    bench.robot.state()
    bench.works_again()


def test_what_was_switched_off_is_recovered_without_having_been_connected() -> None:
    with ControllerProcess(joints_rad=HOME, speed_up=4.0, faults=["power off"]) as controller:
        robot = driver(controller.address)
        with pytest.raises(RobotNotReady):
            robot.__enter__()
        robot.recover()
        robot.move_joints([HOME, HOME + 0.1], 1.0, 4.0).wait(HANG_S)
        np.testing.assert_allclose(Bench(controller, robot).joints(), HOME + 0.1, atol=1e-3)
        robot.__exit__(None, None, None)


def test_it_may_be_entered_again(controller: ControllerProcess) -> None:
    robot = driver(controller.address, tool_voltage_v=24)
    for _ in range(2):
        with robot:
            robot.stop()
            assert robot.state().is_program_running
        with pytest.raises(RobotLost, match="not connected"):
            robot.state()


def written(controller: ControllerProcess) -> list[dict[str, object]]:
    """What the controller was told to do so far: all but questions."""
    questions = ("quit", "polyscopeversion", "programstate", "get robot model", "is in remote control")
    entries = json.loads(controller.command("log 2000"))
    return [
        entry
        for entry in entries
        if entry["what"] in ("script", "digital outputs", "command", "slider")
        or (entry["what"] == "dashboard" and entry["line"].lower() not in questions)
    ]


@pytest.mark.parametrize("version", VERSIONS)
def test_looking_writes_nothing_and_knows_the_arm(version: str) -> None:
    with ControllerProcess(version=version, joints_rad=HOME, faults=["slider 0.5"]) as controller:
        robot = driver(controller.address, tool_voltage_v=12)
        seen = robot.look()
        assert seen.joints_rad == pytest.approx(HOME)
        assert seen.slider == 0.5
        assert seen.has_free_inputs
        assert robot.pending_step() is None
        assert not written(controller)
        controller.command("model UR5e")
        with pytest.raises(WrongRobot):
            robot.look()
        assert not written(controller)


def test_looking_at_an_arm_that_is_driven_disturbs_nothing(bench: Bench) -> None:
    move = bench.robot.follow(bent_way(1.5))
    before = written(bench.controller)
    robot = driver(bench.controller.address, tool_voltage_v=12)
    seen = robot.look()
    assert not seen.has_free_inputs
    refuses(bench.controller.address, RobotNotReady, r"Another program \(PLAYING .*\) drives .* moves")
    assert written(bench.controller)[: len(before)] == before
    assert not any(entry["what"] == "script" for entry in written(bench.controller)[len(before) :])
    assert bench.truth()["tool_voltage_v"] == 24
    move.wait(HANG_S)


def test_the_tools_voltage_is_set_when_nothing_is_held(controller: ControllerProcess) -> None:
    bench = Bench(controller, driver(controller.address, tool_voltage_v=12))
    with bench.robot as robot:
        assert bench.truth()["tool_voltage_v"] == 12
        robot.set_tool_output(0, True)
    with pytest.raises(RobotNotReady, match="12 V where the cell file says 24 V"):
        driver(controller.address, tool_voltage_v=24).__enter__()
    assert bench.truth()["tool_voltage_v"] == 12
    with driver(controller.address, tool_voltage_v=12):
        assert bench.truth()["tool_outputs"] == [True, False]


def test_a_dashboard_that_answers_seconds_late_is_waited_for(bench: Bench) -> None:
    bench.controller.command("dashboard delay 2.5")
    try:
        move = bench.begin("follow")
        bench.robot.stop()
        in_time(bench.seconds_to_rest(), STANDS_WITHIN_S, "a stop does not wait for it")
        wait_until(lambda: move.is_done)
        bench.robot.recover()
    finally:
        bench.controller.command("dashboard delay 0")
    bench.works_again()


def test_a_tool_connector_that_feeds_something_is_refused() -> None:
    with ControllerProcess(version="5.11", joints_rad=HOME) as controller:
        controller.command("dual pin power")
        with pytest.raises(RobotNotReady, match=r"'dual pin power', .* Tool I/O"):
            driver(controller.address, tool_voltage_v=24).look()
        driver(controller.address).look()  # no gripper is at the connector
        controller.command("single pin power")
        driver(controller.address, tool_voltage_v=24).look()


def test_the_safety_systems_joint_limits_are_asked_for(bench: Bench) -> None:
    bench.controller.command(f"limit 2 {HOME[1] - 0.3} {HOME[1] + 0.3}")
    try:
        inside = HOME + np.linspace(-0.25, 0.25, 25)[:, None] * np.eye(6)[1]
        bench.robot.refuse_unsafe(JointTrajectory.of_samples(inside), "lift")
        beyond = JointTrajectory.of_samples(inside + 0.1 * np.eye(6)[1])
        with pytest.raises(MoveRefused, match=r"In the move 'lift' .* safety limits"):
            bench.robot.refuse_unsafe(beyond, "lift")
        assert bench.robot.stopped_by() is None
    finally:
        bench.controller.command("no limits")


@pytest.mark.parametrize("normal", [(0, 0, 1), (1, 0, 0), (0.6, -0.5, 0.7)])
def test_a_safety_plane_is_asked_for_where_the_tool_comes_nearest_to_it(bench: Bench, normal: tuple) -> None:
    """The joints' extremes are elsewhere: the tool goes out and back while they go on."""
    angles = np.linspace(0, 2 * np.pi, 200)[:, None]
    around = HOME + 0.2 * (np.sin(angles) * np.eye(6)[1] + np.cos(angles) * np.eye(6)[2])
    motion = JointTrajectory.of_samples(around)
    tool_m = (flange_pose(bench.robot.kinematics.model, around) @ T_FLANGE_TOOL)[:, :3, 3]
    along_m = tool_m @ normal / np.linalg.norm(normal)
    line = "plane {} {} {}".format(*normal)
    try:
        bench.controller.command(f"{line} {along_m.max() + 0.001}")
        bench.robot.refuse_unsafe(motion, "turn")
        bench.controller.command(f"{line} {along_m.max() - 0.02 * np.ptp(along_m) - 0.001}")
        with pytest.raises(MoveRefused, match=r"In the move 'turn' .* planes under Installation"):
            bench.robot.refuse_unsafe(motion, "turn")
        assert bench.robot.stopped_by() is None
    finally:
        bench.controller.command("no limits")


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("limit 2 -1.75 0", r"In the move 'lift' the shoulder joint would be at -106 degrees, .* -100 to 0;"),
        ("fastest 2 0.2", r"In the move 'lift' the shoulder joint would turn at 0\.25 rad/s, .* 0\.20;"),
    ],
)
@pytest.mark.parametrize("version", VERSIONS)
def test_ranges_and_speeds_of_joints_are_read_from_the_controller(version: str, line: str, said: str) -> None:
    up = JointTrajectory.of_samples(HOME - np.linspace(0, 0.25, 126)[:, None] * np.eye(6)[1])
    with ControllerProcess(version=version, joints_rad=HOME, faults=[line]) as controller:
        with driver(controller.address) as robot, pytest.raises(MoveRefused, match=said):
            robot.refuse_unsafe(up, "lift")
        controller.command("no limits")
        with driver(controller.address) as robot:
            robot.refuse_unsafe(up, "lift")


@pytest.mark.parametrize(
    ("fault", "steps"),
    [
        ("power off", [ReadyStep.POWER_ON, ReadyStep.RELEASE_BRAKES]),
        ("protective stop", [ReadyStep.UNLOCK]),
        ("safety fault", [ReadyStep.RESTART_SAFETY, ReadyStep.POWER_ON, ReadyStep.RELEASE_BRAKES]),
        ("foreign moving", [ReadyStep.END_PROGRAM]),
        ("foreign still", [ReadyStep.END_PROGRAM]),
    ],
)
def test_an_arm_that_is_not_ready_gets_ready_step_by_step(fault: str, steps: list[ReadyStep]) -> None:
    with ControllerProcess(joints_rad=HOME, speed_up=4.0, faults=[fault]) as controller:
        robot = driver(controller.address)
        for step in steps:
            wait_until(lambda: robot.pending_step() is not None)
            with pytest.raises(RobotError), robot:
                pass
            pending, why = robot.pending_step()
            assert pending is step
            assert "UR5 at 127" in why
            assert ("the arm moves" in why) == (fault == "foreign moving")
            assert not any(entry["what"] == "script" for entry in written(controller))
            robot.take_step(step)
        assert robot.pending_step() is None
        with robot:
            assert robot.state().is_program_running


def test_a_foreign_program_is_not_ended_by_recovering(bench: Bench) -> None:
    bench.robot.stop()
    bench.controller.command("foreign moving")
    with pytest.raises(RobotNotReady, match="Another program runs"):
        bench.robot.recover()
    assert bench.truth()["runtime_state"] == "PLAYING"
    bench.robot.take_step(ReadyStep.END_PROGRAM)
    bench.robot.recover()
    bench.works_again()


@pytest.mark.parametrize("fault", ["foreign still", "foreign moving"])
def test_a_foreign_program_that_is_paused_is_asked_about_too(bench: Bench, fault: str) -> None:
    bench.robot.stop()
    bench.controller.command(fault)
    bench.controller.command("program pause")
    wait_until(lambda: bench.truth()["runtime_state"] == "PAUSED")
    with pytest.raises(RobotNotReady, match=r"A program is paused .*PAUSED weld\.urp"):
        bench.robot.recover()
    assert bench.truth()["runtime_state"] == "PAUSED"
    step, why = bench.robot.pending_step()
    assert step is ReadyStep.END_PROGRAM
    assert "PAUSED weld.urp" in why
    assert "cannot go on" in why
    bench.robot.take_step(step)
    wait_until(lambda: bench.truth()["runtime_state"] == "STOPPED")
    bench.robot.recover()
    bench.works_again()


def test_our_own_program_that_the_controller_paused_is_not_asked_about(fast_bench: Bench) -> None:
    fast_bench.controller.command("protective stop")
    wait_until(lambda: fast_bench.robot.stopped_by() is not None)
    fast_bench.robot.recover()
    fast_bench.works_again()
