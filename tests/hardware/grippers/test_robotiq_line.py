"""The gripper's own protocol, against the simulated server and against one that sends what it likes."""

from __future__ import annotations

import socket
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from threading import Thread

import pytest

from hardware.errors import GripperError
from hardware.grippers import robotiq_line
from hardware.grippers.robotiq_line import (
    Contact,
    RobotiqAddress,
    RobotiqLine,
    activate,
    holds_object,
    is_activated,
    refuse_faulty,
)
from hardware.simulation.ur_controller.process import ControllerProcess
from tests.patience import wait_until

pytestmark = pytest.mark.system

CLOSED = 230


@pytest.fixture(scope="module")
def served() -> Iterator[ControllerProcess]:
    with ControllerProcess(robotiq="2F-85", speed_up=4.0) as controller:
        yield controller


@pytest.fixture
def controller(served: ControllerProcess) -> ControllerProcess:
    served.command("hand sane")
    served.command("hand full")
    activate(RobotiqAddress(served.address))
    return served


@contextmanager
def answering(*parts: Sequence[bytes]) -> Iterator[RobotiqAddress]:
    """A server that answers each line with the next sequence of parts, sent one by one."""
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve() -> None:
            with server.accept()[0] as client:
                for answer in parts:
                    if not client.recv(200):
                        return
                    for part in answer:
                        client.sendall(part)
                        time.sleep(0.001)
                with suppress(OSError):  # one that was told nonsense hangs up
                    client.recv(200)

        thread = Thread(target=serve, daemon=True)
        thread.start()
        yield RobotiqAddress("127.0.0.1", server.getsockname()[1])
        thread.join()


def test_registers_are_read_and_written(controller: ControllerProcess) -> None:
    with RobotiqLine(RobotiqAddress(controller.address)) as line:
        assert line.get("STA") == robotiq_line.ACTIVE
        line.set(GTO=1, SPE=255, FOR=50, POS=CLOSED)
        assert line.get("PRE") == CLOSED
        assert line.get("FOR") == 50
        wait_until(lambda: line.get("OBJ") == Contact.WHILE_CLOSING)
        assert holds_object(RobotiqAddress(controller.address))
        line.set(POS=0)
        wait_until(lambda: line.get("OBJ") == Contact.NONE)
        assert not holds_object(RobotiqAddress(controller.address))


@pytest.mark.parametrize(
    ("parts", "value"),
    [([b"POS 12\n"], 12), ([b"POS 255"], 255), ([b"PO", b"S 2", b"5\n"], 25), ([b"POS 7\r\n"], 7)],
)
def test_an_answer_may_come_in_parts_and_without_its_end(parts: Sequence[bytes], value: int) -> None:
    with answering(parts) as address, RobotiqLine(address, within_s=5.0) as line:
        assert line.get("POS") == value


@pytest.mark.parametrize(
    "answer", [b"?\n", b"ack", b"SPE 12\n", b"POS 256\n", b"POS -1\n", b"POS\n", b"\xff\xfe\n", b"x" * 5000]
)
def test_a_wrong_answer_is_a_sentence_and_ends_the_connection(answer: bytes) -> None:
    with answering([answer]) as address, RobotiqLine(address, within_s=5.0) as line:
        with pytest.raises(GripperError, match="is no Robotiq gripper") as refused:
            line.get("POS")
        assert len(str(refused.value)) < 300
        with pytest.raises(GripperError, match="does not answer"):
            line.get("POS")


def test_what_is_not_acknowledged_was_not_done() -> None:
    with (
        answering([b"nack\n"]) as address,
        RobotiqLine(address, 5.0) as line,
        pytest.raises(GripperError),
    ):
        line.set(POS=3)


def test_silence_and_a_lost_link_are_said(controller: ControllerProcess) -> None:
    address = RobotiqAddress(controller.address)
    with RobotiqLine(address) as line:
        controller.command("hand silent")
        with pytest.raises(GripperError, match="does not answer to 'GET POS'"):
            line.get("POS")
        assert line.is_closed
    controller.command("hand sane")
    with RobotiqLine(address) as line:
        line.get("POS")  # a connection exists here before the server has accepted it
        controller.command("drop robotiq")
        with pytest.raises(GripperError, match="does not answer"):
            line.get("POS")


def test_nobody_there() -> None:
    with pytest.raises(GripperError, match=r"Nobody serves a Robotiq gripper at 127\.0\.0\.1:9"):
        RobotiqLine(RobotiqAddress("127.0.0.1", 9))


def test_a_gripper_that_is_not_activated_or_faulty_is_refused(controller: ControllerProcess) -> None:
    address = RobotiqAddress(controller.address)
    with RobotiqLine(address) as line:
        refuse_faulty(line, address)
        controller.command("hand off")
        assert not is_activated(address)
        with pytest.raises(GripperError, match="is not activated; empty the hand"):
            refuse_faulty(line, address)
        activate(address)
        refuse_faulty(line, address)
        controller.command("hand fault 14")
        with pytest.raises(GripperError, match="0x0E: too much current"):
            refuse_faulty(line, address)
