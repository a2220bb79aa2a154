"""The crop box in numbers."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QDoubleSpinBox, QHBoxLayout, QLabel, QPushButton, QWidget

from app.gui.theme import GRID_PX
from app.gui.views.painting import tabular
from core.parameters.reconstruction import Point

MM = 1000.0
_MOST_MM = 10_000.0
_AXES = "xyz"


class CropBar(QWidget):
    """Lower and upper corner in millimetres, and the way back to the scan's own box.

    Signals: `edited` with lower and upper corner in metres (tuples of three); `reset_wanted`.
    """

    edited = Signal(object, object)
    reset_wanted = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("crop_bar")
        self._low = [self._number(axis, "min", self.tr("Lower end along {axis}")) for axis in _AXES]
        self._high = [self._number(axis, "max", self.tr("Upper end along {axis}")) for axis in _AXES]
        self._reset = QPushButton(self.tr("Reset"))
        self._reset.setObjectName("crop_reset")
        self._reset.setToolTip(self.tr("Back to the scan's own box"))
        self._reset.clicked.connect(self.reset_wanted)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(GRID_PX // 2)
        for axis, low, high in zip(_AXES, self._low, self._high, strict=True):
            row.addWidget(QLabel(axis))
            row.addWidget(low)
            row.addWidget(QLabel(self.tr("to")))
            row.addWidget(high)
            row.addSpacing(GRID_PX)
        row.addWidget(QLabel(self.tr("mm")))
        row.addStretch(1)
        row.addWidget(self._reset)

    def set_box(self, low_m: Point, high_m: Point, is_own: bool) -> None:
        """Show a box; `is_own` tells that it is the scan's own."""
        for box, value_m in zip([*self._low, *self._high], [*low_m, *high_m], strict=True):
            with QSignalBlocker(box):
                box.setValue(value_m * MM)
        self._reset.setEnabled(not is_own)

    def _number(self, axis: str, end: str, tip: str) -> QDoubleSpinBox:
        box = QDoubleSpinBox()
        box.setObjectName(f"crop_{end}_{axis}")
        box.setAccessibleName(tip.format(axis=axis))
        box.setToolTip(self.tr("{tip}, in mm in the robot's base frame").format(tip=tip.format(axis=axis)))
        box.setRange(-_MOST_MM, _MOST_MM)
        box.setDecimals(0)
        box.setSingleStep(5)
        box.setKeyboardTracking(False)
        box.setButtonSymbols(QDoubleSpinBox.ButtonSymbols.NoButtons)
        box.setAlignment(Qt.AlignmentFlag.AlignRight)
        box.setFont(tabular(self.font()))
        box.setMaximumWidth(8 * GRID_PX)
        box.valueChanged.connect(self._tell)
        return box

    def _tell(self) -> None:
        low, high = (tuple(box.value() / MM for box in boxes) for boxes in (self._low, self._high))
        self.edited.emit(low, high)
