"""A dashboard server that notes when it was told to stop, in a thread of its own."""

from __future__ import annotations

import queue
import socket
import threading
import time
from contextlib import suppress

from hardware.robots.ur.probe import DASHBOARD_PORT, UR_GREETING


class Dashboard:
    """Answers as a controller does.

    Attributes:
        address: of the loopback, its own.
        stops_s: `time.monotonic()` of each stop that arrived.
    """

    def __init__(self, address: str) -> None:
        self.address = address
        self.stops_s: queue.Queue[float] = queue.Queue()
        self._server = socket.create_server((address, DASHBOARD_PORT))
        threading.Thread(target=self._serve, daemon=True).start()

    def close(self) -> None:
        """Accept nobody any more; a thread that waits for somebody would keep the port."""
        self._server.shutdown(socket.SHUT_RDWR)
        self._server.close()

    def _serve(self) -> None:
        with suppress(OSError):
            while True:
                line, _ = self._server.accept()
                threading.Thread(target=self._talk, args=(line,), daemon=True).start()

    def _talk(self, line: socket.socket) -> None:
        with suppress(OSError), line:
            line.sendall(f"Connected: {UR_GREETING}\n".encode())
            while received := line.recv(64):
                arrived_s = time.monotonic()
                for _ in range(received.count(b"stop\n")):
                    self.stops_s.put(arrived_s)
                    line.sendall(b"Stopped\n")
