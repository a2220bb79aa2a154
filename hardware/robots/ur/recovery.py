"""Bringing a controller back to where it takes a program, through its dashboard."""

from __future__ import annotations

import time
from collections.abc import Callable

from hardware.errors import EmergencyStop, ProtectiveStop, RobotNotReady
from hardware.modes import RobotMode, SafetyMode
from hardware.robots.ur.dashboard import Dashboard

_UNLOCK_WITHIN_S = 8.0
"""The controller unlocks a protective stop 5 s after it, so that somebody looks first."""
_SWITCH_WITHIN_S = 30.0
_POLL_S = 0.1


def make_ready(dashboard: Dashboard, name: str) -> None:
    """End the program, unlock a protective stop, switch on power and release the brakes.

    The program is ended first: a paused one would go on with its old move once it is played again.

    Raises:
        RobotError: a person has to do something first; the sentence says what.
    """
    dashboard.ask("stop")
    dashboard.ask("close popup")
    dashboard.ask("close safety popup")
    _refuse_emergency(_safety(dashboard), name)
    if _safety(dashboard) is SafetyMode.PROTECTIVE_STOP:
        _unlock(dashboard, name)
    if not _safety(dashboard).may_move:
        raise RobotNotReady(
            f"The safety system of the {name} is in '{_safety(dashboard).words}'; put that right at its "
            "panel, then recover the robot again."
        )
    if _mode(dashboard) is not RobotMode.RUNNING:
        _switch_on(dashboard, name)


def _refuse_emergency(safety: SafetyMode, name: str) -> None:
    if safety.is_emergency:
        raise EmergencyStop(
            f"The emergency stop of the {name} is pressed; see that all is safe, release it, then recover "
            "the robot again."
        )


def _unlock(dashboard: Dashboard, name: str) -> None:
    def is_unlocked() -> bool:
        dashboard.ask("unlock protective stop")
        return _safety(dashboard) is not SafetyMode.PROTECTIVE_STOP

    if not _comes_true(is_unlocked, _UNLOCK_WITHIN_S):
        raise ProtectiveStop(
            f"The protective stop of the {name} does not unlock; see what the arm touches and unlock it at "
            "the panel, then recover the robot again."
        )


def _switch_on(dashboard: Dashboard, name: str) -> None:
    dashboard.ask("power on")
    has_power = _comes_true(lambda: _mode(dashboard) in (RobotMode.IDLE, RobotMode.RUNNING), _SWITCH_WITHIN_S)
    dashboard.ask("brake release")
    if not has_power or not _comes_true(lambda: _mode(dashboard) is RobotMode.RUNNING, _SWITCH_WITHIN_S):
        raise RobotNotReady(
            f"The {name} does not switch on: it stays in '{_mode(dashboard).words}'; switch it on at its "
            "panel, then recover the robot again."
        )


def _safety(dashboard: Dashboard) -> SafetyMode:
    said = dashboard.ask("safetymode").partition(":")[2].strip()
    return SafetyMode.__members__.get(said, SafetyMode.UNDEFINED)


def _mode(dashboard: Dashboard) -> RobotMode:
    said = dashboard.ask("robotmode").partition(":")[2].strip()
    return RobotMode.__members__.get(said, RobotMode.NO_CONTROLLER)


def _comes_true(is_so: Callable[[], bool], within_s: float) -> bool:
    deadline_s = time.monotonic() + within_s
    while not is_so():
        if time.monotonic() > deadline_s:
            return False
        time.sleep(_POLL_S)
    return True
