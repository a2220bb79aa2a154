"""`poursight ur-controller`: the simulated UR controller, to try a cell without an arm."""

from __future__ import annotations

import asyncio
import signal
from collections.abc import Coroutine, Sequence
from contextlib import suppress
from typing import Any

from hardware.simulation.ur_controller.addresses import CONTROL_PORT
from hardware.simulation.ur_controller.identity import identity
from hardware.simulation.ur_controller.server import ControllerServer, Wish


def serve_controller(address: str, model: str, version: str, speed_up: float, faults: Sequence[str]) -> None:
    """Serve until Ctrl-C or SIGTERM; one line tells that it listens.

    Raises:
        InputError: an unknown model, version or fault, or the address is taken.
    """
    wish = Wish(identity(model, version), address, speed_up=speed_up, faults=faults)

    def listens(at: str) -> None:
        print(
            f"Simulated {model} with PolyScope {version} listens at {at}; faults and questions: port "
            f"{CONTROL_PORT}. Ctrl-C ends it.",
            flush=True,
        )

    asyncio.run(_until_stopped(ControllerServer(wish).run(listens)))


async def _until_stopped(serving: Coroutine[Any, Any, None]) -> None:
    """Run until it ends or a signal asks for the end."""
    task = asyncio.ensure_future(serving)
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, task.cancel)
    with suppress(asyncio.CancelledError):
        await task
