"""What the check is told for a touch: where the tip is that was put onto a corner of the board."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QFormLayout, QPushButton, QWidget

from app.gui.pages.cell.number_box import number_box
from app.gui.pages.layouts import row_of
from app.gui.theme import GRID_PX

MM = 1000.0
_REACH_MM = 500.0


class TouchForm(QWidget):
    """The tip's place is the last one until somebody changes it.

    Signals: `read_wanted` when the tip is on a corner.
    """

    read_wanted = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._shown: tuple[float, ...] = ()
        self._tip = [number_box(f"tip_{axis}", -_REACH_MM, _REACH_MM) for axis in "xyz"]
        self.read = QPushButton(self.tr("Read a touched corner"))
        self.read.setObjectName("read_touch")
        self.read.setToolTip(
            self.tr("The hand was guided until its tip is on a corner of the checked board; nothing moves")
        )
        self.read.clicked.connect(self.read_wanted)
        form = QFormLayout(self)
        form.setContentsMargins(0, 0, 0, 0)
        form.setSpacing(GRID_PX)
        title = self.tr("Tip from the flange, mm")
        for box in self._tip:
            box.setAccessibleName(title)
        form.addRow(title, row_of(*self._tip))
        form.addRow("", row_of(self.read))

    def show_tip(self, tip_m: tuple[float, ...], can_read: bool) -> None:
        """Show another tip (3,); what was typed stays as long as it is the same."""
        self.read.setEnabled(can_read)
        if tip_m == self._shown:
            return
        self._shown = tip_m
        for box, value_m in zip(self._tip, tip_m, strict=True):
            with QSignalBlocker(box):
                box.setValue(value_m * MM)

    @property
    def tip_m(self) -> tuple[float, ...]:
        """The tip (3,) in the flange frame."""
        return tuple(box.value() / MM for box in self._tip)
