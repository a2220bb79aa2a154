"""A host process as tests use it: they wait for what it sends, and no test leaves it busy for the next."""

from __future__ import annotations

import queue
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from app.jobs.host import Host
from app.jobs.messages import Event, Failed, Finished, Message
from app.jobs.service import Service
from tests.patience import HANG_S


class ListenedHost:
    """A host, and everything it sent since the last `clear`.

    Attributes:
        host: the host.
        messages: as they came.
    """

    def __init__(self, kind: type[Service], name: str) -> None:
        self._incoming: queue.Queue[Message] = queue.Queue()
        self.messages: list[Message] = []
        self.host = Host(kind, name, self._incoming.put)

    @property
    def events(self) -> list[Any]:
        """Payloads of the events."""
        return [message.payload for message in self.messages if isinstance(message, Event)]

    def of(self, kind: type[Any]) -> list[Any]:
        """Event of one kind."""
        return [event for event in self.events if isinstance(event, kind)]

    def do(
        self, method: Callable[..., Any], *arguments: Any, until: Callable[[Any], Any] | None = None
    ) -> Any:
        """Carry out a job; return its result or `Failed`, or the event that `until` waits for."""
        self.host.start(method, *arguments)
        return self.wait(until)

    def wait(self, until: Callable[[Any], Any] | None = None) -> Any:
        """Wait for an event that `until` accepts, or for the end of the job: its result or `Failed`."""
        while True:
            message = self.next()
            if isinstance(message, Finished):
                return message.result
            if isinstance(message, Failed):
                return message
            if isinstance(message, Event) and until is not None and until(message.payload):
                return message.payload

    def wait_for(self, kind: type[Any]) -> Any:
        """Wait for the next event of one kind."""
        return self.wait(lambda event: isinstance(event, kind))

    def end(self) -> Finished | Failed:
        """Wait for the message that ends the job."""
        while not isinstance(message := self.next(), Finished | Failed):
            pass
        return message

    def next(self) -> Message:
        """Wait for the next message."""
        message = self._incoming.get(timeout=HANG_S)
        self.messages.append(message)
        return message

    def clear(self) -> None:
        """Forget what came so far."""
        with suppress(queue.Empty):
            while True:
                self._incoming.get_nowait()
        self.messages.clear()

    def free(self) -> None:
        """End the job that a failed test has left."""
        if self.host.is_busy:
            self.host.kill()
            self.end()
        self.clear()
