"""The cell that the program works with: the simulated one, unless somebody chose a file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QSettings, Signal

from app.gui.desk.background import Background
from core.errors import PoursightError

if TYPE_CHECKING:
    from hardware.cell.settings import CellSettings

_KEY = "cell/file"


def _read(path: Path | None) -> CellSettings:
    from hardware.cell import SIMULATED_CELL, read_cell

    return read_cell(path or SIMULATED_CELL)


class CellChoice(QObject):
    """Reads the cell's file in the background and remembers which one it was.

    Signals: `changed` when there is another cell; `failed` with a sentence when a file cannot be used, in
    which case the cell stays what it was.

    Attributes:
        path: of the file; none for the simulated cell that the program ships.
        settings: what it says; none until it is read.
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
        """Whether nothing real moves; true until the file is read, for the program ships a simulated cell."""
        return self.settings is None or self.settings.robot.kind != "ur5"

    def restore(self) -> None:
        """Take the cell of the last time."""
        remembered = str(QSettings().value(_KEY, ""))
        self.choose(Path(remembered) if remembered else None)

    def choose(self, path: Path | None, then: Callable[[], None] | None = None) -> None:
        """Read a cell's file and take it, then go on; none: the simulated cell."""

        def take(settings: CellSettings) -> None:
            self.path, self.settings = path, settings
            QSettings().setValue(_KEY, "" if path is None else str(path))
            self.changed.emit()
            if then is not None:
                then()

        def refuse(error: PoursightError) -> None:
            self.failed.emit(str(error))
            if self.settings is None and path is not None:  # at the start there must be one
                self.choose(None)

        self._background.run("cell", lambda: _read(path), take, refuse)
