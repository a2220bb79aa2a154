"""One scan from its plan to its last view, taken up again after a stop of a real arm."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from app.operations.arm import ArmOperator, recover
from core.errors import Cancelled
from hardware.errors import RobotError

if TYPE_CHECKING:
    from core.progress import Reporter
    from hardware.cell import Cell
    from hardware.pouring.run_log import RunLog
    from hardware.scanning.control import ScanControl
    from hardware.scanning.moving import WatchedMoving
    from hardware.scanning.procedure import ScanProcedure, ViewsPlanned, ViewTaken
    from hardware.scanning.route import ScanRoute
    from hardware.scanning.store import ScanStore
    from hardware.scanning.views import ScanPlan

FIRST_LOOK = "first look"
_INTO_OPENINGS = "Into openings whose inside was not seen: "


@dataclass(frozen=True)
class ScanRequest:
    """What to do beyond the scan itself.

    Attributes:
        adaptive: take more views where the inside of an opening was not seen.
        retake: names of views of the finished scan to take again.
        restart: discard what an interrupted scan left.
        cell_file: of the cell, beside which a look may be stored that is taken again first.
    """

    adaptive: bool = False
    retake: tuple[str, ...] = ()
    restart: bool = False
    cell_file: Path | None = None


@dataclass(frozen=True)
class ScanObserver:
    """How somebody follows a scan while it is made.

    Attributes:
        control: pauses it.
        opened: called with the cell; what it returns is entered while the cell's devices are connected.
        planned: called with what `ScanProcedure` plans.
        taken: called with each view.
    """

    control: ScanControl
    opened: Callable[[Cell], AbstractContextManager[object]]
    planned: ViewsPlanned
    taken: ViewTaken


class ScanOperator(ArmOperator, Protocol):
    """The person at a real arm that scans."""

    def confirm_route(self, route: ScanRoute, robot: str) -> None:
        """Whether a robot shall go through the views as planned."""
        ...


@dataclass(frozen=True)
class Watch:
    """Who watches a real arm, and where its motions are written down."""

    operator: ScanOperator
    log: RunLog


class ScanRun:
    """Plans a scan, which may take a first look, and takes its views."""

    def __init__(
        self,
        cell: Cell,
        store: ScanStore,
        reporter: Reporter,
        observer: ScanObserver | None = None,
        watch: Watch | None = None,
    ) -> None:
        """`cell` is entered; without a `watch` only an arm that is not real moves."""
        self._cell = cell
        self._store = store
        self._reporter = reporter
        self._observer = observer
        self._watch = watch
        self._moving: WatchedMoving | None = None
        self._scanning: tuple[Cell, ScanProcedure] | None = None
        self._purpose = ""

    def take(self, request: ScanRequest) -> None:
        """Take everything; after a stop make the arm ready, plan from where it is, and ask.

        Raises:
            PoursightError: the sentence says what is in the way; no view that was taken is lost.
        """
        if self._watch is None:
            self._take_once(request)
            return
        from hardware.pouring.recovering import LoggedRecovery

        operator, log = self._watch.operator, self._watch.log
        while True:
            try:
                self._take_once(request)
                log.event("done", "All views were taken.")
                return
            except (RobotError, Cancelled) as error:
                if not operator.is_present or self._moving is None or not self._moving.was_stopped:
                    raise
                recover(LoggedRecovery(self._cell.robot, log), self._cell.robot, operator, error)

    def _take_once(self, request: ScanRequest) -> None:
        from hardware.scanning.next_best_views import look_inside, take_next_best_views
        from hardware.scanning.views import name_views

        plan = self._plan()
        cell, procedure = self._scanning = self._scanning or self._begin(plan)
        self._purpose = ""
        procedure.take(name_views(plan.views_rad))
        procedure.retake(request.retake)
        self._purpose = _INTO_OPENINGS
        if request.adaptive:
            take_next_best_views(cell, procedure, self._reporter)
        elif not (request.retake or cell.settings.robot.kind == "replay"):
            look_inside(cell, procedure, self._reporter, len(plan.views_rad))
        procedure.scan()  # refuses what is too little for a scan

    def _plan(self) -> ScanPlan:
        """The plan of the scan that is continued, or a new one."""
        from hardware.scanning.planning import fixed_plan, plan_scan

        plan = self._store.plan
        if plan is None and self._store.has_begun:  # before there were plans
            plan = fixed_plan(self._cell)
        if plan is None:
            control = None if self._observer is None else self._observer.control
            self._reporter.progress(FIRST_LOOK, 0, 1)
            plan = plan_scan(self._cell, self._reporter, control, self._move_to_look)
        self._store.plan = plan
        return plan

    def _begin(self, plan: ScanPlan) -> tuple[Cell, ScanProcedure]:
        from hardware.scanning.planning import cell_for_plan
        from hardware.scanning.procedure import ScanProcedure

        cell, observer = cell_for_plan(self._cell, plan), self._observer
        control, taken, planned = (
            (None, None, None) if observer is None else (observer.control, observer.taken, observer.planned)
        )
        moving = self._move(cell)
        return cell, ScanProcedure(cell, self._store, self._reporter, control, taken, planned, moving)

    def _move_to_look(self, cell: Cell) -> WatchedMoving | None:
        return self._move(cell, "A first look, for the object's box: ")

    def _move(self, cell: Cell, purpose: str = "") -> WatchedMoving | None:
        """How a real arm moves in a cell; none: as one that is not real."""
        from hardware.scanning.moving import CONFIRMED, WatchedMoving

        if self._watch is None:
            return None
        operator, robot = self._watch.operator, cell.robot.name

        def confirm(route: ScanRoute) -> str:
            operator.confirm_route(replace(route, purpose=purpose or self._purpose), robot)
            return CONFIRMED

        self._moving = WatchedMoving(cell, self._watch.log, self._reporter, confirm)
        return self._moving
