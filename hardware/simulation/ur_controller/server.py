"""The controller on its sockets, and the clock that drives it."""

from __future__ import annotations

import asyncio
import random
from collections.abc import Callable
from contextlib import suppress
from ipaddress import ip_address

from core.errors import InputError
from hardware.grippers.robotiq_line import ROBOTIQ_PORT
from hardware.simulation.ur_controller.controller import Controller
from hardware.simulation.ur_controller.faults import FaultInjector, FaultRefused
from hardware.simulation.ur_controller.identity import (
    CONTROL_PORT,
    DASHBOARD_PORT,
    PRIMARY_PORT,
    RTDE_PORT,
    SCRIPT_PORT,
)
from hardware.simulation.ur_controller.link import Network
from hardware.simulation.ur_controller.primary_server import PrimaryLink
from hardware.simulation.ur_controller.robotiq import RobotiqHand, RobotiqLink
from hardware.simulation.ur_controller.rtde_server import Outputs, RtdeLink
from hardware.simulation.ur_controller.settings import ControllerSettings
from hardware.simulation.ur_controller.text_servers import ControlLink, DashboardLink, ScriptLink

_ADDRESS_TRIES = 50
_UNWATCHED_CYCLES = 4
"""Of a standing arm of which nobody wants states: other clients are answered as they come."""
_LATE_S = 0.02
_STOOD_STILL_S = 0.1
"""Beyond this much wall time the machine itself stood still: that is left out, for the watchdog, too."""


class ControllerServer:
    """A controller with its servers, in an asyncio loop."""

    def __init__(self, settings: ControllerSettings) -> None:
        """Prepare; nothing listens yet."""
        self._settings = settings
        self._controller = Controller(settings.identity, settings.joints_rad, settings.measured)
        self._controller.speed_up = settings.speed_up
        if settings.robotiq is not None:
            self._controller.hand = RobotiqHand(settings.robotiq)
        self._outputs = Outputs(self._controller)
        self._network = Network()
        self._injector = FaultInjector(self._controller, self._network, self._refuse)
        self._servers: list[asyncio.Server] = []
        self._tasks: set[asyncio.Task[None]] = set()
        self._address = ""

    async def run(self, listens: Callable[[str], None]) -> None:
        """Serve until cancelled; report the address once everything listens.

        Raises:
            InputError: the address cannot be used, or a fault line is not one.
        """
        control = await self._listen_somewhere()
        try:
            for line in self._settings.faults:
                self._injector.take(line)
            listens(self._address)
            await self._cycle()
        except FaultRefused as error:
            raise InputError(f"The fault cannot be set up: {error}.") from error
        finally:
            control.close()
            for server in self._servers:
                server.close()
            self._network.drop()

    async def _listen_somewhere(self) -> asyncio.Server:
        wanted = self._settings.address
        if wanted and not _is_loopback(wanted):
            raise InputError(
                f"A simulated controller listens on loopback only; choose 127.x.y.z, not {wanted}."
            )
        pick = random.SystemRandom()
        for _ in range(1 if wanted else _ADDRESS_TRIES):
            self._address = wanted or ".".join(["127", *(str(pick.randint(1, 254)) for _ in range(3))])
            try:
                control = await self._server(
                    lambda: ControlLink(self._injector, self._controller.journal), CONTROL_PORT
                )
            except OSError:
                continue
            try:
                await self._open()
            except OSError:
                control.close()
                continue
            return control
        raise InputError(
            f"Nothing can listen at {wanted or 'any loopback address'} on ports {DASHBOARD_PORT}, "
            f"{PRIMARY_PORT}, {SCRIPT_PORT}, {RTDE_PORT} and {CONTROL_PORT}; end what listens there, or "
            "choose another 127.x.y.z."
        )

    async def _open(self) -> None:
        makers: list[tuple[Callable[[], asyncio.Protocol], int]] = [
            (lambda: DashboardLink(self._network, self._controller), DASHBOARD_PORT),
            (lambda: PrimaryLink(self._network, self._controller), PRIMARY_PORT),
            (lambda: ScriptLink(self._network, self._controller), SCRIPT_PORT),
            (lambda: RtdeLink(self._network, self._controller), RTDE_PORT),
        ]
        hand = self._controller.hand
        if hand is not None:
            makers.append((lambda: RobotiqLink(self._network, hand, self._controller.journal), ROBOTIQ_PORT))
        try:
            for make, port in makers:
                self._servers.append(await self._server(make, port))
        except OSError:
            self._close()
            raise

    async def _server(self, make: Callable[[], asyncio.Protocol], port: int) -> asyncio.Server:
        return await asyncio.get_running_loop().create_server(make, self._address, port, reuse_address=True)

    def _close(self) -> None:
        for server in self._servers:
            server.close()
        self._servers.clear()

    def _refuse(self, is_refused: bool) -> None:
        if is_refused:
            self._close()
        elif not self._servers:
            task = asyncio.get_running_loop().create_task(self._open())
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)

    async def _cycle(self) -> None:
        """Step the controller by the wall clock, several cycles at once where a wake-up is late."""
        loop = asyncio.get_running_loop()
        begin_s, done, speed_up = loop.time(), 0, 0.0
        while True:
            if speed_up != self._controller.speed_up:
                begin_s, done, speed_up = loop.time(), 0, self._controller.speed_up
                period_s = self._controller.dt_s / speed_up
            due = int((loop.time() - begin_s) / period_s) - done
            if due * period_s > _STOOD_STILL_S:
                begin_s += due * period_s
                self._controller.registers.leave_out(due * period_s)
                continue
            if due * period_s > _LATE_S:  # what came meanwhile is read first: the watchdog must not be wrong
                await asyncio.sleep(0)
            for _ in range(due):
                self._controller.step()
                self._injector.poll()
            if due > 0:
                done += due
                self._send_state(due)
            await asyncio.sleep(max(begin_s + (done + self._cycles_ahead()) * period_s - loop.time(), 0))

    def _cycles_ahead(self) -> int:
        """How many cycles from now on there is something to do: for a standing arm the next state to send."""
        if not self._controller.arm.is_idle:
            return 1
        return min((link.cycles_to_next for link in self._served()), default=_UNWATCHED_CYCLES)

    def _send_state(self, cycles: int) -> None:
        links = [link for link in self._served() if link.is_due(cycles)]
        if not links:
            return
        values = self._outputs.refresh({name for link in links for name in link.wanted})
        for link in links:
            link.send_state(values)

    def _served(self) -> list[RtdeLink]:
        return [link for link in self._network.links if isinstance(link, RtdeLink) and link.wanted]


def _is_loopback(address: str) -> bool:
    with suppress(ValueError):
        return ip_address(address).is_loopback
    return False
