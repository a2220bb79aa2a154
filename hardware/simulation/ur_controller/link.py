"""Connections of clients, and what can go wrong with them: silence, delay, loss, refusal."""

from __future__ import annotations

import asyncio
import random
from collections import deque
from collections.abc import Callable
from itertools import count
from typing import cast

from hardware.simulation.ur_controller.journal import Journal

_MAX_WAITING_BYTES = 1 << 20
"""A client that does not read loses what comes beyond this, so that memory stays bounded."""


class Network:
    """The state of the cable between the controller and its clients.

    Attributes:
        latency_s: added to everything, in each direction.
        jitter_s: the largest random addition to that; the order of bytes stays.
    """

    def __init__(self) -> None:
        """Begin without a fault."""
        self.latency_s = 0.0
        self.jitter_s = 0.0
        self._is_silent = False
        self._links: set[Link] = set()
        self._random = random.Random(0)

    @property
    def is_silent(self) -> bool:
        """Whether nothing passes although connections stay open."""
        return self._is_silent

    @property
    def links(self) -> list[Link]:
        """The open connections."""
        return list(self._links)

    def delay_s(self) -> float:
        """Return how long the next bytes take."""
        return self.latency_s + self.jitter_s * self._random.random()

    def add(self, link: Link) -> None:
        """Count a connection in."""
        self._links.add(link)

    def remove(self, link: Link) -> None:
        """Forget a connection that is closed."""
        self._links.discard(link)

    def drop(self, name: str = "", number: int | None = None) -> None:
        """Close every connection at once; or those of a name, or the nth of these, as they came, from 1."""
        links = sorted((link for link in self.links if name in ("", link.name)), key=lambda link: link.number)
        for link in links if number is None else links[number - 1 : number]:
            link.abort()

    def silence(self, is_silent: bool) -> None:
        """Let nothing pass, or let it pass again; what waited meanwhile arrives then, as with TCP."""
        self._is_silent = is_silent
        for link in self.links:
            link.hold(is_silent)


class Link(asyncio.Protocol):
    """One connection of a client; subclasses say what is received and answered.

    Attributes:
        name: of the server.
        number: rises from connection to connection.
    """

    name = ""
    _numbers = count()

    def __init__(self, network: Network, journal: Journal) -> None:
        """Wait for the connection to be made."""
        self.number = next(self._numbers)
        self._network = network
        self._journal = journal
        self._transport: asyncio.Transport | None = None
        self._held: list[bytes] = []
        self._directions = {"in": _Direction(), "out": _Direction()}
        self._waiting_bytes = 0

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Called by asyncio."""
        self._transport = cast(asyncio.Transport, transport)
        self._network.add(self)
        self._journal.note(f"connection {self.name}")
        self.hold(self._network.is_silent)
        self.opened()

    def connection_lost(self, exc: Exception | None) -> None:
        """Called by asyncio."""
        del exc
        self._transport = None
        self._held.clear()
        self._network.remove(self)
        self._journal.note(f"end of connection {self.name}")
        self.closed()

    def data_received(self, data: bytes) -> None:
        """Called by asyncio."""
        self._later("in", lambda: self._take(data))

    def send(self, data: bytes) -> None:
        """Send something, subject to the network's faults; dropped where the client does not read."""
        if self._transport is None or self._backlog() > _MAX_WAITING_BYTES:
            return
        if self._network.is_silent:
            self._held.append(data)
            self._waiting_bytes += len(data)
            return
        self._later("out", lambda: self._write(data))

    def hold(self, is_silent: bool) -> None:
        """Stop or go on reading and writing."""
        if self._transport is None:
            return
        if is_silent:
            self._transport.pause_reading()
            return
        self._transport.resume_reading()
        for data in self._held:
            self._write(data)
        self._held.clear()
        self._waiting_bytes = 0

    def abort(self) -> None:
        """Close the connection without a message."""
        if self._transport is not None:
            self._transport.abort()

    def finish(self) -> None:
        """Close the connection after what was sent."""
        if self._transport is not None:
            self._transport.close()

    def opened(self) -> None:
        """What to do when a client has connected."""

    def closed(self) -> None:
        """What to do when it has gone."""

    def received(self, data: bytes) -> None:
        """What to do with the client's bytes."""
        raise NotImplementedError

    def _take(self, data: bytes) -> None:
        if self._transport is not None:
            self.received(data)

    def _write(self, data: bytes) -> None:
        if self._transport is not None and not self._transport.is_closing():
            self._transport.write(data)

    def _backlog(self) -> int:
        assert self._transport is not None
        return self._transport.get_write_buffer_size() + self._waiting_bytes

    def _later(self, direction: str, action: Callable[[], None]) -> None:
        """Do it after the network's delay, never before what was to be done earlier."""
        self._directions[direction].do(action, self._network.delay_s())


class _Direction:
    """One direction of a connection: what is in flight, in its order."""

    def __init__(self) -> None:
        self._actions: deque[Callable[[], None]] = deque()
        self._due_s = 0.0

    def do(self, action: Callable[[], None], delay_s: float) -> None:
        if delay_s <= 0 and not self._actions:
            action()
            return
        loop = asyncio.get_running_loop()
        self._due_s = max(self._due_s, loop.time() + delay_s)
        self._actions.append(action)
        # Timers of one moment come in any order, so each does whatever is first by now.
        loop.call_at(self._due_s, lambda: self._actions.popleft()())


_MAX_LINE_BYTES = 1 << 16


class LineLink(Link):
    """One client that sends lines; subclasses say what each means."""

    _rest = b""

    def received(self, data: bytes) -> None:
        """Cut into lines."""
        *lines, self._rest = (self._rest + data).split(b"\n")
        for line in lines:
            self.line_received(line.decode("utf-8", errors="replace").strip())
        if len(self._rest) > _MAX_LINE_BYTES:
            self.abort()

    def line_received(self, line: str) -> None:
        """What to do with a line, without its end."""
        raise NotImplementedError

    def send_line(self, line: str) -> None:
        """Send a line of text."""
        self.send(line.encode() + b"\n")
