"""Faults and questions, as lines of text: at once, after a time, or when the arm moves.

| line | what happens |
|---|---|
| `protective stop` | the arm stops and holds; the program is paused |
| `emergency stop`, `emergency release` | the button is pressed: no power, no program; it is released |
| `safety fault` | only `restart safety` at the dashboard ends it |
| `program stop`, `program pause`, `program play` | as at the panel |
| `power off`, `local`, `remote` | the arm's power; who controls it |
| `ignore uploads`, `heed uploads` | scripts come and nothing happens |
| `take registers`, `release registers` | another client has every input |
| `stick JOINT...`, `unstick` | joints (1 to 6) do not follow; they do again |
| `program hangs` | it runs on but takes no further command |
| `foreign still`, `foreign moving` | another program takes over without a gap; it stands, or turns the base |
| `foreign gap still`, `foreign gap moving` | the same after a moment in which no program runs |
| `pace FACTOR` | the controller's clock runs so many times faster than the wall's |
| `freeze`, `thaw` | the whole controller stands still, silent; it goes on |
| `reduced`, `normal` | the safety system's mode |
| `dual pin power`, `single pin power` | what the tool's connector is set to |
| `output lost`, `ignore outputs`, `heed outputs` | the tool's outputs go off; writes do nothing; do again |
| `slider SHARE`, `model NAME` | the speed slider; another arm's kinematics |
| `calibration MM` | the forearm is longer by this than the published one, as the primary interface tells |
| `jump JOINT RAD` | a joint (1 to 6) is elsewhere at once |
| `limit JOINT LOW HIGH`, `no limits` | the safety system's, in rad; as the arm's own |
| `fastest JOINT SPEED` | the safety system's, in rad/s; `no limits` as well |
| `plane X Y Z M` | the safety system's: the tool comes no farther than M metres along (X, Y, Z); the same |
| `force N` | something pushes at the tool |
| `dashboard delay SECONDS` | the dashboard hears every line so late |
| `hand empty`, `hand full` | nothing (any more) between a Robotiq gripper's fingers; something |
| `hand silent`, `hand senseless`, `hand sane` | it answers nothing; something else; as it should |
| `hand off`, `hand fault NUMBER` | it is not activated any more; what it reports |
| `link drop [SECONDS]` | every connection is closed; new ones are refused that long |
| `drop dashboard`, `drop script`, `drop robotiq` | these connections are closed |
| `drop rtde [NUMBER]` | these, or the nth of them |
| `link silent [SECONDS]` | everything stays open, nothing passes; for ever without a time |
| `latency MS [JITTER_MS]` | on everything, in each direction |
| `refuse [SECONDS]` | new connections are refused |
| `link restore` | the link is as it was |
| `kill` | the process ends at once |
| `in SECONDS LINE`, `when moving LINE` | the line later; both may be combined |
| `state`, `log [N]` | what the controller knows; the newest N entries of its journal; as JSON |
"""

from __future__ import annotations

import asyncio
import json
import os
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from hardware.simulation.ur_controller.controller import Controller
from hardware.simulation.ur_controller.identity import MODELS
from hardware.simulation.ur_controller.link import Network
from hardware.simulation.ur_controller.robotiq import OBJECT_M, RobotiqHand

_KILLED = 9
_NEWEST = 200
_OTHER_CLIENT = object()
_SIGNED = ("calibration", "jump", "limit", "plane")


class FaultRefused(Exception):
    """The line is no command; the text says why."""


class FaultInjector:
    """Takes one line, does it, and returns one line.

    Times are in seconds of the wall clock: links are.
    """

    def __init__(self, controller: Controller, network: Network, refuse: Callable[[bool], None]) -> None:
        """Serve a controller; `refuse` closes the listening sockets or opens them again."""
        self._controller = controller
        self._network = network
        self._refuse = refuse
        self._when_moving: list[Callable[[], None]] = []
        c = controller
        self._plain: dict[str, Callable[[], None]] = {
            "protective stop": c.protective_stop,
            "emergency stop": c.emergency_stop,
            "emergency release": c.release_emergency_stop,
            "safety fault": c.safety_fault,
            "program stop": lambda: _must(c.stop(), "there is no program to stop"),
            "program pause": lambda: _must(c.pause(), "the program does not run"),
            "program play": lambda: _must(c.play(), "there is nothing to go on with"),
            "power off": c.power_off,
            "local": lambda: setattr(c, "is_remote", False),
            "remote": lambda: setattr(c, "is_remote", True),
            "ignore uploads": lambda: setattr(c, "ignores_uploads", True),
            "heed uploads": lambda: setattr(c, "ignores_uploads", False),
            "freeze": lambda: self._freeze(True),
            "thaw": lambda: self._freeze(False),
            "reduced": lambda: c.reduce(True),
            "normal": lambda: c.reduce(False),
            "dual pin power": lambda: setattr(c, "has_dual_pin_power", True),
            "single pin power": lambda: setattr(c, "has_dual_pin_power", False),
            "no limits": lambda: self._limit([]),
            "drop dashboard": lambda: network.drop("dashboard"),
            "drop script": lambda: network.drop("script"),
            "program hangs": c.hang_program,
            "foreign still": lambda: c.run_foreign(is_moving=False, has_gap=False),
            "foreign moving": lambda: c.run_foreign(is_moving=True, has_gap=False),
            "foreign gap still": lambda: c.run_foreign(is_moving=False, has_gap=True),
            "foreign gap moving": lambda: c.run_foreign(is_moving=True, has_gap=True),
            "output lost": c.lose_outputs,
            "ignore outputs": lambda: setattr(c, "ignores_outputs", True),
            "heed outputs": lambda: setattr(c, "ignores_outputs", False),
            "hand empty": lambda: setattr(self._hand, "object_m", None),
            "hand full": lambda: setattr(self._hand, "object_m", OBJECT_M),
            "hand silent": lambda: setattr(self._hand, "is_silent", True),
            "hand senseless": lambda: setattr(self._hand, "is_senseless", True),
            "hand sane": self._mend_hand,
            "hand off": lambda: self._hand.deactivate(),
            "drop robotiq": lambda: network.drop("robotiq"),
            "take registers": lambda: c.registers.take_all(_OTHER_CLIENT),
            "release registers": lambda: c.registers.release(_OTHER_CLIENT),
            "unstick": c.arm.stuck.clear,
            "link restore": self._restore,
            "kill": lambda: os._exit(_KILLED),
        }
        self._with_numbers: dict[str, Callable[[list[float]], None]] = {
            "link drop": self._drop,
            "link silent": self._silence,
            "refuse": self._refuse_for,
            "latency": self._delay,
            "stick": self._stick,
            "slider": self._slide,
            "calibration": self._miscalibrate,
            "jump": self._jump,
            "limit": self._limit,
            "fastest": self._limit_speed,
            "plane": self._bound,
            "force": lambda numbers: setattr(c, "tool_force_n", _one(numbers)),
            "hand fault": lambda numbers: setattr(self._hand, "fault", int(_one(numbers))),
            "pace": self._pace,
            "dashboard delay": lambda numbers: setattr(c, "dashboard_delay_s", _one(numbers)),
            "drop rtde": self._drop_rtde,
        }

    def take(self, line: str) -> str:
        """Do what the line says.

        Raises:
            FaultRefused: the line is no command.
        """
        words = line.split()
        if words[:1] == ["state"]:
            return json.dumps(self.state())
        if words[:1] == ["log"]:
            number = int(_numbers(words[1:])[0]) if words[1:] else _NEWEST
            return json.dumps(self._controller.journal.newest(number))
        self._find(words)()
        return "ok"

    def poll(self) -> None:
        """Called in every cycle: do what waits for a movement."""
        if self._when_moving and self._controller.arm.is_moving:
            due, self._when_moving = self._when_moving, []
            for action in due:
                self._do(action)

    def state(self) -> dict[str, Any]:
        """What the controller knows, for JSON."""
        c = self._controller
        return {
            "time_s": c.time_s,
            "model": c.arm.model.name,
            "version": ".".join(map(str, c.identity.version)),
            "joints_rad": c.arm.joints_rad.tolist(),
            "target_rad": c.arm.target_rad.tolist(),
            "speeds_rad_s": c.arm.speeds_rad_s.tolist(),
            "is_moving": c.arm.is_moving,
            "robot_mode": c.robot_mode.name,
            "safety_mode": c.safety_mode.name,
            "runtime_state": c.runtime_state.name,
            "is_remote": c.is_remote,
            "slider": c.arm.slider,
            "digital_outputs": c.digital_outputs,
            "tool_voltage_v": c.tool_voltage_v,
            "tool_outputs": [bool(c.digital_outputs >> 16 & 1), bool(c.digital_outputs >> 17 & 1)],
            "payload_kg": c.arm.payload_kg,
            "connections": sorted(link.name for link in self._network.links),
            "counts": dict(c.journal.counts),
        }

    @property
    def _hand(self) -> RobotiqHand:
        if self._controller.hand is None:
            raise FaultRefused("there is no Robotiq gripper here")
        return self._controller.hand

    def _mend_hand(self) -> None:
        self._hand.is_silent = self._hand.is_senseless = False
        self._hand.fault = 0

    def _find(self, words: list[str]) -> Callable[[], None]:
        """Return what a line means."""
        if words[:1] == ["in"] and len(words) > 2:
            delay_s, action = _numbers(words[1:2])[0], self._find(words[2:])
            return lambda: self._later(delay_s, action)
        if words[:2] == ["when", "moving"]:
            action = self._find(words[2:])
            return lambda: self._when_moving.append(action)
        line = " ".join(words)
        if line in self._plain:
            return self._plain[line]
        for name, numbered in self._with_numbers.items():
            if line == name or line.startswith(name + " "):
                numbers = _numbers(line[len(name) :].split(), is_signed=name in _SIGNED)
                return partial(numbered, numbers)
        if line.startswith("model ") and line[6:] in MODELS:
            return lambda: self._controller.set_model(MODELS[line[6:]])
        known = ", ".join([*self._plain, *self._with_numbers, "model", "state", "log"])
        raise FaultRefused(f"'{line}' is no command; known: {known}; before each: in SECONDS, when moving")

    def _later(self, delay_s: float, action: Callable[[], None]) -> None:
        asyncio.get_running_loop().call_later(delay_s, self._do, action)

    def _do(self, action: Callable[[], None]) -> None:
        """Nobody waits for the answer any more."""
        try:
            action()
        except FaultRefused as error:
            self._controller.journal.note("fault refused", message=str(error))

    def _drop(self, numbers: list[float]) -> None:
        self._network.drop()
        if numbers:
            self._refuse_for(numbers)

    def _silence(self, numbers: list[float]) -> None:
        self._network.silence(True)
        if numbers:
            self._later(numbers[0], lambda: self._network.silence(False))

    def _refuse_for(self, numbers: list[float]) -> None:
        self._refuse(True)
        if numbers:
            self._later(numbers[0], lambda: self._refuse(False))

    def _freeze(self, is_frozen: bool) -> None:
        self._controller.is_frozen = is_frozen
        self._network.silence(is_frozen)

    def _pace(self, numbers: list[float]) -> None:
        _must(1 <= _one(numbers) <= 20, "a factor from 1 to 20")
        self._controller.speed_up = numbers[0]

    def _drop_rtde(self, numbers: list[float]) -> None:
        self._network.drop("rtde", int(numbers[0]) if numbers else None)

    def _miscalibrate(self, numbers: list[float]) -> None:
        nominal = self._controller.identity.model
        first, upper_arm_m, forearm_m, *_ = nominal.a_m
        a_m = (first, upper_arm_m, forearm_m - _one(numbers) / 1000, 0.0, 0.0, 0.0)
        self._controller.set_model(replace(nominal, a_m=a_m))

    def _jump(self, numbers: list[float]) -> None:
        _must(len(numbers) == 2 and numbers[0] in range(1, 7), "a joint from 1 to 6, and an angle")
        self._controller.arm.jump(int(numbers[0]) - 1, numbers[1])

    def _limit(self, numbers: list[float]) -> None:
        """Without numbers: no limits but the arm's own."""
        arm = self._controller.arm
        if not numbers:
            arm.safe_rad = np.array([arm.model.lower_rad, arm.model.upper_rad])
            arm.safe_speeds_rad_s = np.array(arm.model.speed_limits_rad_s)
            arm.safe_planes = []
            return
        _must(len(numbers) == 3 and numbers[0] in range(1, 7), "a joint from 1 to 6, and two angles")
        arm.safe_rad[:, int(numbers[0]) - 1] = numbers[1:]

    def _bound(self, numbers: list[float]) -> None:
        _must(len(numbers) == 4 and any(numbers[:3]), "a normal, and how far along it, in metres")
        normal = np.array(numbers[:3])
        self._controller.arm.safe_planes.append((normal / np.linalg.norm(normal), numbers[3]))

    def _limit_speed(self, numbers: list[float]) -> None:
        _must(len(numbers) == 2 and numbers[0] in range(1, 7), "a joint from 1 to 6, and a speed")
        self._controller.arm.safe_speeds_rad_s[int(numbers[0]) - 1] = numbers[1]

    def _restore(self) -> None:
        self._network.latency_s = self._network.jitter_s = 0.0
        self._controller.dashboard_delay_s = 0.0
        self._freeze(False)
        self._refuse(False)

    def _delay(self, numbers: list[float]) -> None:
        latency_ms, jitter_ms = [*numbers, 0.0, 0.0][:2]
        self._network.latency_s, self._network.jitter_s = latency_ms / 1000, jitter_ms / 1000

    def _stick(self, numbers: list[float]) -> None:
        joints = {int(number) for number in numbers}
        _must(bool(joints) and joints <= set(range(1, 7)), "joints are numbered 1 to 6")
        self._controller.arm.stuck |= {joint - 1 for joint in joints}

    def _slide(self, numbers: list[float]) -> None:
        _must(len(numbers) == 1 and 0 <= numbers[0] <= 1, "the slider goes from 0 to 1")
        self._controller.arm.slider = numbers[0]


def _must(is_so: bool, sentence: str) -> None:
    if not is_so:
        raise FaultRefused(sentence)


def _one(numbers: list[float]) -> float:
    _must(len(numbers) == 1, "one number is wanted")
    return numbers[0]


def _numbers(words: list[str], is_signed: bool = False) -> list[float]:
    try:
        numbers = [float(word) for word in words]
    except ValueError as error:
        raise FaultRefused(f"'{' '.join(words)}' should be numbers") from error
    _must(is_signed or all(number >= 0 for number in numbers), "numbers must not be negative")
    return numbers
