"""STOP reaches the controller, whatever else happens; and what the window knows of the arm is true."""

from __future__ import annotations

import json
import os
import signal
import socket
import time

import pytest

from app.jobs.arm_events import ArmStatus, MoveProgress
from app.jobs.arm_work import ArmWork
from app.jobs.messages import Failed
from app.jobs.session_work import SessionWork
from app.operations.session import SessionTask
from core.parameters import apply_settings
from hardware.cell import read_cell
from hardware.simulation.ur_controller.identity import CONTROL_PORT
from tests.app.sessions import copied
from tests.awake import AwakeClock, in_time, within

pytestmark = [pytest.mark.system, pytest.mark.punctual]

pytest.importorskip("rtde_control")

AT_ONCE_S = 0.1


@pytest.fixture
def connected(desk, qtbot):
    """A desk whose arm is connected."""
    do(desk, qtbot, ArmWork.connect, read_cell())
    qtbot.waitUntil(lambda: desk.arm.has_stop_line and desk.arm.status is not None)
    return desk


def do(desk, qtbot, method, *arguments):
    """Carry out a job of the arm's host and return its result."""
    ended = []
    desk.jobs.failed.connect(lambda _job, failed: ended.append(failed))
    desk.jobs.start("Job", "robot", desk.arm_host, method, *arguments, then=ended.append, patience_s=10)
    qtbot.waitUntil(lambda: bool(ended))
    assert not isinstance(ended[0], Failed), ended[0]
    return ended[0]


def begin_pour(desk, qtbot, session):
    """Let it pour, and return when the cup is on its way."""
    desk.workspace.open(session)
    planned = do(desk, qtbot, ArmWork.plan, desk.workspace.task(), read_cell())
    desk.jobs.start(
        "Pour", "robot", desk.arm_host, ArmWork.pour, planned.number, time.monotonic(), patience_s=10
    )
    with qtbot.waitSignal(
        desk.jobs.event_received,
        # At its very beginning, the driver may not have been asked yet.
        check_params_cb=lambda news: (
            isinstance(news, MoveProgress) and news.name == "lay" and news.fraction > 0.1
        ),
    ):
        pass


def press_stop(desk, qtbot):
    with qtbot.waitSignal(desk.arm.stopped) as stopped:
        desk.arm.stop()
    return stopped.args[0]


def controller(desk, line="state"):
    """What the simulated controller says; `address` is remembered for when the desk has forgotten it."""
    with socket.create_connection((desk.arm.connected.stop_address, CONTROL_PORT), 5) as connection:
        connection.sendall(line.encode() + b"\n")
        return connection.makefile().readline()


def seconds_to_rest(desk):
    with AwakeClock() as clock:
        began_s = clock.now_s()
        while json.loads(controller(desk))["is_moving"]:
            in_time(clock.now_s() - began_s, 2, "coming to rest")
            time.sleep(0.01)
        return clock.now_s() - began_s


def test_stop_is_taken_at_once_while_a_pour_runs_and_the_other_processes_are_busy(
    connected, qtbot, mug_session
):
    desk = connected
    begin_pour(desk, qtbot, mug_session)
    with qtbot.waitSignal(desk.jobs.failed) as failed:
        done = press_stop(desk, qtbot)
        rest_s = seconds_to_rest(desk)
    print(f"pour under way: taken after {1000 * done.seconds:.1f} ms, at rest after {1000 * rest_s:.0f} ms")
    assert done.sentence == ""
    in_time(done.seconds, AT_ONCE_S, "STOP")
    assert "stopped" in failed.args[1].sentence.lower()
    with within(3.0):
        qtbot.waitUntil(lambda: bool(desk.arm.status.problem) and desk.arm.status.must_back_off)


def test_stop_is_taken_at_once_while_the_session_is_imagined(
    connected, qtbot, made_sessions, mug_session, tmp_path
):
    desk = connected
    desk.workspace.open(mug_session)
    task = desk.workspace.task()
    other = copied(made_sessions("mug"), tmp_path / "other")
    busy = SessionTask(other, apply_settings(task.parameters, {"seed": 5}), task.preset)
    desk.session_host.start(SessionWork.imagine, busy)
    begin_pour(desk, qtbot, mug_session)
    is_busy = desk.session_host.is_busy
    done = [press_stop(desk, qtbot) for _ in range(3)]
    print(f"session busy: taken after {', '.join(f'{1000 * one.seconds:.1f}' for one in done)} ms")
    assert is_busy, "else this proves nothing"
    in_time(max(one.seconds for one in done), AT_ONCE_S, "STOP")
    in_time(seconds_to_rest(desk), 0.5, "coming to rest")


def test_stop_is_taken_at_once_while_the_process_that_pours_is_frozen(connected, qtbot, mug_session):
    desk = connected
    begin_pour(desk, qtbot, mug_session)
    controller(desk, "pace 1")  # four times as fast, this part of the pour could end while the host is frozen
    os.kill(desk.arm_host.pid, signal.SIGSTOP)
    try:
        qtbot.wait(200)
        assert json.loads(controller(desk))["is_moving"], "the driver goes on without it"
        done = press_stop(desk, qtbot)
        rest_s = seconds_to_rest(desk)
        with within(4.0):
            qtbot.waitUntil(lambda: desk.arm.is_silent)
        assert desk.arm.connected is not None
    finally:
        os.kill(desk.arm_host.pid, signal.SIGCONT)
    print(f"host frozen: taken after {1000 * done.seconds:.1f} ms, at rest after {1000 * rest_s:.0f} ms")
    in_time(done.seconds, AT_ONCE_S, "STOP")
    qtbot.waitUntil(lambda: desk.jobs.is_idle and desk.arm.status.must_back_off)
    assert not desk.arm.is_silent


def test_a_killed_process_is_noticed_without_a_job(connected, qtbot):
    desk = connected
    desk.arm_host.kill()
    with within(3.0):
        qtbot.waitUntil(lambda: desk.arm.connected is None)
    assert "ended unexpectedly" in desk.arm.farewell
    assert not desk.arm.has_stop_line
    do(desk, qtbot, ArmWork.connect, read_cell())
    assert desk.arm.is_ours_to_pour
    assert desk.arm.farewell == ""


def test_a_stop_that_nobody_can_confirm_is_reported_as_such(connected, qtbot):
    desk = connected
    os.kill(desk.arm_host.pid, signal.SIGSTOP)
    try:
        controller(desk, "link silent")
        done = press_stop(desk, qtbot)
    finally:
        os.kill(desk.arm_host.pid, signal.SIGCONT)
    assert "emergency stop" in done.sentence
    in_time(done.seconds, 1.5, "STOP")


def test_a_line_that_is_cut_does_not_keep_the_process_from_stopping(connected, qtbot):
    desk = connected
    desk.arm._line.close()
    done = press_stop(desk, qtbot)
    assert done.sentence == ""
    with within(3.0):
        qtbot.waitUntil(lambda: bool(desk.arm.status.problem))


def test_without_an_arm_there_is_nothing_to_stop(desk, qtbot):
    assert "nothing to stop" in press_stop(desk, qtbot).sentence


def test_states_come_ten_times_a_second(connected, qtbot):
    events = []
    connected.jobs.event_received.connect(events.append)
    qtbot.wait(1000)
    assert 6 <= sum(isinstance(event, ArmStatus) for event in events) <= 14
