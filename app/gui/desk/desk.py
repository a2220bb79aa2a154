"""Everything the pages share, made once and handed to each."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, QTimer, Signal

from app.gui.desk.arm_link import ArmLink
from app.gui.desk.background import Background
from app.gui.desk.cell import CellChoice
from app.gui.desk.jobs import Jobs
from app.gui.desk.workspace import Workspace
from app.jobs.arm_work import ArmWork
from app.jobs.host import Host
from app.jobs.scan_work import ScanWork
from app.jobs.session_work import SessionWork
from app.library.places import new_session_folder
from core.errors import PoursightError

_APART_MS = 1500


class Desk(QObject):
    """The session, the jobs and the cell.

    Signals: `page_wanted` with the key of a page that somebody asked for; `told` with a sentence for the
    message bar.

    Attributes:
        workspace: the open session and its parameters.
        jobs: the running job.
        background: for short work in a thread.
        cell: the cell that is worked with.
        arm: the link to the arm, with STOP.
        session_host: the process that reconstructs and imagines.
        scan_host: the process that scans.
        arm_host: the process that pours.
    """

    page_wanted = Signal(str)
    told = Signal(str)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._is_closed = False
        self.workspace = Workspace(self)
        self.background = Background(self)
        self.cell = CellChoice(self.background, self)
        self.jobs = Jobs(self)
        self.session_host = self.jobs.make_host(SessionWork, "imagines")
        self.scan_host = self.jobs.make_host(ScanWork, "scans")
        self.arm_host = self.jobs.make_host(ArmWork, "moves the arm", is_repeatable=False)
        self._hosts: tuple[Host[Any], ...] = (self.session_host, self.scan_host, self.arm_host)
        self.arm = ArmLink(self.arm_host, self.scan_host, self)
        self.jobs.news.connect(self.arm.hear)
        self.jobs.finished.connect(lambda *_: self.workspace.refresh())
        self.jobs.failed.connect(lambda *_: self.workspace.refresh())
        self.cell.failed.connect(self.told)
        self.background.told.connect(self.told)

    def new_session(self, name: str) -> bool:
        """Open a new session in the usual place, called after today and `name`; False if that cannot be."""
        return self.open_session(new_session_folder(name))

    def open_session(self, folder: Path) -> bool:
        """Open a session, or start one in an empty folder; what is in the way is told and changes nothing."""
        if not self.jobs.is_idle:
            self.told.emit(
                self.tr("Work is under way; cancel it, or let it end, before you change the session.")
            )
            return False
        try:
            self.workspace.open(folder)
        except PoursightError as error:
            self.told.emit(str(error))
            return False
        return True

    def prepare(self) -> None:
        """Start the processes, so that the first jobs need not wait for them."""
        for number, host in enumerate(self._hosts):
            # One after the other, for each imports for a second or two.
            QTimer.singleShot(_APART_MS * number, self, partial(self._open, host))

    def _open(self, host: Host[Any]) -> None:
        if not self._is_closed:
            host.open()

    def close(self) -> None:
        """End all work; nothing is left behind."""
        self._is_closed = True
        self.arm.close()
        self.jobs.close()
        self.background.forget()
