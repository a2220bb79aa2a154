"""The controller as a process of its own: `python -m hardware.simulation.ur_controller '{...}'`.

It ends when its standard input ends or its parent is gone; see `process.ControllerProcess`.
"""

from __future__ import annotations

import asyncio
import json
import os
import signal
import sys
import threading
import time

from core.errors import PoursightError
from hardware.realtime import take_precedence
from hardware.simulation.ur_controller.identity import identity
from hardware.simulation.ur_controller.server import ControllerServer, Wish

_LOOK_S = 0.5


def _end_with_parent() -> None:
    """End this process when the pipe from the parent closes, or when another process has adopted it."""
    parent = os.getppid()

    def read() -> None:
        sys.stdin.buffer.read()
        os._exit(0)

    def look() -> None:
        while os.getppid() == parent:
            time.sleep(_LOOK_S)
        os._exit(0)

    for watch in (read, look):
        threading.Thread(target=watch, daemon=True).start()


def main() -> int:
    """Serve what the first argument wishes, as JSON; print the address, or why not."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C in a terminal is the parent's to answer
    take_precedence()  # a controller is a computer of its own: what else runs here must not slow it down
    _end_with_parent()
    wish = json.loads(sys.argv[1])
    try:
        server = ControllerServer(
            Wish(
                identity(wish["model"], wish["version"]),
                wish["address"],
                tuple(wish["joints_rad"]),
                wish["speed_up"],
                tuple(wish["faults"]),
            )
        )
        asyncio.run(server.run(lambda address: print(f"listens {address}", flush=True)))
    except PoursightError as error:
        print(f"error {error}", flush=True)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
