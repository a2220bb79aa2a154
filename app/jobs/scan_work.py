"""Scans, for a host process: one host scans, another pours, and the window talks to both."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Event
from typing import TYPE_CHECKING

from app.jobs.arm_news import StopDone
from app.jobs.face import JobFace
from app.jobs.messages import News
from app.jobs.scan_news import Proposal
from app.jobs.service import Service
from app.jobs.session_work import SessionTask, working_on
from app.scanning import ScanWatch, ScanWishes, scan_object
from core.errors import Cancelled, PoursightError
from core.session import Session
from core.workers import WorkerPool

if TYPE_CHECKING:
    from hardware.cell import Cell, CellSettings
    from hardware.interfaces import Robot
    from hardware.scanning.control import ScanControl

_CLOSING_S = 1.5


@dataclass
class _Running:
    """The scan under way.

    Attributes:
        face: of its job.
        control: pauses it.
        robot: of its cell, while that is open.
    """

    face: JobFace
    control: ScanControl
    robot: Robot | None = None


class ScanWork(Service):
    """Takes the views of an object."""

    GIVES_WAY = False

    def __init__(self, tell: Callable[[News], None]) -> None:
        super().__init__(tell)
        self._pool = WorkerPool()  # a scan needs none, but the pipeline holds one; no process is started
        self._running: _Running | None = None
        self._is_idle = Event()
        self._is_idle.set()
        self._was_stopped = False

    def prepare(self) -> None:
        """Import what a scan needs."""
        from core.pipeline import pipeline  # noqa: F401
        from hardware.scanning import looking_again  # noqa: F401
        from hardware.simulation import objects, placing  # noqa: F401

    def close(self) -> None:
        """Stop the arm."""
        self.stop()
        self._is_idle.wait(_CLOSING_S)
        self._pool.close()

    def scan(
        self, face: JobFace, task: SessionTask, cell: CellSettings, source: str | None, wishes: ScanWishes
    ) -> None:
        """Scan, or continue, or take views again; tells what `scan_news` and `arm_news` hold.

        Args:
            face: of the job.
            task: the session and its parameters.
            cell: to scan in.
            source: for a simulated cell, a built-in object's name or a mesh file.
            wishes: what to do beyond the scan itself.

        Raises:
            PoursightError: the sentence says what is in the way; every view that was taken is kept.
        """
        from app.jobs.scan_telling import ScanTelling

        telling = ScanTelling(face.tell, cell)
        with self._under_way(face) as running:

            @contextmanager
            def opened(cell: Cell) -> Iterator[None]:
                running.robot = cell.robot
                try:
                    with telling.arm(cell):
                        face.raise_if_cancelled()  # by a stop that came before there was an arm
                        yield
                finally:
                    running.robot = None

            watch = ScanWatch(running.control, opened, telling.planned, telling.taken)
            with working_on(task, self._pool, face) as pipeline:
                scan_object(pipeline, cell, source, wishes, watch)

    def propose(self, face: JobFace, task: SessionTask, cell: CellSettings) -> Proposal:
        """Say how many further views would show how much of the inside that the scan did not.

        Raises:
            PoursightError: there is no scan, or it cannot be read.
        """
        from app.jobs.scan_proposing import propose_views

        face.progress("looking again", 0, 1)
        return propose_views(Session.open(task.folder).folder("scan"), cell)

    def get_ready(self) -> None:
        """Whoever starts a scan knows of all stops so far; to be ordered before it is started."""
        self._was_stopped = False

    def pause(self) -> None:
        """Let the arm stand after the view it is at."""
        if (running := self._running) is not None:
            running.control.pause()

    def resume(self) -> None:
        """Go on."""
        if (running := self._running) is not None:
            running.control.resume()

    def stop(self) -> None:
        """Stop the arm, at once, and end the scan; one that was asked for but has not begun never will."""
        began_s, said = time.monotonic(), ""
        self._was_stopped = True
        if (running := self._running) is None:
            return
        running.face.cancel()  # first, for it takes no time, and the scan must not call the stop a fault
        if (robot := running.robot) is None:
            return
        try:
            robot.stop()
        except PoursightError as error:
            said = str(error)
        self._tell(News(StopDone(time.monotonic() - began_s, said)))

    @contextmanager
    def _under_way(self, face: JobFace) -> Iterator[_Running]:
        from hardware.scanning.control import ScanControl

        self._is_idle.clear()
        self._running = running = _Running(face, ScanControl())
        try:
            if self._was_stopped:
                raise Cancelled("STOP was pressed before the scan began; start it again if the arm may move.")
            yield running
        except PoursightError:
            face.raise_if_cancelled()  # a stopped arm complains: what counts is that somebody wanted it
            raise
        finally:
            self._running = None
            self._was_stopped = False
            self._is_idle.set()
