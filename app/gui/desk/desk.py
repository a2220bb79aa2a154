"""Everything the pages share, made once and handed to each: session, jobs, arm and cell."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, QSettings, QTimer, Signal

from app.gui.desk.arm_link import ArmLink
from app.gui.desk.background import Background
from app.gui.desk.jobs import Jobs
from app.gui.desk.workspace import Workspace
from app.gui.remedies import worded
from app.jobs.arm_work import ArmWork
from app.jobs.cell_work import CellWork
from app.jobs.host import Host
from app.jobs.session_work import SessionWork
from app.library.places import new_session_folder
from app.library.session_folder import remember_parameters
from core.errors import PoursightError
from core.pipeline.news import StageDone

if TYPE_CHECKING:
    from hardware.cell.settings import CellSettings

_APART_MS = 1500
_CELL_KEY = "cell/file"


class Desk(QObject):
    """The session, the jobs and the cell.

    Signals: `page_wanted` with the key of a page to show; `message` with a sentence for the message bar;
    `new_session_wanted` and `report_wanted` when a page offers what the menus do; `good_scan_taken` when a
    scan has been taken and checked, and hides nothing.

    Attributes:
        workspace: the open session and its parameters.
        jobs: the running job.
        background: for short work in a thread.
        cell: the cell in use.
        arm: the link to the arm, with STOP.
        session_host: the process that reconstructs and imagines.
        scan_host: the process that scans, and sets the cell up.
        arm_host: the process that pours.
    """

    page_wanted = Signal(str)
    message = Signal(str)
    new_session_wanted = Signal()
    report_wanted = Signal()
    good_scan_taken = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._is_closed = False
        self.workspace = Workspace(self)
        self.background = Background(self)
        self.cell = CellChoice(self.background, self)
        self.jobs = Jobs(self)
        self.session_host = self.jobs.make_host(SessionWork, "imagines")
        self.scan_host = self.jobs.make_host(CellWork, "scans")
        self.arm_host = self.jobs.make_host(ArmWork, "moves the arm", is_repeatable=False)
        self._hosts: tuple[Host[Any], ...] = (self.session_host, self.scan_host, self.arm_host)
        self.arm = ArmLink(self.arm_host, self.scan_host, self)
        self.jobs.event_received.connect(self.arm.handle)
        self.jobs.event_received.connect(self._take_news)
        self.jobs.finished.connect(lambda *_: self.workspace.refresh())
        self.jobs.failed.connect(lambda *_: self.workspace.refresh())
        self.cell.changed.connect(self.arm.forget_place)
        self.cell.failed.connect(self.message)
        self.background.failed.connect(self.message)
        self.workspace.edited.connect(self._remember_parameters)

    def new_session(self, name: str) -> bool:
        """Open a new session in the usual place, called `name`; False if that cannot be."""
        if not self.open_session(new_session_folder(name)):
            return False
        self.rename_session(name)
        return True

    def rename_session(self, name: str) -> None:
        """Call the open session something else; if that fails, `message` has the reason."""
        try:
            self.workspace.rename(name)
        except PoursightError as error:
            self.message.emit(worded(error))

    def open_session(self, folder: Path) -> bool:
        """Open a session, or start one in an empty folder; if that fails, `message` has the reason."""
        if not self.jobs.is_idle:
            self.message.emit(
                self.tr("A job is running: cancel it or let it finish before you change the session.")
            )
            return False
        try:
            self.workspace.open(folder)
        except PoursightError as error:
            self.message.emit(worded(error))
            return False
        return True

    def prepare(self) -> None:
        """Start the processes, so that the first jobs need not wait for them."""
        for number, host in enumerate(self._hosts):
            # One after the other: each is busy importing for a second or two.
            QTimer.singleShot(_APART_MS * number, self, partial(self._open, host))

    def _take_news(self, news: object) -> None:
        """What a stage found is shown while the stages after it still run."""
        if isinstance(news, StageDone) and news.session == self.workspace.folder:
            self.workspace.refresh()

    def _remember_parameters(self) -> None:
        """Keep an edit even if nothing is run with it."""
        workspace = self.workspace
        if workspace.session is not None and self.jobs.is_idle:  # a job has remembered those it runs with
            store = partial(
                remember_parameters, workspace.session.path, workspace.preset_name, workspace.parameters
            )
            remember = partial(self.background.run, "remember parameters", store, lambda _: None)
            QTimer.singleShot(0, self, remember)

    def _open(self, host: Host[Any]) -> None:
        if not self._is_closed:
            host.open()

    def close(self) -> None:
        """End all jobs and processes."""
        self._is_closed = True
        self.arm.close()
        self.jobs.close()
        self.background.forget()


class CellChoice(QObject):
    """The cell the program works with: the simulated one, unless a file was chosen.

    It is read in the background, and the choice is remembered.

    Signals: `changed` when there is another cell; `failed` with a sentence when a file cannot be used, in
    which case the cell stays what it was.

    Attributes:
        path: of the file; none for the simulated cell that the program ships.
        settings: its contents; none until it is read.
    """

    changed = Signal()
    failed = Signal(str)

    def __init__(self, background: Background, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.path: Path | None = None
        self.settings: CellSettings | None = None
        self._background = background

    @property
    def is_simulated(self) -> bool:
        """Whether no real arm moves; true until the file is read, for the program ships a simulated cell."""
        return self.settings is None or not self.settings.robot.is_real

    def restore(self) -> None:
        """Use the cell of the last time."""
        remembered = str(QSettings().value(_CELL_KEY, ""))
        self.choose(Path(remembered) if remembered else None)

    def choose(self, path: Path | None, then: Callable[[], None] | None = None) -> None:
        """Read a cell's file and use it, then call `then`; none: the simulated cell."""

        def take(settings: CellSettings) -> None:
            self.path, self.settings = path, settings
            QSettings().setValue(_CELL_KEY, "" if path is None else str(path))
            self.changed.emit()
            if then is not None:
                then()

        def refuse(error: PoursightError) -> None:
            self.failed.emit(worded(error))
            if self.settings is None and path is not None:  # at the start there must be one
                self.choose(None)

        self._background.run("cell", partial(_read_cell, path), take, refuse)


def _read_cell(path: Path | None) -> CellSettings:
    from hardware.cell import SIMULATED_CELL, read_cell

    return read_cell(path or SIMULATED_CELL)
