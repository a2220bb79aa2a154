"""The controller's process: its start, its end, its clock, its links and its command line."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import psutil
import pytest

from core.errors import PoursightError
from hardware.errors import RobotError
from hardware.grippers.robotiq_line import Contact, RobotiqAddress, RobotiqLine
from hardware.simulation.ur_controller.identity import (
    CONTROL_PORT,
    DASHBOARD_PORT,
    HOME_RAD,
    RTDE_PORT,
    SCRIPT_PORT,
)
from hardware.simulation.ur_controller.process import ControllerProcess
from hardware.simulation.ur_controller.rtde_protocol import OUTPUT_TYPES, Kind, frame
from tests.awake import AwakeClock, in_time
from tests.patience import HANG_S, wait_until

ROOT = Path(__file__).resolve().parents[4]
LIMIT_S = 5.0
SLOW_TO_LOAD = ("PySide6", "pybullet", "open3d", "llvmlite", "mujoco", "rtde_")
"""Parts of the paths of libraries; any of them would multiply the time until a controller is there."""
HOLDER = """
import sys, time
from hardware.simulation.ur_controller.process import ControllerProcess
with ControllerProcess() as controller:
    print(controller.address, flush=True)
    time.sleep(60)
"""


def state(controller: ControllerProcess) -> Any:
    return json.loads(controller.command("state"))


def listens(address: str, port: int = DASHBOARD_PORT) -> bool:
    try:
        socket.create_connection((address, port), 1).close()
    except OSError:
        return False
    return True


def wait_until_gone(address: str) -> float:
    begin_s = time.monotonic()
    while listens(address) and time.monotonic() - begin_s < LIMIT_S:
        time.sleep(0.02)
    return time.monotonic() - begin_s


def test_it_starts_light_and_ends_with_its_context() -> None:
    with ControllerProcess(joints_rad=[0.1] * 6) as controller:
        loaded = " ".join(one.path for one in psutil.Process(controller.pid).memory_maps())
        assert "numpy" in loaded
        assert [name for name in SLOW_TO_LOAD if name in loaded] == []
        assert controller.address.startswith("127.") and controller.address != "127.0.0.1"
        assert all(listens(controller.address, port) for port in (SCRIPT_PORT, RTDE_PORT, CONTROL_PORT))
        assert state(controller)["joints_rad"] == [0.1] * 6
        with ControllerProcess() as other:
            assert other.address != controller.address
    assert not listens(controller.address)
    with pytest.raises(RobotError):
        controller.command("state")
    with controller:
        assert state(controller)["runtime_state"] == "STOPPED", "it may be entered again"


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM])
def test_it_dies_with_its_parent(how: signal.Signals) -> None:
    parent = subprocess.Popen([sys.executable, "-c", HOLDER], stdout=subprocess.PIPE, cwd=ROOT)
    assert parent.stdout is not None
    address = parent.stdout.readline().decode().strip()
    assert listens(address)
    parent.send_signal(how)
    parent.wait()
    assert wait_until_gone(address) < 2.0


@pytest.mark.parametrize(
    "wanted", [{"model": "UR10"}, {"version": "x"}, {"address": "10.0.0.1"}, {"faults": ["dance"]}]
)
def test_what_cannot_be_is_explained(wanted: dict[str, Any]) -> None:
    with pytest.raises(PoursightError, match=r"\.$"), ControllerProcess(**wanted):
        pass


def test_an_address_that_is_taken_is_explained() -> None:
    with ControllerProcess() as controller:
        second = ControllerProcess(address=controller.address)
        with pytest.raises(RobotError, match=controller.address):
            second.__enter__()


@pytest.mark.parametrize("line", ["dance", "in x kill", "in 1", "when moving", "stick 7", "stick", "slider 2",
                                  "latency -1", "model UR10", "program pause", ""])  # fmt: skip
def test_a_line_that_is_no_command_is_refused(controller: ControllerProcess, line: str) -> None:
    with pytest.raises(RobotError):
        controller.command(line)


@pytest.fixture(scope="module")
def controller() -> Any:
    with ControllerProcess() as process:
        yield process


def seconds_ahead(controller: ControllerProcess, speed_up: int) -> float:
    """By how much the controller's clock gains on ours in a second."""
    begin_s, first_s = time.monotonic(), state(controller)["time_s"]
    time.sleep(1.0)
    ran_s = (state(controller)["time_s"] - first_s) / speed_up
    return float(ran_s - (time.monotonic() - begin_s))


@pytest.mark.parametrize("speed_up", [1, 4])
def test_the_clock_runs_as_fast_as_told_without_drifting(speed_up) -> None:
    # A busy machine wakes it up late, then it catches up; a drift would be there in every second.
    with ControllerProcess("UR5", "3.15", speed_up=speed_up) as controller:
        wait_until(lambda: abs(seconds_ahead(controller, speed_up)) < 0.05)


def test_after_being_suspended_it_goes_on_without_running_after_the_clock_for_long() -> None:
    with ControllerProcess(speed_up=4) as controller:
        child = psutil.Process(controller.pid)
        first_s = state(controller)["time_s"]
        child.suspend()
        time.sleep(2.0)
        child.resume()
        # What waited is answered before the clock goes on.
        wait_until(lambda: state(controller)["time_s"] != first_s)
        assert state(controller)["time_s"] - first_s < 4 * 1.6


def test_links_are_dropped_refused_and_restored() -> None:
    with ControllerProcess() as controller:
        connection = socket.create_connection((controller.address, DASHBOARD_PORT), LIMIT_S)
        assert connection.recv(100).startswith(b"Connected")
        controller.command("link drop 0.5")
        with suppress(ConnectionResetError):
            assert connection.recv(100) == b""
        assert not listens(controller.address) and state(controller)["connections"] == []
        time.sleep(0.8)
        assert listens(controller.address)


def test_a_silent_link_holds_everything_and_lets_it_through_later() -> None:
    with ControllerProcess() as controller:
        controller.command("link silent 0.5")
        begin_s = time.monotonic()
        with socket.create_connection((controller.address, DASHBOARD_PORT), LIMIT_S) as connection:
            connection.sendall(b"robotmode\n")
            lines = connection.makefile()
            assert lines.readline().startswith("Connected") and time.monotonic() - begin_s > 0.3
            assert lines.readline() == "Robotmode: RUNNING\n"


def test_latency_holds_in_both_directions_and_keeps_the_order() -> None:
    with ControllerProcess(faults=["latency 50 40"]) as controller:
        connection = socket.create_connection((controller.address, DASHBOARD_PORT), LIMIT_S)
        lines = connection.makefile()
        lines.readline()
        begin_s = time.monotonic()
        for line in [b"robotmode\n", b"safetymode\n", b"running\n"] * 10:
            connection.sendall(line)
            time.sleep(0.005)
        words = [lines.readline().split(":")[0] for _ in range(30)]
        connection.close()
        assert words == ["Robotmode", "Safetymode", "Program running"] * 10
        took_s = time.monotonic() - begin_s
        assert took_s > 0.1
        in_time(took_s, 1, "thirty answers")


def test_kill_and_a_schedule() -> None:
    with ControllerProcess() as controller:
        controller.command("in 0.3 kill")
        assert listens(controller.address)
        assert 0.1 < wait_until_gone(controller.address) < 2
        with pytest.raises(RobotError):
            controller.command("state")


def test_connections_leave_nothing_behind() -> None:
    with ControllerProcess(speed_up=4) as controller:
        child = psutil.Process(controller.pid)
        state(controller)
        before = child.num_fds()
        for _ in range(40):
            links = [
                socket.create_connection((controller.address, port), LIMIT_S)
                for port in (DASHBOARD_PORT, SCRIPT_PORT, RTDE_PORT)
            ]
            for link in links:
                link.close()
        until_s = time.monotonic() + LIMIT_S
        while (state(controller)["connections"] or child.num_fds() > before) and time.monotonic() < until_s:
            time.sleep(0.02)
        assert child.num_fds() == before and state(controller)["counts"]["connection rtde"] == 40


def test_a_client_that_never_reads_costs_no_memory() -> None:
    with ControllerProcess("UR5e", "5.11", speed_up=10) as controller:
        names = ",".join(sorted(OUTPUT_TYPES)).encode()
        with socket.create_connection((controller.address, RTDE_PORT), LIMIT_S) as connection:
            connection.sendall(frame(Kind.SETUP_OUTPUTS, b"\x00" * 8 + names) + frame(Kind.START))
            child = psutil.Process(controller.pid)
            time.sleep(0.5)
            before = child.memory_info().rss
            time.sleep(1.5)
            assert child.memory_info().rss - before < 8e6


def test_the_wrong_arm_and_a_stuck_joint_are_seen_from_outside(controller: ControllerProcess) -> None:
    controller.command("model UR5e")
    controller.command("stick 1 6")
    assert state(controller)["model"] == "UR5e"
    assert state(controller)["joints_rad"] == pytest.approx(HOME_RAD)
    controller.command("unstick")
    controller.command("model UR5")


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_the_command_line_serves_until_it_is_told_to_end(how: signal.Signals) -> None:
    address = f"127.77.{os.getpid() % 250 + 1}.{how}"
    process = subprocess.Popen(
        [sys.executable, "-m", "app.cli", "ur-controller", "--address", address, "--model", "UR5e",
         "--version", "5.11", "--speed-up", "2", "--fault", "in 60 protective stop"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=ROOT,
    )  # fmt: skip
    assert process.stdout is not None
    line = process.stdout.readline().decode()
    assert address in line and "UR5e" in line
    assert listens(address)
    process.send_signal(how)
    _, complaints = process.communicate(timeout=HANG_S)
    assert process.returncode == 0 and complaints == b""


def test_the_command_line_serves_a_gripper_beside_the_arm() -> None:
    address = f"127.78.{os.getpid() % 250 + 1}.9"
    process = subprocess.Popen(
        [sys.executable, "-m", "app.cli", "ur-controller", "--address", address, "--robotiq", "2F-140"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=ROOT,
    )  # fmt: skip
    assert process.stdout is not None
    assert "Robotiq 2F-140 answers at port 63352" in process.stdout.readline().decode()
    with RobotiqLine(RobotiqAddress(address)) as line:
        assert line.get("OBJ") in set(Contact)
    process.terminate()
    process.communicate(timeout=HANG_S)
    assert process.returncode == 0


def test_the_command_line_explains_what_cannot_be() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "app.cli", "ur-controller", "--address", "10.0.0.1"],
        capture_output=True, cwd=ROOT, timeout=HANG_S, check=False,
    )  # fmt: skip
    assert done.returncode == 1 and done.stderr.decode().count("\n") == 1


def test_faults_of_the_arm_and_its_safety_system(controller: ControllerProcess) -> None:
    before = state(controller)["joints_rad"]
    controller.command("jump 2 -0.03")
    assert state(controller)["joints_rad"][1] == pytest.approx(before[1] - 0.03)
    controller.command("jump 2 0.03")
    controller.command("reduced")
    assert state(controller)["safety_mode"] == "REDUCED"
    controller.command("normal")
    controller.command(f"limit 2 {before[1] + 0.1} 3")
    wait_until(lambda: state(controller)["safety_mode"] == "PROTECTIVE_STOP")
    controller.command("no limits")


def test_a_frozen_controller_stands_still_and_is_silent_until_it_thaws() -> None:
    with ControllerProcess() as controller:
        controller.command("freeze")
        first_s = state(controller)["time_s"]
        with socket.create_connection((controller.address, DASHBOARD_PORT), 1) as client:
            client.settimeout(0.3)
            with pytest.raises(TimeoutError):
                client.recv(100)
            assert state(controller)["time_s"] == first_s
            controller.command("thaw")
            client.settimeout(HANG_S)
            assert client.recv(100).startswith(b"Connected")
        wait_until(lambda: state(controller)["time_s"] > first_s)


def test_single_connections_are_dropped_and_the_dashboard_may_be_late() -> None:
    with ControllerProcess() as controller:
        ports = (DASHBOARD_PORT, RTDE_PORT, RTDE_PORT)
        clients = [socket.create_connection((controller.address, port), 1) for port in ports]
        wait_until(lambda: len(state(controller)["connections"]) == 3)
        controller.command("drop rtde 2")
        wait_until(lambda: state(controller)["connections"] == ["dashboard", "rtde"])
        controller.command("drop dashboard")
        wait_until(lambda: state(controller)["connections"] == ["rtde"])
        for client in clients:
            client.close()
        controller.command("dashboard delay 0.3")
        with socket.create_connection((controller.address, DASHBOARD_PORT), 1) as late:
            assert late.recv(100)
            began_s = time.monotonic()
            late.sendall(b"robotmode\n")
            assert late.recv(100) == b"Robotmode: RUNNING\n"
            assert time.monotonic() - began_s >= 0.3


def test_its_pace_can_be_changed() -> None:
    with ControllerProcess() as controller, AwakeClock() as clock:
        controller.command("pace 5")
        began_s, first_s = clock.now_s(), state(controller)["time_s"]
        time.sleep(0.5)
        assert state(controller)["time_s"] - first_s > 2 * (clock.now_s() - began_s)
