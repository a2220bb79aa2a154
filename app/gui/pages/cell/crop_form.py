"""The corners of the crop box, typed."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QFormLayout, QWidget

from app.gui.pages.cell.number_box import number_box
from app.gui.pages.layouts import row_of
from app.gui.theme import GRID_PX

MM = 1000.0
_REACH_MM = 2000.0
Point = tuple[float, float, float]


class CropForm(QWidget):
    """Two corners, in the arm's base frame.

    Signals: `edited` with lower and upper corner (3,) in metres, when somebody typed another value.
    """

    edited = Signal(object, object)

    def __init__(self) -> None:
        super().__init__()
        self._low, self._high = (
            [number_box(f"crop_{end}_{axis}", -_REACH_MM, _REACH_MM) for axis in "xyz"]
            for end in ("low", "high")
        )
        form = QFormLayout(self)
        form.setContentsMargins(0, 0, 0, 0)
        form.setSpacing(GRID_PX)
        for title, boxes in (
            (self.tr("Crop box from, mm"), self._low),
            (self.tr("to: x, y, z"), self._high),
        ):
            for box in boxes:
                box.setAccessibleName(title)
                box.setToolTip(
                    self.tr("What is outside is no part of the object; drag its sides in the view")
                )
                box.setKeyboardTracking(False)
                box.valueChanged.connect(self._emit)
            form.addRow(title, row_of(*boxes))

    def show_box(self, low_m: Point, high_m: Point) -> None:
        """Show another box."""
        for box, value_m in zip([*self._low, *self._high], [*low_m, *high_m], strict=True):
            with QSignalBlocker(box):
                box.setValue(value_m * MM)

    def _emit(self) -> None:
        low, high = (tuple(box.value() / MM for box in boxes) for boxes in (self._low, self._high))
        self.edited.emit(low, high)
