"""The dashboard's words, and the protocol where ur_rtde does not go."""

from __future__ import annotations

import json
import socket
import struct
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from hardware.simulation.ur_controller.identity import DASHBOARD_PORT, RTDE_PORT, SCRIPT_PORT
from hardware.simulation.ur_controller.process import ControllerProcess
from hardware.simulation.ur_controller.registers import Registers
from hardware.simulation.ur_controller.rtde_protocol import FrameReader, Kind, frame

LIMIT_S = 5.0
SCRIPT = b"def rtde_control():\n  textmsg(1)\nend\n"


class Dashboard:
    def __init__(self, address: str) -> None:
        self._socket = socket.create_connection((address, DASHBOARD_PORT), LIMIT_S)
        self._lines = self._socket.makefile()
        self.greeting = self._lines.readline().strip()

    def ask(self, line: str) -> str:
        self._socket.sendall(line.encode() + b"\n")
        return self._lines.readline().strip()

    def wait_for(self, line: str, answer: str) -> None:
        until_s = time.monotonic() + LIMIT_S
        while self.ask(line) != answer:
            assert time.monotonic() < until_s, f"{line}: {self.ask(line)}"
            time.sleep(0.01)


@contextmanager
def running(version: str = "3.15", model: str = "UR5") -> Iterator[tuple[ControllerProcess, Dashboard]]:
    with ControllerProcess(model, version, speed_up=10) as controller:
        yield controller, Dashboard(controller.address)


def upload(controller: ControllerProcess, *parts: bytes) -> None:
    with socket.create_connection((controller.address, SCRIPT_PORT), LIMIT_S) as connection:
        for part in parts:
            connection.sendall(part)
            time.sleep(0.02)


def test_power_brakes_and_questions() -> None:
    with running() as (_, dashboard):
        assert dashboard.greeting == "Connected: Universal Robots Dashboard Server"
        for line, answer in [
            ("robotmode", "Robotmode: RUNNING"),
            ("safetymode", "Safetymode: NORMAL"),
            ("safetystatus", "Safetystatus: NORMAL"),
            ("programState", "STOPPED <unnamed>"),
            ("running", "Program running: false"),
            ("PolyscopeVersion", "3.15.0.0"),
            ("get robot model", "UR5"),
            ("get loaded program", "No program loaded"),
            ("load pour.urp", "File not found: pour.urp"),
            ("play", "Failed to execute: play"),
            ("pause", "Failed to execute: pause"),
            ("stop", "Stopped"),
            ("popup hello", "showing popup"),
            ("close popup", "closing popup"),
            ("close safety popup", "closing safety popup"),
            ("is in remote control", "could not understand: 'is in remote control'"),
            ("dance", "could not understand: 'dance'"),
            ("power off", "Powering off"),
        ]:
            assert dashboard.ask(line) == answer
        dashboard.wait_for("robotmode", "Robotmode: POWER_OFF")
        assert dashboard.ask("power on") == "Powering on"
        dashboard.wait_for("robotmode", "Robotmode: IDLE")
        assert dashboard.ask("brake release") == "Brake releasing"
        dashboard.wait_for("robotmode", "Robotmode: RUNNING")
        assert dashboard.ask("quit") == "Disconnected"


def test_a_program_is_paused_and_goes_on() -> None:
    with running() as (controller, dashboard):
        upload(controller, SCRIPT[:7], SCRIPT[7:20], SCRIPT[20:])
        dashboard.wait_for("programState", "PLAYING <unnamed>")
        assert dashboard.ask("running") == "Program running: true"
        assert dashboard.ask("pause") == "Pausing program"
        dashboard.wait_for("programState", "PAUSED <unnamed>")
        assert dashboard.ask("play") == "Starting program"
        dashboard.wait_for("programState", "PLAYING <unnamed>")
        assert dashboard.ask("stop") == "Stopped"
        dashboard.wait_for("programState", "STOPPED <unnamed>")
        upload(controller, b"movej([0,0,0,0,0,0])\n")
        entries = [e for e in json.loads(controller.command("log 50")) if e["what"] == "script"]
        assert [(e["size"], e["is_control_script"]) for e in entries] == [(len(SCRIPT), True), (21, False)]


def test_a_protective_stop_unlocks_after_five_seconds_of_the_controller() -> None:
    with running() as (controller, dashboard):
        controller.command("protective stop")
        assert dashboard.ask("safetymode") == "Safetymode: PROTECTIVE_STOP"
        assert dashboard.ask("unlock protective stop").startswith(
            "Cannot unlock protective stop until 5s after"
        )
        begin_s = time.monotonic()
        dashboard.wait_for("unlock protective stop", "Protective stop releasing")
        assert time.monotonic() - begin_s > 0.3
        assert dashboard.ask("safetymode") == "Safetymode: NORMAL"


def test_an_emergency_stop_and_a_fault_need_a_person() -> None:
    with running() as (controller, dashboard):
        controller.command("emergency stop")
        dashboard.wait_for("safetymode", "Safetymode: ROBOT_EMERGENCY_STOP")
        dashboard.wait_for("robotmode", "Robotmode: POWER_OFF")
        controller.command("emergency release")
        assert dashboard.ask("safetymode") == "Safetymode: NORMAL"
        controller.command("safety fault")
        assert dashboard.ask("safetymode") == "Safetymode: FAULT"
        assert dashboard.ask("restart safety") == "Restarting safety"
        assert dashboard.ask("safetymode") == "Safetymode: NORMAL"


def test_local_control_answers_questions_only() -> None:
    with running("5.11", "UR5e") as (controller, dashboard):
        assert dashboard.ask("is in remote control") == "true"
        assert dashboard.ask("PolyscopeVersion").startswith("URSoftware 5.11.")
        assert dashboard.ask("get serial number").isdigit()
        controller.command("local")
        assert dashboard.ask("is in remote control") == "false"
        assert dashboard.ask("robotmode") == "Robotmode: RUNNING"
        assert dashboard.ask("power off").startswith("Command is not allowed due to safety reasons")
        upload(controller, SCRIPT)
        assert dashboard.ask("running") == "Program running: false"


def test_frames_are_cut_wherever_the_stream_is() -> None:
    stream = frame(Kind.START) + frame(Kind.SETUP_INPUTS, b"timestamp") + frame(Kind.DATA, b"\x01" * 300)
    for size in (1, 2, 7, len(stream)):
        reader, seen = FrameReader(), []
        for begin in range(0, len(stream), size):
            seen += list(reader.feed(stream[begin : begin + size]))
        assert seen == [(ord("S"), b""), (ord("I"), b"timestamp"), (ord("U"), b"\x01" * 300)]
    with pytest.raises(ValueError, match="shorter"):
        list(FrameReader().feed(b"\x00\x01U"))


def test_an_input_belongs_to_one_client() -> None:
    registers, first, second = Registers(), object(), object()
    names = ["input_int_register_0", "speed_slider_mask"]
    assert registers.claim(names, first) == ["INT32", "UINT32"]
    assert registers.claim(names[:1], first) == ["INT32"]
    assert registers.claim([*names, "nonsense"], second) == ["IN_USE", "IN_USE", "NOT_FOUND"]
    registers.release(first)
    assert registers.claim(names, second) == ["INT32", "UINT32"]


def test_a_client_gets_what_it_asks_for_as_often_as_it_asks() -> None:
    with ControllerProcess("UR5e", "5.11") as controller:
        with socket.create_connection((controller.address, RTDE_PORT), LIMIT_S) as connection:
            ask = struct.pack(">d", 50.0) + b"timestamp,actual_q"
            connection.sendall(
                frame(Kind.START) + frame(Kind.SETUP_OUTPUTS, struct.pack(">d", 50.0) + b"nonsense")
            )
            connection.sendall(frame(Kind.PROTOCOL_VERSION, b"\x00\x02") + frame(Kind.CONTROLLER_VERSION))
            connection.sendall(frame(Kind.SETUP_OUTPUTS, ask) + frame(Kind.START))
            reader, seen = FrameReader(), []
            while len(seen) < 16:
                seen += list(reader.feed(connection.recv(4096)))
        assert seen[:6] == [
            (Kind.START, b"\x00"),
            (Kind.SETUP_OUTPUTS, b"\x00NOT_FOUND"),
            (Kind.PROTOCOL_VERSION, b"\x01"),
            (Kind.CONTROLLER_VERSION, struct.pack(">4I", 5, 11, 0, 0)),
            (Kind.SETUP_OUTPUTS, b"\x01DOUBLE,VECTOR6D"),
            (Kind.START, b"\x01"),
        ]
        times = [struct.unpack(">d", payload[1:9])[0] for kind, payload in seen[6:] if kind == Kind.DATA]
        assert (times[-1] - times[0]) / (len(times) - 1) == pytest.approx(0.02, rel=0.3)
        with socket.create_connection((controller.address, RTDE_PORT), LIMIT_S) as connection:
            connection.sendall(b"\x00\x01U")
            assert connection.recv(10) == b"", "rubbish closes the connection, and that one only"
        assert json.loads(controller.command("state"))["counts"]["bad frame"] == 1
