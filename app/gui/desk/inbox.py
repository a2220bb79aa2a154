"""What the hosts' threads bring for the window, without letting it drown."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from PySide6.QtCore import QObject, Qt, Signal

from app.jobs.host import Host
from app.jobs.messages import Message, News, Progressed, Status

_Letter = tuple[Host[Any], Message]


class Inbox(QObject):
    """Hands messages on in the window's thread, in their order.

    A busy window would otherwise work off every state the arm ever had before it looks at a click; a state
    or a progress that was not looked at yet gives way to a newer one of its kind.
    """

    _arrived = Signal()

    def __init__(self, hand_on: Callable[[Host[Any], Message], None], parent: QObject) -> None:
        super().__init__(parent)
        self._hand_on = hand_on
        self._lock = threading.Lock()
        self._letters: list[_Letter] = []
        self._arrived.connect(self._work_off, Qt.ConnectionType.QueuedConnection)

    def put(self, host: Host[Any], message: Message) -> None:
        """Take a message; safe from any thread."""
        with self._lock:
            is_first = not self._letters
            kind = _kind(message)
            if kind is not None:
                self._letters = [
                    letter
                    for letter in self._letters
                    if letter[0] is not host or _kind(letter[1]) is not kind
                ]
            self._letters.append((host, message))
        if is_first:
            self._arrived.emit()

    def _work_off(self) -> None:
        with self._lock:
            letters, self._letters = self._letters, []
        for host, message in letters:
            self._hand_on(host, message)


def _kind(message: Message) -> type[object] | None:
    """Of messages of which only the newest counts; none for all others."""
    if isinstance(message, Progressed):
        return Progressed
    if isinstance(message, News) and isinstance(message.payload, Status):
        return type(message.payload)
    return None
