"""Where the parts of a parameter's row lie."""

from __future__ import annotations

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QFont, QFontMetricsF

from app.gui.theme import GRID_PX
from app.gui.views.painting import smaller
from app.gui.views.parameter_editor.model import RowFacts

_PAD_PX = 12.0
"""Above and below the text of the first line, together."""


class RowLayout:
    """The parts of one cell: first line, second line (preset's value and Reset; or automatic), refusal."""

    def __init__(self, facts: RowFacts, cell: QRectF, font: QFont, reset_text: str) -> None:
        self._facts = facts
        self._cell = cell
        self._small = QFontMetricsF(smaller(font))
        self._line_px = QFontMetricsF(font).height() + _PAD_PX
        self._reset_px = self._small.horizontalAdvance(reset_text) + 2

    @property
    def first_line(self) -> QRectF:
        """The name, or around the value."""
        return QRectF(self._cell.left(), self._cell.top(), self._cell.width() - 4, self._line_px)

    @property
    def value(self) -> QRectF:
        """The value's box."""
        return self.first_line.adjusted(1.5, 2.5, 0.5, -2.5)

    @property
    def _second_line(self) -> QRectF:
        top = self._cell.top() + self._line_px - 2
        return QRectF(self._cell.left(), top, self._cell.width() - 4, self._small.height())

    @property
    def preset(self) -> QRectF:
        """The preset's value, under the name."""
        return self._second_line

    @property
    def reset(self) -> QRectF:
        """The word that resets, at the right under the value."""
        line = self._second_line
        return line.adjusted(line.width() - self._reset_px, -2, 0, 2)

    @property
    def automatic(self) -> QRectF:
        """The tick and the word under the value."""
        return self._second_line.adjusted(2, 0, -self._reset_px - GRID_PX, 0)

    def check_in(self, line: QRectF) -> QRectF:
        """The tick's box at the left of a line."""
        side = self._small.height() - 4
        inset = 6.0 if line.height() > self._small.height() + 2 else 0.0
        return QRectF(line.left() + inset, line.center().y() - side / 2, side, side)

    def height(self, error_width: float) -> float:
        """How high the row is, with its refusal wrapped to a width."""
        has_second = self._facts.differs or self._facts.is_optional
        height = self._line_px + (self._small.height() + 2 if has_second else 0.0)
        return height + self.error_height(error_width)

    def error_height(self, width: float) -> float:
        """How high the refusal is, 0 without one."""
        if not self._facts.error:
            return 0.0
        box = QRectF(0, 0, width - 2.5 * GRID_PX, 1000)
        flags = int(Qt.TextFlag.TextWordWrap)
        return self._small.boundingRect(box, flags, self._facts.error).height() + 6
