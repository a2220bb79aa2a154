"""Whether a Robotiq gripper still holds what it took, watched in the process that drives the arm."""

from __future__ import annotations

import time
from threading import Event, Thread

from hardware.errors import GripperError, ObjectLost, RobotError
from hardware.grippers.robotiq_line import Contact, RobotiqAddress, RobotiqLine

_PAUSE_S = 0.004
_SEEN_EMPTY = 2
"""Readings in a row: fingers that grasp once more are between for a moment."""
_SILENT_S = 0.25
_AGAIN_S = 0.1
"""Between two tries to connect."""


class HeldObject:
    """Asks for the contact of the fingers, again and again, as fast as the gripper answers.

    It has a connection of its own, so that no command of the program delays it. What is watched has been seen
    to be held once: fingers that hold nothing have nothing to lose.
    """

    def __init__(self, address: RobotiqAddress) -> None:
        """Begin to watch if `watch` says so."""
        self._address = address
        self._is_watched = Event()
        self._was_held = False
        self._n_empty = 0
        self._problem: RobotError | None = None
        Thread(target=self._ask, name="held object", daemon=True).start()

    def watch(self, is_held: bool) -> None:
        """Watch from now on, or no more; what was lost before is forgotten."""
        self._was_held, self._n_empty, self._problem = False, 0, None
        if is_held:
            self._is_watched.set()
        else:
            self._is_watched.clear()

    def problem(self) -> RobotError | None:
        """What is wrong with the grip; none if nothing is, or nothing is watched."""
        return self._problem if self._is_watched.is_set() else None

    def _ask(self) -> None:
        while True:
            self._is_watched.wait()
            try:
                with RobotiqLine(self._address, _SILENT_S) as line:
                    while self._is_watched.is_set():
                        self._take(line.get("OBJ"))
                        time.sleep(_PAUSE_S)
            except GripperError as error:
                if self._is_watched.is_set():
                    self._problem = error
                time.sleep(_AGAIN_S)

    def _take(self, contact: int) -> None:
        if contact == Contact.WHILE_CLOSING:
            self._was_held, self._n_empty = True, 0
            return
        self._n_empty += 1
        if self._was_held and self._n_empty >= _SEEN_EMPTY and self._is_watched.is_set():
            self._problem = ObjectLost(
                f"The Robotiq gripper at {self._address} holds nothing any more, so the arm was stopped; see "
                "to the cup and what it lost, then recover the robot."
            )
