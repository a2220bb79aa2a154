"""The tabs in the order of the work, each with its state; calibration and history below."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QEvent, QRect, QSize, Qt, Signal
from PySide6.QtGui import QFont, QPainter, QPaintEvent
from PySide6.QtWidgets import QAbstractButton, QButtonGroup, QFrame, QVBoxLayout
from typing_extensions import override

from app.gui.desk.page_states import PageState
from app.gui.theme import GRID_PX, theme_of
from app.gui.views.state_mark import paint_mark, state_word

WIDTH_PX = 136


@dataclass(frozen=True)
class TabFacts:
    """A page's key, its title, and what it is for."""

    key: str
    title: str
    tip: str


class Tab(QAbstractButton):
    """A title over a mark and a word."""

    def __init__(self, facts: TabFacts, number: int | None) -> None:
        super().__init__()
        self.setObjectName(f"tab_{facts.key}")
        self.setCheckable(True)
        self.setText(facts.title)
        self.setToolTip(facts.tip)
        self.setAccessibleName(facts.title)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._number = number
        self._state: PageState | None = PageState("empty") if number is not None else None

    @property
    def state(self) -> PageState | None:
        """What it shows; none for pages that have no state."""
        return self._state

    def set_state(self, state: PageState) -> None:
        """Show another state."""
        if state != self._state:
            self._state = state
            self.setAccessibleDescription(state_word(state.word))
            self.update()

    @override
    def sizeHint(self) -> QSize:
        return QSize(WIDTH_PX, 7 * GRID_PX if self._state is not None else 5 * GRID_PX)

    @override
    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        self._paint(painter)
        painter.end()

    def _paint(self, painter: QPainter) -> None:
        theme, area = theme_of(self), self.rect()
        if self.isChecked():
            painter.fillRect(area, theme.color("surface"))
            painter.fillRect(QRect(0, 0, 4, area.height()), theme.color("accent"))
        elif self.underMouse() or self.hasFocus():
            painter.fillRect(area, theme.color("raised"))
        font = QFont(self.font())
        font.setWeight(QFont.Weight.DemiBold if self.isChecked() else QFont.Weight.Normal)
        font.setPointSizeF(self.font().pointSizeF() + 1)
        painter.setFont(font)
        painter.setPen(theme.color("text"))
        title = self.text() if self._number is None else f"{self._number}  {self.text()}"
        inside = area.adjusted(2 * GRID_PX, GRID_PX, -GRID_PX // 2, -GRID_PX)
        if self._state is None:
            painter.drawText(inside, Qt.AlignmentFlag.AlignVCenter, title)
            return
        painter.drawText(inside, Qt.AlignmentFlag.AlignTop, title)
        self._paint_state(painter, inside, self._state)

    def _paint_state(self, painter: QPainter, inside: QRect, state: PageState) -> None:
        theme = theme_of(self)
        mark = QRect(inside.left() + 2 * GRID_PX + 2, inside.bottom() - 14, 14, 14)
        paint_mark(painter, mark.toRectF(), state.word, theme)
        font = QFont(self.font())
        font.setPointSizeF(self.font().pointSizeF() - 1)
        painter.setFont(font)
        painter.setPen(theme.color("muted"))
        text = state.figure if state.figure and state.word == "fresh" else state_word(state.word)
        area = QRect(mark.right() + GRID_PX // 2 + 2, mark.top() - 2, inside.right() - mark.right(), 18)
        painter.drawText(area, Qt.AlignmentFlag.AlignVCenter, text)


class TabList(QFrame):
    """Lets one page be chosen."""

    chosen = Signal(str)

    def __init__(self, stages: tuple[TabFacts, ...], others: tuple[TabFacts, ...]) -> None:
        super().__init__()
        self.setObjectName("tab_list")
        self.setFixedWidth(WIDTH_PX)
        self._tabs: dict[str, Tab] = {}
        self._group = QButtonGroup(self)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, GRID_PX, 0, GRID_PX)
        column.setSpacing(0)
        for number, facts in enumerate(stages, 1):
            column.addWidget(self._add(facts, number))
        line = QFrame()
        line.setProperty("role", "line")
        column.addSpacing(GRID_PX)
        column.addWidget(line)
        column.addSpacing(GRID_PX)
        for facts in others:
            column.addWidget(self._add(facts, None))
        column.addStretch(1)

    def choose(self, key: str) -> None:
        """Mark a page as the one that is shown; none of them for a key that has no tab."""
        self._group.setExclusive(False)
        for name, tab in self._tabs.items():
            tab.setChecked(name == key)
        self._group.setExclusive(True)

    def set_state(self, key: str, state: PageState) -> None:
        """Show how a page stands."""
        self._tabs[key].set_state(state)

    def _add(self, facts: TabFacts, number: int | None) -> Tab:
        tab = Tab(facts, number)
        tab.clicked.connect(lambda: self.chosen.emit(facts.key))
        self._group.addButton(tab)
        self._tabs[facts.key] = tab
        return tab

    @override
    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            for tab in self._tabs.values():
                tab.update()
