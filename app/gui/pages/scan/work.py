"""What the Scan page starts, and what follows when it is done."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from app.gui.desk.desk import Desk
from app.gui.desk.jobs import RunningJob
from app.gui.pages.scan.loading import FRAMES
from app.jobs.scan_events import ViewDone
from app.jobs.scan_work import ScanWork
from app.jobs.session_work import ScanChecked, SessionWork
from app.library.places import new_session_folder
from app.library.session_folder import UNFINISHED_SCAN, remove_if_empty
from app.operations.scan_run import ScanRequest
from app.operations.session import SessionTask
from core.parameters import Parameters

HIDDEN_AREA_M2 = 2e-4
"""Less than this of the inside is not worth further views; the scan's verdict uses the same limit."""
_PATIENCE_REAL_S = 4.0
"""A real arm comes to rest before its process may be ended."""


class ScanJobs(QObject):
    """Scans, imports and checks, each followed by what makes sense next.

    Attributes:
        proposed: the `Proposal` of further views.
    """

    proposed = Signal(object)

    def __init__(self, desk: Desk, page: str, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._desk = desk
        self._page = page
        self._scan: RunningJob | None = None
        self._folder: Path | None = None
        self._new: Path | None = None
        desk.jobs.failed.connect(self._clear_up)
        desk.jobs.event_received.connect(self._hear)

    @property
    def is_scanning(self) -> bool:
        """Whether the arm is taking views for the open session now."""
        running = self._desk.jobs.running
        return running is not None and running is self._scan and self._is_open

    @property
    def frames_in_progress(self) -> Path | None:
        """Where the images of the running scan are; none if there is no such scan."""
        return (
            self._folder / UNFINISHED_SCAN / FRAMES if self._folder is not None and self.is_scanning else None
        )

    def scan(self, source: str | None, request: ScanRequest) -> None:
        """Scan, then check what was taken; cell and session must be there."""
        desk = self._desk
        cell = desk.cell.settings
        assert cell is not None, "the button is disabled before the cell is read"
        if not desk.jobs.is_idle:
            return
        request = replace(request, cell_file=desk.cell.path)
        desk.scan_host.order(ScanWork.get_ready)
        desk.session_host.order(SessionWork.compute_ahead, desk.workspace.task())
        self._start(
            self.tr("Scan"),
            ScanWork.scan,
            cell,
            source,
            request,
            then=self._check_scan,
            patience_s=1.0 if desk.cell.is_simulated else _PATIENCE_REAL_S,
        )
        self._scan = desk.jobs.running
        if self._scan is not None:
            self._scan.start_again = partial(self._scan_again, source, request)

    def check(self, *, is_new: bool = False) -> None:
        """Reconstruct and check the scan, and find further views if something was hidden.

        Of a scan that `is_new`, was just taken, and is good, the desk hears: its object can be imagined.
        """
        self._start(
            self.tr("Check the scan"),
            SessionWork.reconstruct,
            then=partial(self._go_on, is_new),
            done=self.tr("Scan checked."),
            steps=self._desk.workspace.steps_to("collision", "quality", "colors"),
        )

    def propose(self) -> None:
        """Find views that show what is hidden."""
        cell = self._desk.cell.settings
        if cell is not None:
            self._start(self.tr("Find further views"), ScanWork.propose, cell, then=self.proposed.emit)

    def import_path(self, path: Path, *, into_open: bool) -> None:
        """Take over a folder of views, which the import checks, or a mesh.

        Args:
            path: of the folder or mesh.
            into_open: whether the open session takes it; else a new one, which is opened once it holds it:
                an import that fails leaves none.
        """
        is_scan = path.is_dir()
        title = self.tr("Import the scan") if is_scan else self.tr("Import the mesh")
        method: Callable[..., None] = SessionWork.import_scan if is_scan else SessionWork.import_mesh
        if into_open:
            self._start(title, method, path)
            return
        desk, name = self._desk, path.name if path.is_dir() else path.stem
        folder = self._folder = self._new = new_session_folder(name)
        task = SessionTask(folder, Parameters(), "default")

        def open_it(_: object) -> None:
            if desk.open_session(folder):
                desk.rename_session(name)

        desk.jobs.start(title, self._page, desk.session_host, method, task, path, then=open_it)

    def _hear(self, news: object) -> None:
        """What comes after the last view need not read those before it."""
        if isinstance(news, ViewDone) and self.is_scanning:
            self._desk.session_host.order(SessionWork.read_ahead)

    def _clear_up(self, *_: object) -> None:
        """The session of an import that failed holds nothing."""
        folder, self._new = self._new, None
        if folder is not None:
            self._desk.background.run("scan.clear up", partial(remove_if_empty, folder), lambda _: None)

    def pause(self) -> None:
        """Stop the arm after the current view."""
        self._desk.jobs.pause(ScanWork.pause)

    def resume(self) -> None:
        """Go on."""
        self._desk.jobs.resume(ScanWork.resume)

    @property
    def _is_open(self) -> bool:
        """Whether the session that was worked on is still the open one."""
        return self._folder is not None and self._folder == self._desk.workspace.folder

    def _start(
        self,
        title: str,
        method: Callable[..., object],
        *arguments: object,
        then: Callable[[object], None] | None = None,
        patience_s: float = 1.0,
        done: str = "",
        steps: Sequence[str] = (),
    ) -> None:
        desk = self._desk
        host = desk.scan_host if method in (ScanWork.scan, ScanWork.propose) else desk.session_host
        task = desk.workspace.task()
        self._folder = task.folder
        desk.jobs.start(
            title,
            self._page,
            host,
            method,
            task,
            *arguments,
            then=then,
            patience_s=patience_s,
            done=done,
            steps=steps,
        )

    def _scan_again(self, source: str | None, request: ScanRequest) -> None:
        """After a failure: what was taken since the scan began is used."""
        has_views = self._folder is not None and (self._folder / UNFINISHED_SCAN).exists()
        self.scan(source, replace(request, restart=request.restart and not has_views))

    def _check_scan(self, _result: object) -> None:
        if self._is_open:
            self.check(is_new=True)

    def _go_on(self, is_new: bool, checked: ScanChecked | None) -> None:
        if checked is None or not self._is_open:
            return
        if checked.hidden_area_m2 > HIDDEN_AREA_M2:
            self.propose()
        elif is_new and checked.verdict == "good":
            self._desk.good_scan_taken.emit()
