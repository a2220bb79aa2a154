"""The ports that take text: the dashboard, the script port, and the control socket of tests and people.

Source of the dashboard's wording: Universal Robots, "Dashboard Server CB-Series" and
"Dashboard Server e-Series".
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from hardware.simulation.ur_controller.controller import Controller, RuntimeState
from hardware.simulation.ur_controller.faults import FaultInjector, FaultRefused
from hardware.simulation.ur_controller.journal import Journal
from hardware.simulation.ur_controller.link import LineLink, Link, Network

_GREETING = "Connected: Universal Robots Dashboard Server"
_TOO_EARLY = (
    "Cannot unlock protective stop until 5s after occurrence. Always inspect cause of protective stop before "
    "unlocking"
)
_LOCAL = (
    "Command is not allowed due to safety reasons, please switch robot to Remote Control mode and reconnect "
    "to port 29999"
)
_PROGRAM_STATES = {
    RuntimeState.PLAYING: "PLAYING",
    RuntimeState.RESUMING: "PLAYING",
    RuntimeState.PAUSING: "PAUSED",
    RuntimeState.PAUSED: "PAUSED",
}
_SERIAL_NUMBER = "20000000001"


class DashboardLink(LineLink):
    """One client of the dashboard."""

    name = "dashboard"

    def __init__(self, network: Network, controller: Controller) -> None:
        """Wait for the connection."""
        super().__init__(network, controller.journal)
        self._controller = controller
        self._actions: dict[str, Callable[[], str]] = {
            "power on": lambda: _done(controller.power_on, "Powering on"),
            "power off": lambda: _done(controller.power_off, "Powering off"),
            "brake release": lambda: _done(controller.release_brakes, "Brake releasing"),
            "unlock protective stop": self._unlock,
            "restart safety": lambda: _done(controller.restart_safety, "Restarting safety"),
            "close safety popup": lambda: "closing safety popup",
            "play": lambda: "Starting program" if controller.play() else "Failed to execute: play",
            "pause": lambda: "Pausing program" if controller.pause() else "Failed to execute: pause",
            # Also where nothing runs: ur_rtde relies on it after it has ended its script itself.
            "stop": lambda: _done(controller.stop, "Stopped"),
            "shutdown": lambda: _done(controller.power_off, "Shutting down"),
        }
        self._questions: dict[str, Callable[[], str]] = {
            "robotmode": lambda: f"Robotmode: {controller.robot_mode.name}",
            "safetymode": lambda: f"Safetymode: {controller.safety_mode.name}",
            "safetystatus": lambda: f"Safetystatus: {controller.safety_mode.name}",
            "running": self._running,
            "programstate": self._program_state,
            "get loaded program": lambda: "No program loaded",
            "isprogramsaved": lambda: "false",
            "polyscopeversion": lambda: controller.identity.version_text,
            "version": lambda: ".".join(map(str, controller.identity.version)),
            "get robot model": lambda: controller.identity.model.name.upper().rstrip("E"),
            "close popup": lambda: "closing popup",
            "get operational mode": lambda: "NONE",
        }
        if controller.identity.knows_remote_control:
            self._questions["is in remote control"] = lambda: str(controller.is_remote).lower()
            self._questions["get serial number"] = lambda: _SERIAL_NUMBER

    def opened(self) -> None:
        """Greet."""
        self.send_line(_GREETING)

    def line_received(self, line: str) -> None:
        """Do what the line says and answer."""
        self._journal.note("dashboard", line=line)
        if line.lower() == "quit":
            self.send_line("Disconnected")
            self.finish()
            return
        if self._controller.dashboard_delay_s:
            delay_s = self._controller.dashboard_delay_s
            asyncio.get_running_loop().call_later(delay_s, lambda: self.send_line(self._answer(line)))
        else:
            self.send_line(self._answer(line))

    def _answer(self, line: str) -> str:
        command = line.lower()
        if command in self._questions:
            return self._questions[command]()
        if command.startswith("popup "):
            return "showing popup"
        if command.startswith("addtolog "):
            return "Added log message"
        is_load = command.startswith("load ")
        if (command in self._actions or is_load) and not self._controller.is_remote:
            return _LOCAL
        if is_load:
            return f"File not found: {line[5:]}"
        if command in self._actions:
            return self._actions[command]()
        return f"could not understand: '{line}'"

    def _unlock(self) -> str:
        return "Protective stop releasing" if self._controller.unlock_protective_stop() else _TOO_EARLY

    def _running(self) -> str:
        return f"Program running: {str(self._program_word() == 'PLAYING').lower()}"

    def _program_state(self) -> str:
        return f"{self._program_word()} {self._controller.program_name}"

    def _program_word(self) -> str:
        return _PROGRAM_STATES.get(self._controller.runtime_state, "STOPPED")


def _done(action: Callable[[], object], answer: str) -> str:
    action()
    return answer


_MAX_BYTES = 1 << 20


class ScriptLink(Link):
    """One client that sends scripts."""

    name = "script"

    def __init__(self, network: Network, controller: Controller) -> None:
        """Wait for text."""
        super().__init__(network, controller.journal)
        self._controller = controller
        self._text = ""

    def received(self, data: bytes) -> None:
        """Collect text and hand on each program that is complete."""
        self._text += data.decode("utf-8", errors="replace")
        while (program := self._take_program()) is not None:
            if program.strip():
                self._controller.upload(program)
        if len(self._text) > _MAX_BYTES:
            self._journal.note("endless script", size=len(self._text))
            self._text = ""

    def _take_program(self) -> str | None:
        """A `def ... end` whose `end` stands at the line's start, or a single line."""
        text = self._text.lstrip("\n")
        last_line = "\nend\n" if text.startswith(("def ", "sec ")) else "\n"
        program, found, rest = text.partition(last_line)
        if not found:
            return None
        self._text = rest
        return program + found


REFUSED = "error: "


class ControlLink(LineLink):
    """One line in, one line out."""

    name = "control"

    def __init__(self, injector: FaultInjector, journal: Journal) -> None:
        """Wait for lines; the connection has a network of its own, without faults."""
        super().__init__(Network(), journal)
        self._injector = injector

    def line_received(self, line: str) -> None:
        """Do it and answer."""
        try:
            self.send_line(self._injector.take(line))
        except FaultRefused as error:
            self.send_line(REFUSED + str(error))
