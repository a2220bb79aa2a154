"""The arm's host: connect, plan, pour, stop, come back; with the real driver and a simulated controller."""

from __future__ import annotations

import json
import socket
import time

import numpy as np
import pytest

from app.jobs.arm_events import (
    ArmConnected,
    ArmDisconnected,
    ArmStatus,
    MoveProgress,
    StepPending,
    StopDone,
)
from app.jobs.arm_work import ArmWork
from app.jobs.messages import FailureKind
from app.library.session_folder import remembered_parameters
from app.operations.session import SessionTask
from core.errors import SessionError
from core.motion.pour.plan import MOVES
from core.parameters import apply_settings
from core.session import Session
from core.session.operator_choice import write_operator_choice
from core.session.pour_runs import pour_runs
from hardware.cell import read_cell
from hardware.interfaces import ReadyStep
from hardware.simulation.ur_controller.identity import CONTROL_PORT
from hardware.simulation.ur_controller.process import ControllerProcess
from tests.app.jobs.hosts import ListenedHost
from tests.patience import wait_until

pytestmark = [pytest.mark.system, pytest.mark.punctual]

pytest.importorskip("rtde_control")

NAMES = [name for name, *_ in MOVES]
SPEED_UP = 8.0
LONG_S = SPEED_UP * 0.5
"""A move that is planned to take so long is under way for half a second."""


@pytest.fixture
def task(mug_session):
    folder = mug_session
    preset, parameters = remembered_parameters(folder)
    return SessionTask(folder, parameters, preset)


@pytest.fixture(scope="module")
def cell():
    settings = read_cell()
    hurried = settings.simulation.model_copy(update={"speed_up": SPEED_UP})
    return settings.model_copy(update={"simulation": hurried})


class Arm(ListenedHost):
    """The arm's host."""

    def __init__(self):
        super().__init__(ArmWork, "moves the arm")

    def status(self):
        """The next one."""
        return self.wait_for(ArmStatus)

    def controller(self, line):
        """Give the simulated controller a line."""
        address = self.of(ArmConnected)[-1].stop_address
        with socket.create_connection((address, CONTROL_PORT), 5) as connection:
            connection.sendall(line.encode() + b"\n")
            return connection.makefile().readline()


@pytest.fixture(scope="module")
def process():
    """One host for the whole module; each test connects an arm of its own."""
    arm = Arm()
    yield arm
    arm.host.close()


@pytest.fixture
def arm(process):
    process.clear()
    yield process
    process.free()
    process.do(ArmWork.disconnect)


@pytest.fixture
def planned(arm, task, cell):
    assert arm.do(ArmWork.connect, cell) is None
    return arm.do(ArmWork.plan, task, cell)


def during(name):
    return lambda event: isinstance(event, MoveProgress) and event.name == name and event.fraction > 0.2


def stopped_in(arm, planned, name):
    arm.do(ArmWork.pour, planned.number, time.monotonic(), until=during(name))
    arm.host.order(ArmWork.stop)
    return arm.wait()


def test_connect_plan_and_pour_to_the_end(arm, task, planned):
    (connected,) = arm.of(ArmConnected)
    assert connected.is_simulated
    assert connected.pid == arm.host.pid
    assert connected.stop_address.startswith("127.")
    assert planned.plan.clearance_m > 0.02
    assert "The arm can make" in planned.note
    assert planned.expires_s > time.monotonic() + 500
    low_m = planned.mouth_m[:, 2].min()
    assert planned.pivot_m[2] - 0.1 < low_m < planned.pivot_m[2] + 0.1, "the mouth comes down to the pivot"

    arm.do(ArmWork.pour, planned.number, time.monotonic(), until=during("lift"))
    with pytest.raises(SessionError), Session.open(task.folder):
        pass
    assert arm.status().is_gripper_closed
    folder = arm.wait()
    (run,) = pour_runs(task.folder)
    assert (run.folder, run.is_done) == (folder, True)

    progress = arm.of(MoveProgress)
    names = list(dict.fromkeys(event.name for event in progress))
    assert [name for name in NAMES if name in names] == names, "in their order"
    long = [move.name for move in planned.plan.moves if move.trajectory.duration_s > LONG_S]
    assert set(long) <= set(names), "short moves may be over before they are told"
    assert [event.done_s for event in progress] == sorted(event.done_s for event in progress)
    assert progress[-1].left_s < 0.5
    off_m = [event.pivot_off_m for event in progress if event.pivot_off_m is not None]
    assert off_m
    assert max(off_m) < 0.0005
    assert {event.name for event in progress if event.pivot_off_m is not None} == {"pour"}

    status = arm.status()
    assert (status.problem, status.must_back_off, status.is_gripper_closed) == ("", False, False)
    np.testing.assert_allclose(status.state.joints_rad, planned.plan.moves[-1].trajectory.end_rad, atol=2e-3)

    again = arm.do(ArmWork.pour, planned.number, time.monotonic())
    assert "not the plan that was made last" in again.sentence
    assert len(pour_runs(task.folder)) == 1


def test_a_stop_midway_leads_back_to_the_station_and_to_a_new_plan(arm, task, cell, planned):
    failed = stopped_in(arm, planned, "carry")
    assert failed.kind in (FailureKind.EXPLAINED, FailureKind.CANCELLED)
    assert "stopped" in failed.sentence.lower()
    status = arm.status()
    assert status.must_back_off
    assert status.is_gripper_closed
    assert "make it ready again" in status.problem
    assert any(event.sentence == "" for event in arm.of(StopDone))

    for job, words in (
        ((ArmWork.plan, task, cell), "make it ready"),
        ((ArmWork.pour, planned.number, time.monotonic()), "not the plan that was made last"),
        ((ArmWork.move_gripper, False, time.monotonic()), "make it ready"),
    ):
        assert words in arm.do(*job).sentence
    before = arm.status().state.joints_rad
    assert arm.do(ArmWork.recover) is None
    status = arm.status()
    assert (status.problem, status.must_back_off) == ("", True)
    np.testing.assert_allclose(status.state.joints_rad, before, atol=1e-3)
    assert "back off first" in arm.do(ArmWork.move_gripper, False, time.monotonic()).sentence
    assert "back off first" in arm.do(ArmWork.plan, task, cell).sentence

    back = arm.do(ArmWork.plan_back_off, task)
    assert [move.name for move in back.moves][-3:] == ["put down", "retreat", "home"]
    folder = arm.do(ArmWork.back_off, back.number, time.monotonic())
    assert folder.name == "0002"
    status = arm.status()
    assert (status.problem, status.must_back_off, status.is_gripper_closed) == ("", False, False)
    assert arm.do(ArmWork.plan, task, cell).number > back.number


def test_a_stop_before_anything_moved_is_recovered_from_without_backing_off(arm, task, cell, planned):
    arm.host.order(ArmWork.stop)
    arm.wait(lambda event: isinstance(event, ArmStatus) and event.problem)
    refused = arm.do(ArmWork.pour, planned.number, time.monotonic())
    assert "make it ready" in refused.sentence
    assert not pour_runs(task.folder)
    assert arm.do(ArmWork.recover) is None
    assert not arm.status().problem
    assert "nothing to back off from" in arm.do(ArmWork.plan_back_off, task).sentence
    assert arm.do(ArmWork.plan, task, cell).number > planned.number


def test_a_cancelled_pour_stops_the_arm(arm, planned):
    arm.do(ArmWork.pour, planned.number, time.monotonic(), until=during("to the cup"))
    arm.host.cancel()
    failed = arm.wait()
    assert (failed.kind, failed.sentence) == (
        FailureKind.CANCELLED,
        "Stopped on request: the arm is at rest where it was stopped.",
    )
    assert arm.status().must_back_off


def test_what_was_confirmed_too_long_ago_or_is_out_of_date_does_not_move(arm, task, cell, planned):
    late = arm.do(ArmWork.pour, planned.number, time.monotonic() - 5)
    assert "came too late" in late.sentence
    planned = arm.do(ArmWork.plan, task, cell)
    record = Session.open(task.folder).record("pouring")
    i = (planned.plan.i + 1) % 8
    write_operator_choice(task.folder, i, planned.plan.j, "nearer", record.digest)
    other = arm.do(ArmWork.pour, planned.number, time.monotonic())
    assert "Another pour was chosen" in other.sentence
    changed = SessionTask(task.folder, apply_settings(task.parameters, {"seed": 7}), "default")
    assert "imagine again" in arm.do(ArmWork.plan, changed, cell).sentence
    assert not pour_runs(task.folder)


def test_the_gripper_is_moved_by_hand_and_a_closed_one_is_no_start(arm, task, cell, planned):
    assert arm.do(ArmWork.move_gripper, True, time.monotonic()) is None
    assert arm.wait(lambda event: isinstance(event, ArmStatus) and event.is_gripper_closed)
    assert "not the plan" in arm.do(ArmWork.pour, planned.number, time.monotonic()).sentence
    assert "open the gripper" in arm.do(ArmWork.plan, task, cell).sentence
    assert arm.do(ArmWork.move_gripper, False, time.monotonic()) is None
    assert arm.do(ArmWork.plan, task, cell).number > planned.number


def test_a_killed_host_takes_the_simulated_arm_with_it_and_another_one_connects(arm, task, cell, planned):
    address = arm.of(ArmConnected)[-1].stop_address
    arm.do(ArmWork.pour, planned.number, time.monotonic(), until=during("lay"))
    arm.host.kill()
    failed = arm.wait()
    assert failed.kind is FailureKind.DIED
    wait_until(lambda: not is_there(address))
    (run,) = pour_runs(task.folder)
    assert "ended while the arm moved" in run.sentence
    assert arm.do(ArmWork.connect, cell) is None
    assert arm.do(ArmWork.plan, task, cell).plan.digest == planned.plan.digest


def is_there(address):
    try:
        socket.create_connection((address, CONTROL_PORT), 1).close()
    except OSError:
        return False
    return True


def test_a_lost_link_is_reported_and_connecting_again_works(arm, task, cell):
    assert "No arm is connected" in arm.do(ArmWork.plan, task, cell).sentence
    assert arm.do(ArmWork.connect, cell) is None
    arm.controller("link drop 1")
    gone = arm.wait(lambda event: isinstance(event, ArmDisconnected))
    assert "connect again" in gone.sentence
    assert "No arm is connected" in arm.do(ArmWork.recover).sentence
    assert arm.do(ArmWork.connect, cell) is None
    assert not arm.status().problem
    assert arm.do(ArmWork.disconnect) is None
    assert arm.of(ArmDisconnected)[-1] == ArmDisconnected()


def test_what_is_in_the_way_of_connecting_is_named_and_done_step_by_step(arm, cell):
    home_rad = cell.robot.home_rad
    with ControllerProcess(joints_rad=home_rad, speed_up=4.0, faults=["power off"]) as controller:
        real = cell.robot.model_copy(update={"kind": "ur5", "address": controller.address})
        rehearsal = cell.model_copy(update={"robot": real, "is_rehearsal": True})
        step = None
        for expected in (ReadyStep.POWER_ON, ReadyStep.RELEASE_BRAKES):
            failed = arm.do(ArmWork.connect, rehearsal, step)
            assert failed.kind is FailureKind.EXPLAINED
            pending = arm.of(StepPending)[-1]
            assert pending.step is expected
            step = pending.step
        assert arm.do(ArmWork.connect, rehearsal, step) is None
        assert arm.status().problem == ""
        arm.do(ArmWork.disconnect)


def test_a_paused_program_of_somebody_else_is_named_before_recovering_ends_it(arm, cell):
    with ControllerProcess(joints_rad=cell.robot.home_rad, speed_up=4.0) as controller:
        real = cell.robot.model_copy(update={"kind": "ur5", "address": controller.address})
        assert arm.do(ArmWork.connect, cell.model_copy(update={"robot": real, "is_rehearsal": True})) is None
        controller.command("program stop")
        wait_until(lambda: arm.status().problem)
        for line in ("foreign still", "program pause"):
            controller.command(line)
        wait_until(lambda: json.loads(controller.command("state"))["runtime_state"] == "PAUSED")
        failed = arm.do(ArmWork.recover)
        assert failed.kind is FailureKind.EXPLAINED
        pending = arm.of(StepPending)[-1]
        assert pending.step is ReadyStep.END_PROGRAM
        assert "PAUSED weld.urp" in pending.sentence
        assert json.loads(controller.command("state"))["runtime_state"] == "PAUSED"
        for _ in range(3):  # whoever is asked takes longer than the next status
            assert "recover" in arm.status().problem
        assert arm.do(ArmWork.recover, pending.step) is None
        assert arm.status().problem == ""
        arm.do(ArmWork.disconnect)
