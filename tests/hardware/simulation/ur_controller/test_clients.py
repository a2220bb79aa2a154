"""ur_rtde's unmodified clients against the simulated controller."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from hardware.robots.joint_motion import Trapezoid
from hardware.simulation.ur_controller.process import ControllerProcess
from tests.hardware.simulation.ur_controller import clients

pytestmark = [pytest.mark.system, pytest.mark.punctual]

pytest.importorskip("rtde_control", reason="needs ur-rtde")

PAUSED, STOPPED = 4, 1
PROTECTIVE, EMERGENCY = 3, 7


@pytest.fixture
def cb3() -> Iterator[ControllerProcess]:
    with ControllerProcess("UR5", "3.15") as controller:
        yield controller


@pytest.fixture
def e_series() -> Iterator[ControllerProcess]:
    with ControllerProcess("UR5e", "5.11") as controller:
        yield controller


def state(controller: ControllerProcess) -> Any:
    return json.loads(controller.command("state"))


@pytest.mark.parametrize("kind", ["cb3", "e_series"])
def test_moves_outputs_and_slider(kind: str, request: pytest.FixtureRequest) -> None:
    controller = request.getfixturevalue(kind)
    seen = clients.run("moves", controller.address, 0.008 if kind == "cb3" else 0.002)
    assert seen["is_taken"]
    assert seen["move_s"] == pytest.approx(Trapezoid(0.5, 1.0, 2.0).duration_s, abs=0.15)
    assert seen["reached"] == pytest.approx(0.5, abs=1e-9)
    assert seen["stop_s"] < 0.3 and seen["speed_after_stop"] == 0
    assert 0 < seen["lag"] < 0.05 and abs(seen["left"]) < 1e-3
    assert seen["output_s"] < 1 and seen["outputs"] == 2
    assert seen["slider"][0] and seen["slider"][1] < 1
    assert state(controller)["tool_outputs"] == [False, True] and state(controller)["slider"] == 0.4
    counts = state(controller)["counts"]
    assert counts["inputs"] == 23 + 16 and counts["script"] == 1
    assert not [entry for entry in json.loads(controller.command("log 2000")) if entry.get("unknown")]


def test_a_path_is_blended(e_series: ControllerProcess) -> None:
    seen = clients.run("path", e_series.address)
    assert seen["is_taken"] and seen["steps"] == [0, 1, 2] and seen["off_rad"] < 1e-9
    ends_at = len(seen["speeds"]) - 1
    while seen["speeds"][ends_at] < 0.3:
        ends_at -= 1
    assert min(seen["speeds"][:ends_at]) > 0.2, "it never stands on the way"


def test_services_of_the_program(cb3: ControllerProcess) -> None:
    seen = clients.run("services", cb3.address)
    assert seen["set"] and seen["within"] and seen["steady"] and seen["payload"]
    np.testing.assert_allclose(seen["tcp"], [0, 0, 0.1, 0, 0, 0], atol=1e-9)
    assert seen["with_tool"] < 1
    np.testing.assert_allclose(seen["ik"][0], seen["ik"][1], atol=1e-4)
    np.testing.assert_allclose(seen["trans"][:2], [0.1 + 0.1 * np.cos(1), 0.1 * np.sin(1)], atol=1e-9)
    assert seen["impossible"] == [] and not seen["runs_after"]
    assert state(cb3)["payload_kg"] == 1.5


@pytest.mark.parametrize(
    ("fault", "safety_mode", "runtime_state", "recovers"),
    [
        ("protective_stop", PROTECTIVE, PAUSED, False),
        ("emergency_stop", EMERGENCY, STOPPED, False),
        ("program_stop", 1, STOPPED, True),
        ("program_pause", 1, PAUSED, True),
    ],
)
def test_an_interrupted_move_returns_false_and_so_does_every_later_one(
    cb3: ControllerProcess, fault: str, safety_mode: int, runtime_state: int, recovers: bool
) -> None:
    seen = clients.run(fault, cb3.address)
    assert seen["blocking"] is False and seen["again"] is False
    assert 0.3 < seen["took_s"] < 1.2, "the move would have taken 2 s"
    assert 0 < seen["at"] < 1.5
    assert (seen["safety_mode"], seen["runtime_state"]) == (safety_mode, runtime_state)
    assert seen["is_protective"] == (safety_mode == PROTECTIVE)
    assert seen["is_emergency"] == (safety_mode == EMERGENCY)
    assert seen["reupload"] is True, "also where the controller does not take the script"
    assert seen["runs"] is seen["after_reupload"] is recovers


def test_play_after_a_pause_lets_the_old_move_go_on(cb3: ControllerProcess) -> None:
    seen = clients.run("goes_on", cb3.address)
    assert seen["blocking"] is False
    assert seen["paused_at"] < 0.55
    assert seen["ends_at"] == pytest.approx(0.6, abs=1e-6)


def test_the_progress_of_a_stopped_asynchronous_move_stays(cb3: ControllerProcess) -> None:
    progress, speed = clients.run("asynchronous_stop", cb3.address)
    assert progress >= 0, "it says that it is running"
    assert speed == 0


def test_the_watchdog(cb3: ControllerProcess) -> None:
    fed, starved_s = clients.run("starved", cb3.address)
    assert fed and starved_s < 1


def test_the_receiver_notices_a_closed_link_and_keeps_the_old_data(cb3: ControllerProcess) -> None:
    lost_s, is_old = clients.run("drop_receive", cb3.address)
    assert lost_s < 1 and is_old


def test_the_first_write_after_a_closed_link_is_lost(cb3: ControllerProcess) -> None:
    first, second = clients.run("drop_io", cb3.address)
    assert first is True and second
    assert not any(state(cb3)["tool_outputs"]), "the write that returned True was lost"


def test_the_control_object_reconnects_and_sends_its_script_again(cb3: ControllerProcess) -> None:
    with pytest.raises((clients.Hung, clients.Crashed)):  # it does either, from run to run
        clients.run("drop_control", cb3.address, limit_s=2)
    assert state(cb3)["counts"]["script"] >= 2


def test_a_silent_link_hangs_a_blocking_move_and_the_arm_goes_on(cb3: ControllerProcess) -> None:
    with pytest.raises(clients.Hung):
        clients.run("silent_move", cb3.address, limit_s=2)
    assert state(cb3)["joints_rad"][0] == pytest.approx(0.5)


def test_a_silent_link_is_noticed_by_the_receiver_later(cb3: ControllerProcess) -> None:
    noticed_s, is_old = clients.run("silent_receive", cb3.address)
    assert 1 < noticed_s < 4.5 and is_old


def test_a_silent_controller_freezes_the_constructor(cb3: ControllerProcess) -> None:
    cb3.command("link silent")
    with pytest.raises(clients.Hung):
        clients.run("construct", cb3.address, limit_s=1.5)


def test_a_controller_that_refuses_connections(cb3: ControllerProcess) -> None:
    cb3.command("refuse")
    message, time_s = clients.run("construct", cb3.address)
    assert message and time_s < 3
    cb3.command("link restore")
    assert clients.run("construct", cb3.address)[0] == ""


def test_a_controller_without_power_is_reported_after_five_seconds(cb3: ControllerProcess) -> None:
    cb3.command("power off")
    message, time_s = clients.run("construct", cb3.address)
    assert "Failed to start control script" in message and 4 < time_s < 8
    assert state(cb3)["counts"]["script"] >= 1


def test_local_control_is_said_so(e_series: ControllerProcess) -> None:
    e_series.command("local")
    message, _ = clients.run("construct", e_series.address)
    assert "enable remote control" in message


def test_a_second_client_finds_the_registers_taken(cb3: ControllerProcess) -> None:
    (message, _), first_is_fine = clients.run("construct_second", cb3.address)
    assert "already in use" in message and first_is_fine
    cb3.command("take registers")
    assert "already in use" in clients.run("construct", cb3.address)[0]
    cb3.command("release registers")
    assert clients.run("construct", cb3.address)[0] == ""


def test_latency_is_felt(cb3: ControllerProcess) -> None:
    cb3.command("latency 20 2")
    assert clients.run("round_trips", cb3.address) > 0.04, "without it, two cycles of 8 ms"
