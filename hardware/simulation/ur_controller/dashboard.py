"""The dashboard server: lines of text with the real one's answers.

Source of the wording: Universal Robots, "Dashboard Server CB-Series" and "Dashboard Server e-Series".
"""

from __future__ import annotations

from collections.abc import Callable

from hardware.simulation.ur_controller.controller import Controller, RuntimeState
from hardware.simulation.ur_controller.line_link import LineLink
from hardware.simulation.ur_controller.link import Network

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
        return f"{self._program_word()} <unnamed>"

    def _program_word(self) -> str:
        return _PROGRAM_STATES.get(self._controller.runtime_state, "STOPPED")


def _done(action: Callable[[], object], answer: str) -> str:
    action()
    return answer
