"""What is confirmed before a real arm looks at the board: each route, but a calibration's rounds at once."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from app.operations.scan_run import ScanOperator
from hardware.scanning.moving import CONFIRMED
from hardware.scanning.route import ScanRoute

CONFIRMED_BEFORE = "The route belongs to those that were confirmed with the first one."


class RouteQuestions:
    """Asks an operator about routes before they are driven."""

    def __init__(self, operator: ScanOperator, robot: str) -> None:
        """`robot` is what people call the arm."""
        self._operator, self._robot = operator, robot
        self._purpose: str | None = None
        self._is_given = False

    @contextmanager
    def once(self, purpose: str) -> Iterator[None]:
        """Within it only the first route is asked about.

        Args:
            purpose: the beginning of that question: what follows without another one.
        """
        self._purpose, self._is_given = purpose, False
        try:
            yield
        finally:
            self._purpose, self._is_given = None, False

    def __call__(self, route: ScanRoute) -> str:
        """Ask; return how the route was confirmed.

        Raises:
            Cancelled: the arm shall not move.
        """
        if self._is_given:
            return CONFIRMED_BEFORE
        self._operator.confirm_route(replace(route, purpose=self._purpose or ""), self._robot)
        self._is_given = self._purpose is not None
        return CONFIRMED
