"""Each row of the fault table, during approach, carry and pour, through the real driver over TCP."""

from __future__ import annotations

import os
import signal
import time

import pytest

from core.session.pour_runs import PourRun, pour_runs
from hardware.errors import (
    EmergencyStop,
    NotInRemoteControl,
    OutputChanged,
    ProgramStopped,
    ProtectiveStop,
    RobotError,
    RobotLost,
    RobotNotReady,
    TrackingLost,
)
from tests.awake import in_time
from tests.hardware.pouring.rig import Rig, driver_pid
from tests.patience import HANG_S

pytestmark = [pytest.mark.system, pytest.mark.punctual]

pytest.importorskip("rtde_control")

AT_REST_WITHIN_S = 0.5
FAULTS = {
    "protective stop": (ProtectiveStop, ()),
    "emergency stop": (EmergencyStop, ("emergency release",)),
    "program stop": (ProgramStopped, ()),
    "program pause": (ProgramStopped, ()),
    "power off": (RobotNotReady, ()),
    "link drop": ((RobotLost, ProgramStopped), ()),
    "link silent": (RobotLost, ("link restore",)),
    "stick 1 2 3 4 5 6": (TrackingLost, ("unstick",)),
}
POURED_AFTER = ("protective stop", "link drop", signal.SIGKILL)
"""After these faults while pouring a whole pour follows; after others the next test's pour is the proof."""
PHASES = {"approach": ("to the cup", 0.5), "carry": ("carry", 0.5), "pour": ("pour", 0.4)}


@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_stops_the_arm_and_it_recovers_without_a_restart(rig, fault, phase):
    kind, repair = FAULTS[fault]
    thread = rig.pour_until(*PHASES[phase])
    rig.controller.command(fault)
    rested_after_s = rig.seconds_to_rest()
    thread.join(HANG_S)

    in_time(rested_after_s, AT_REST_WITHIN_S, "coming to rest")
    assert isinstance(thread.error, kind), repr(thread.error)
    is_explained(thread.error)
    nothing_continues(rig)
    session_is_intact(rig)
    for line in repair:
        rig.controller.command(line)
    nothing_continues(rig)
    recovers(rig)
    if phase == "pour" and fault in POURED_AFTER:
        pours(rig)


@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_a_driver_that_dies_or_freezes_stops_the_arm(rig, number, phase):
    thread = rig.pour_until(*PHASES[phase])
    os.kill(driver_pid(), number)
    rested_after_s = rig.seconds_to_rest()
    thread.join(HANG_S)

    in_time(rested_after_s, AT_REST_WITHIN_S, "coming to rest")
    assert isinstance(thread.error, RobotError), repr(thread.error)
    is_explained(thread.error)
    nothing_continues(rig)
    session_is_intact(rig)
    recovers(rig)
    if phase == "pour" and number in POURED_AFTER:
        pours(rig)


def test_a_cup_that_is_being_grasped_is_left_at_its_station(rig):
    thread = rig.pour_in_background()
    while thread.is_alive() and not rig.arm.gripper.is_closed:
        time.sleep(0.005)
    os.kill(driver_pid(), signal.SIGKILL)
    thread.join(HANG_S)
    assert isinstance(thread.error, RobotError), repr(thread.error)
    recovers(rig)
    pours(rig)


@pytest.mark.parametrize("move", ["lift", "carry", "pour", "carry back"])
def test_a_gripper_that_lets_go_stops_the_arm_which_goes_home_without_a_cup(rig, move):
    thread = rig.pour_until(move, 0.4)
    rig.controller.command("output lost")
    rested_after_s = rig.seconds_to_rest()
    thread.join(HANG_S)

    in_time(rested_after_s, AT_REST_WITHIN_S, "coming to rest")
    assert isinstance(thread.error, OutputChanged), repr(thread.error)
    is_explained(thread.error)
    session_is_intact(rig)
    rig.pouring.recover()
    back = rig.pouring.plan_back_off()
    assert not any(move.holds_cup for move in back)
    rig.pouring.back_off(back)
    assert rig.is_home


def test_a_gripper_that_never_closes_is_noticed_at_the_cup(rig):
    rig.controller.command("ignore outputs")
    thread = rig.pour_in_background()
    thread.join(HANG_S)
    rig.controller.command("heed outputs")
    assert "did not change" in str(thread.error)
    recovers(rig)


@pytest.mark.parametrize("fault", ["program stop", "protective stop"])
def test_a_second_stop_on_the_way_back_has_a_way_back_too(rig, fault):
    thread = rig.pour_until("carry", 0.6)
    rig.controller.command("program stop")
    thread.join(HANG_S)
    rig.pouring.recover()
    moves = rig.pouring.plan_back_off()
    rig.controller.command(f"when moving in 0.2 {fault}")
    with pytest.raises(RobotError):
        rig.pouring.back_off(moves)
    assert rig.pouring.is_interrupted
    assert rig.arm.gripper.is_closed
    recovers(rig)


def test_a_slow_link_costs_time_and_nothing_else(rig):
    rig.controller.command("latency 20 20")
    try:
        thread = rig.pour_in_background()
        thread.join(HANG_S)
    finally:
        rig.controller.command("link restore")
    assert thread.error is None
    assert PourRun.load(rig.pouring.last_run).is_done


def test_somebody_who_cancels_stops_the_arm(rig):
    thread = rig.pour_until("carry", 0.5)
    rig.reporter.cancel()
    in_time(rig.seconds_to_rest(), AT_REST_WITHIN_S, "coming to rest")
    thread.join(HANG_S)
    assert type(thread.error).__name__ == "Cancelled"
    nothing_continues(rig)
    rig.reporter.forget_cancel()
    recovers(rig)


def test_emergency_stop_that_is_still_pressed_and_local_control_are_named_on_recovery(tmp_path):
    # An e-Series sends 500 states a second: six times as many would need two processors, with the driver's.
    with Rig(tmp_path, speed_up=2.0, version="5.11") as rig:
        thread = rig.pour_until("carry", 0.3)
        rig.controller.command("emergency stop")
        thread.join(HANG_S)
        with pytest.raises(EmergencyStop, match="release"):
            rig.pouring.recover()
        rig.controller.command("emergency release")
        rig.controller.command("local")
        with pytest.raises(NotInRemoteControl):
            rig.pouring.recover()
        rig.controller.command("remote")
        recovers(rig)


def is_explained(error):
    """One sentence: what happened and what to do."""
    assert len(str(error)) > 40
    assert "\n" not in str(error)
    assert any(word in str(error) for word in (";", ":")), str(error)


def nothing_continues(rig):
    before = rig.joints_rad
    time.sleep(0.3)
    assert not rig.is_moving
    assert rig.joints_rad == pytest.approx(before, abs=1e-4)


def session_is_intact(rig):
    run = pour_runs(rig.session)[-1]
    assert not run.is_done
    assert run.events[-1]["kind"] == "stopped"
    assert run.sentence.startswith("Stopped during")
    assert (run.folder / "states.csv").stat().st_size > 0


def recovers(rig):
    rig.pouring.recover()
    nothing_continues(rig)
    rig.pouring.back_off(rig.pouring.plan_back_off())
    assert rig.is_home
    assert not rig.arm.gripper.is_closed


def pours(rig):
    run = rig.pouring.carry_out(rig.pouring.plan())
    assert PourRun.load(run).is_done
    assert rig.is_home
