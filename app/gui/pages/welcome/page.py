"""The first thing somebody sees: one button that leads to poured candies, and the ways to one's own work."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from app.gui.desk.desk import Desk
from app.gui.desk.memory import Memory
from app.gui.pages.page import Page
from app.gui.theme import GRID_PX
from app.library.index import Library
from app.library.places import sessions_folder
from app.library.summary import SessionSummary

_RECENT = 5
_WIDTH_PX = 720


def _recent_sessions() -> tuple[SessionSummary, ...]:
    return Library((sessions_folder(),)).refresh()[:_RECENT]


class WelcomePage(Page):
    """Start with the mug in the simulated cell, with an own session, or where one left."""

    KEY = "welcome"
    mug_wanted = Signal()
    new_wanted = Signal()
    open_wanted = Signal()

    def __init__(self, desk: Desk, memory: Memory) -> None:
        super().__init__(desk)
        self._memory = memory
        self._last = QVBoxLayout()
        self._recent = QVBoxLayout()
        self._recent.setSpacing(GRID_PX // 2)
        column = QVBoxLayout()
        column.setSpacing(2 * GRID_PX)
        column.addStretch(1)
        column.addWidget(self._heading())
        column.addWidget(self._mug())
        column.addLayout(self._last)
        column.addLayout(self._own())
        column.addLayout(self._recent)
        column.addStretch(2)
        inside = QWidget()
        inside.setFixedWidth(_WIDTH_PX)
        inside.setLayout(column)
        row = QHBoxLayout(self)
        row.addStretch(1)
        row.addWidget(inside)
        row.addStretch(1)

    def refresh(self) -> None:
        """Show the last session and the newest ones."""
        _clear(self._last)
        last = self._memory.last_session
        if last is not None:
            button = QPushButton(self.tr("Continue with {name}").format(name=last.name))
            button.setObjectName("continue")
            button.setToolTip(str(last))
            button.clicked.connect(lambda: self.desk.open_session(last))
            self._last.addWidget(button, 0, Qt.AlignmentFlag.AlignLeft)
        self.desk.background.run("recent sessions", _recent_sessions, self._show_recent)

    def _heading(self) -> QWidget:
        title = QLabel(self.tr("Can I pour into it?"))
        title.setProperty("role", "title")
        what = QLabel(
            self.tr(
                "The robot scans an object that nobody has modelled. Physics imagines whether candies "
                "dropped on it would stay, and from where to pour. You look at the evidence, confirm, and "
                "the arm pours."
            )
        )
        what.setWordWrap(True)
        box = QWidget()
        column = QVBoxLayout(box)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(title)
        column.addWidget(what)
        return box

    def _mug(self) -> QWidget:
        card = QFrame()
        card.setObjectName("side_panel")
        button = QPushButton(self.tr("Scan the mug"))
        button.setObjectName("primary")
        button.setProperty("role", "primary")
        button.setMinimumHeight(6 * GRID_PX)
        button.clicked.connect(self.mug_wanted)
        said = QLabel(
            self.tr(
                "In the simulated cell: nothing real moves, and everything else is as it will be. From here "
                "it is a few clicks to poured candies; the bar at the bottom always names the next one."
            )
        )
        said.setWordWrap(True)
        row = QHBoxLayout(card)
        row.setContentsMargins(2 * GRID_PX, 2 * GRID_PX, 2 * GRID_PX, 2 * GRID_PX)
        row.setSpacing(2 * GRID_PX)
        row.addWidget(button)
        row.addWidget(said, 1)
        return card

    def _own(self) -> QHBoxLayout:
        row = QHBoxLayout()
        row.setSpacing(GRID_PX)
        for name, text, signal in (
            ("new_session", self.tr("New session…"), self.new_wanted),
            ("open_session", self.tr("Open a session…"), self.open_wanted),
        ):
            button = QPushButton(text)
            button.setObjectName(name)
            button.clicked.connect(signal)
            row.addWidget(button)
        row.addStretch(1)
        return row

    def _show_recent(self, sessions: tuple[SessionSummary, ...]) -> None:
        _clear(self._recent)
        if sessions:
            heading = QLabel(self.tr("Recent sessions"))
            heading.setProperty("role", "heading")
            self._recent.addWidget(heading)
        for session in sessions:
            button = QPushButton(_line(session))
            button.setProperty("role", "link")
            button.setToolTip(str(session.path))
            button.clicked.connect(lambda _=False, path=session.path: self._open(path))
            self._recent.addWidget(button)

    def _open(self, path: Path) -> None:
        self.desk.open_session(path)


def _line(session: SessionSummary) -> str:
    facts = [session.name, session.created[:10], session.source]
    return "   ·   ".join(fact for fact in facts if fact)


def _clear(layout: QVBoxLayout) -> None:
    while layout.count():
        item = layout.takeAt(0)
        widget = item.widget() if item is not None else None
        if widget is not None:
            widget.deleteLater()
