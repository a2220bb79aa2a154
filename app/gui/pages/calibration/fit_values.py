"""The best values so far beside those to start from, and how much each parameter matters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QEvent, QRectF, QSize, Qt
from PySide6.QtGui import QPainter, QPaintEvent
from PySide6.QtWidgets import QSizePolicy, QWidget
from typing_extensions import override

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import draw_elided, smaller, tabular

_ROW_PX = 3 * GRID_PX
_TITLE_SHARE, _NUMBER_PX, _PERCENT_PX = 0.34, 12 * GRID_PX, 6 * GRID_PX
_BAR_PX = 8


@dataclass(frozen=True)
class ValueRow:
    """A parameter.

    Attributes:
        title: what it is called.
        start: the value to start from, with its unit.
        best: the best so far, with its unit.
        importance: share in the differences between trials, 0 to 1; none as long as there is no telling.
        note: what is said instead of the importance.
    """

    title: str
    start: str
    best: str
    importance: float | None
    note: str = ""


class FitValues(QWidget):
    """A painted table with bars."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("fit_values")
        self.setAccessibleName(self.tr("Best values so far"))
        self.setToolTip(
            self.tr(
                "Importance: how much the best quarter of the trials differs from the others in this "
                "parameter (PED-ANOVA); told from eight trials on."
            )
        )
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self._rows: tuple[ValueRow, ...] = ()

    @property
    def rows(self) -> tuple[ValueRow, ...]:
        """What is shown."""
        return self._rows

    def set_rows(self, rows: Sequence[ValueRow]) -> None:
        """Show other values."""
        self._rows = tuple(rows)
        words = [f"{row.title}: {row.best}, {self._share(row)}" for row in rows]
        self.setAccessibleDescription("; ".join(words))
        self.updateGeometry()
        self.update()

    def _share(self, row: ValueRow) -> str:
        if row.note:
            return row.note
        return "--" if row.importance is None else f"{100 * row.importance:.0f} %"

    @override
    def sizeHint(self) -> QSize:
        return QSize(64 * GRID_PX, (len(self._rows) + 1) * _ROW_PX + GRID_PX)

    @override
    def minimumSizeHint(self) -> QSize:
        return QSize(48 * GRID_PX, self.sizeHint().height())

    @override
    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        heads = self.tr("Parameter"), self.tr("Start"), self.tr("Best"), self.tr("Importance")
        painter.setFont(smaller(self.font()))
        self._paint_texts(painter, 0, heads, ("muted",) * 4)
        painter.setFont(tabular(self.font()))
        for k, row in enumerate(self._rows, 1):
            self._paint_texts(painter, k, (row.title, row.start, row.best, ""), ("text", "muted", "text", ""))
            self._paint_bar(painter, k, row)
        painter.end()

    def _boxes(self, k: int) -> tuple[QRectF, QRectF, QRectF, QRectF]:
        """Title, start, best, importance of a row."""
        left, top = 2.0 * GRID_PX, float(k * _ROW_PX)
        width = self.width() - 4 * GRID_PX
        title = QRectF(left, top, width * _TITLE_SHARE, _ROW_PX)
        start = QRectF(title.right() + GRID_PX, top, _NUMBER_PX, _ROW_PX)
        best = QRectF(start.right() + GRID_PX, top, _NUMBER_PX, _ROW_PX)
        first = best.right() + 4 * GRID_PX
        return title, start, best, QRectF(first, top, left + width - first, _ROW_PX)

    def _paint_texts(self, painter: QPainter, k: int, texts: Sequence[str], inks: Sequence[str]) -> None:
        middle = Qt.AlignmentFlag.AlignVCenter
        sides = (Qt.AlignmentFlag.AlignLeft, *(Qt.AlignmentFlag.AlignRight,) * 2, Qt.AlignmentFlag.AlignLeft)
        theme = theme_of(self)
        for box, text, ink, side in zip(self._boxes(k), texts, inks, sides, strict=True):
            if text:
                painter.setPen(theme.color(ink))
                draw_elided(painter, box, text, side | middle)

    def _paint_bar(self, painter: QPainter, k: int, row: ValueRow) -> None:
        theme, box = theme_of(self), self._boxes(k)[3]
        painter.setPen(theme.color("text" if row.importance is not None else "muted"))
        if row.note:
            draw_elided(painter, box, row.note, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
            return
        number = QRectF(box.left(), box.top(), _PERCENT_PX, box.height())
        painter.drawText(
            number, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, self._share(row)
        )
        if row.importance is None:
            return
        first = number.right() + GRID_PX
        bar = QRectF(first, box.center().y() - _BAR_PX / 2, box.right() - first, _BAR_PX)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(theme.color("raised"))
        painter.drawRoundedRect(bar, 3, 3)
        bar.setWidth(bar.width() * min(max(row.importance, 0.0), 1.0))
        painter.setBrush(theme.color("accent"))
        painter.drawRoundedRect(bar, 3, 3)

    @override
    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.update()
