"""A scan or a mesh that comes from a file, by a button or dropped onto the page."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QObject

from app.gui.desk.desk import Desk
from app.gui.pages.scan.dropping import Dropped
from app.gui.pages.scan.work import ScanJobs


class Imports(QObject):
    """Takes over what somebody chose; into a new session, unless the open one is empty."""

    def __init__(self, desk: Desk, work: ScanJobs, is_empty: Callable[[], bool]) -> None:
        """`is_empty` tells whether the open session may take it."""
        super().__init__(work)
        self._desk = desk
        self._work = work
        self._is_empty = is_empty

    def take_dropped(self, thing: Dropped) -> None:
        """Import what was dropped onto the page, or say why not."""
        if thing.folder is not None:
            self.take_folder(thing.folder)
        elif thing.mesh is not None:
            self.take_mesh(thing.mesh)
        else:
            self._desk.told.emit(thing.sentence)

    def take_folder(self, folder: str | Path) -> None:
        """Take over views that were taken elsewhere."""
        if self._has_room(Path(folder).name):
            self._work.import_scan(Path(folder))

    def take_mesh(self, path: str | Path) -> None:
        """Take over a mesh."""
        if self._has_room(Path(path).stem):
            self._work.import_mesh(Path(path))

    def _has_room(self, name: str) -> bool:
        if not self._desk.jobs.is_idle:
            self._desk.told.emit(self.tr("Wait until the running job has ended, or cancel it, then import."))
            return False
        return self._is_empty() or self._desk.new_session(name)
