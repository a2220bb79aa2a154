"""STOP's own line to the controller."""

from __future__ import annotations

import json
import socket
import time
from contextlib import contextmanager

import pytest

from hardware.errors import RobotError, RobotLost
from hardware.robots.ur.probe import DASHBOARD_PORT
from hardware.robots.ur.stop_line import StopLine
from hardware.simulation.ur_controller.process import ControllerProcess
from tests.awake import AwakeClock, in_time, within
from tests.hardware.robots.ur.bench import HOME
from tests.patience import wait_until

pytestmark = [pytest.mark.system, pytest.mark.punctual]


@contextmanager
def line_to(controller):
    line = StopLine(controller.address)
    wait_until(lambda: line.is_open)
    yield line
    line.close()


@pytest.fixture
def line(controller):
    with line_to(controller) as line:
        yield line


def seconds(line):
    with AwakeClock() as clock:
        began_s = clock.now_s()
        line.stop()
        return clock.now_s() - began_s


def test_it_stops_what_moves_in_a_tenth_of_a_second(bench):
    with line_to(bench.controller) as line:
        bench.begin("follow")
        took_s = seconds(line)
        in_time(took_s, 0.1, "the stop")
        in_time(bench.seconds_to_rest(), 0.4, "coming to rest")
    print(f"taken after {1000 * took_s:.1f} ms")
    bench.robot.recover()


def test_two_presses_are_both_answered(line):
    assert seconds(line) < 0.1
    assert seconds(line) < 0.1


def test_a_broken_line_is_opened_anew_by_itself(controller, line):
    controller.command("link drop")
    wait_until(lambda: not line.is_open)
    wait_until(lambda: line.is_open)
    assert seconds(line) < 0.1


def test_a_stop_that_finds_the_line_broken_opens_another(controller, line):
    controller.command("link drop")
    assert seconds(line) < 0.5


def test_a_line_without_answers_is_given_up(controller, line):
    controller.command("link silent 0.4")
    assert 0.2 < seconds(line) < 1.0, "the new connection is greeted when the link is there again"


def test_nobody_there_is_said_within_a_second(controller, line):
    controller.command("link silent")
    with within(1.5), pytest.raises(RobotLost, match="press the emergency stop"):
        line.stop()


def test_an_address_without_a_controller():
    line = StopLine("127.9.9.7")
    with pytest.raises(RobotLost):
        line.stop()
    assert not line.is_open
    line.close()


def test_somebody_else_is_not_taken_for_a_controller():
    with socket.create_server(("127.9.9.6", DASHBOARD_PORT)) as stranger:
        line = StopLine("127.9.9.6")
        connection, _ = stranger.accept()
        connection.sendall(b"220 mail.example ESMTP\r\n")
        time.sleep(0.1)
        assert not line.is_open
        line.close()
        connection.close()


def test_a_refusal_is_no_stop():
    local = ControllerProcess(version="5.11", joints_rad=HOME, faults=["local"])
    refused = pytest.raises(RobotError, match="refuses to stop")
    with local as controller, line_to(controller) as line, refused:
        line.stop()


def test_a_closed_line_leaves_no_connection(controller, line):
    line.close()
    wait_until(lambda: json.loads(controller.command("state"))["connections"] == [])
