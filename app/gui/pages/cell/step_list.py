"""The steps as a list: state, title, figure and time of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

from PySide6.QtCore import QRect, QRectF, QSize, QSizeF, Qt, Signal
from PySide6.QtGui import QFont, QFontMetrics, QFontMetricsF, QPainter, QPaintEvent
from PySide6.QtWidgets import QAbstractButton, QButtonGroup, QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import draw_elided, smaller
from app.gui.views.state_mark import State, paint_mark, state_word

_MARK_PX = 16
_TEXT_LEFT_PX = GRID_PX + _MARK_PX + GRID_PX
_ABOVE_PX, _BELOW_PX = 4, 5
_WRAPPED = int(Qt.TextFlag.TextWordWrap | Qt.AlignmentFlag.AlignTop)


@dataclass(frozen=True)
class StepLine:
    """What a row shows.

    Attributes:
        key: of the step.
        title: its name.
        state: how far it is.
        figure: what came of it.
        when: it was done.
    """

    key: str
    title: str
    state: State
    figure: str
    when: str


class StepRow(QAbstractButton):
    """One step; the button is down while it is the chosen one."""

    def __init__(self, key: str) -> None:
        super().__init__()
        self.setObjectName(f"step_{key}")
        self.setCheckable(True)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._line: StepLine | None = None

    @property
    def line(self) -> StepLine | None:
        """What it shows."""
        return self._line

    def set_line(self, line: StepLine) -> None:
        """Show something else."""
        if line != self._line:
            self._line = line
            self.setAccessibleName(line.title)
            self.setAccessibleDescription(f"{state_word(line.state)}: {line.figure}")
            self.setToolTip(line.figure)
            self.updateGeometry()
            self.update()

    @override
    def sizeHint(self) -> QSize:
        width_px = 30 * GRID_PX
        return QSize(width_px, self.heightForWidth(width_px))

    @override
    def hasHeightForWidth(self) -> bool:
        return True

    @override
    def heightForWidth(self, width: int) -> int:
        note = self._note_area(width, QFontMetrics(smaller(self.font())).height())
        return ceil(note.bottom()) + _BELOW_PX

    def note(self, width: int) -> str:
        """The whole figure if a line of a row of this width holds it, else its first part."""
        figure = "" if self._line is None else self._line.figure
        room_px = width - _TEXT_LEFT_PX - GRID_PX
        if QFontMetrics(smaller(self.font())).horizontalAdvance(figure) <= room_px:
            return figure
        return figure.split("; ")[0]

    def _note_area(self, width: int, least_px: float) -> QRectF:
        top = _ABOVE_PX + QFontMetrics(self._title_font()).height()
        room = QRectF(_TEXT_LEFT_PX, top, width - _TEXT_LEFT_PX - GRID_PX, 100 * least_px)
        taken = QFontMetricsF(smaller(self.font())).boundingRect(room, _WRAPPED, self.note(width))
        return QRectF(room.topLeft(), QSizeF(room.width(), max(taken.height(), least_px)))

    def _title_font(self) -> QFont:
        font = QFont(self.font())
        font.setWeight(QFont.Weight.DemiBold)
        return font

    @override
    def paintEvent(self, _event: QPaintEvent) -> None:
        line = self._line
        if line is None:
            return
        painter = QPainter(self)
        theme, area = theme_of(self), self.rect()
        if self.isChecked():
            painter.fillRect(area, theme.color("raised"))
            painter.fillRect(QRect(0, 0, 3, area.height()), theme.color("accent"))
        elif self.underMouse() or self.hasFocus():
            painter.fillRect(area, theme.color("window"))
        note = self._note_area(area.width(), 0.0)
        title = QRectF(_TEXT_LEFT_PX, _ABOVE_PX, note.width(), note.top() - _ABOVE_PX)
        paint_mark(painter, QRectF(GRID_PX, title.top(), _MARK_PX, title.height()), line.state, theme)
        small = smaller(self.font())
        time_px = QFontMetrics(small).horizontalAdvance(line.when) + GRID_PX
        middle = Qt.AlignmentFlag.AlignVCenter
        painter.setFont(self._title_font())
        painter.setPen(theme.color("text"))
        draw_elided(painter, title.adjusted(0, 0, -time_px, 0), line.title, middle)
        painter.setFont(small)
        painter.setPen(theme.color("muted"))
        painter.drawText(title, int(middle | Qt.AlignmentFlag.AlignRight), line.when)
        painter.drawText(note, _WRAPPED, self.note(area.width()))
        painter.end()


class StepList(QWidget):
    """All steps, one of them chosen.

    Signals: `chosen` with the key of the one that was clicked.
    """

    chosen = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("steps")
        self._rows: dict[str, StepRow] = {}
        self._group = QButtonGroup(self)
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(0, 0, 0, 0)
        self._column.setSpacing(1)

    @property
    def lines(self) -> tuple[StepLine, ...]:
        """What is shown."""
        return tuple(row.line for row in self._rows.values() if row.line is not None)

    def set_lines(self, lines: Sequence[StepLine]) -> None:
        """Show other states of the steps."""
        for line in lines:
            if line.key not in self._rows:
                self._add(line.key)
            self._rows[line.key].set_line(line)

    def choose(self, key: str) -> None:
        """Mark a step; none for an empty key."""
        self._group.setExclusive(False)
        for name, row in self._rows.items():
            row.setChecked(name == key)
        self._group.setExclusive(True)

    def _add(self, key: str) -> None:
        row = StepRow(key)
        row.clicked.connect(lambda: self.chosen.emit(key))
        self._group.addButton(row)
        self._column.addWidget(row)
        self._rows[key] = row
