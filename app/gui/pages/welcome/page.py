"""The first page: one button that leads to poured candies, and the user's own sessions."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout, QPushButton, QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.desk.desk import Desk
from app.gui.desk.memory import Memory
from app.gui.pages.page import PRIMARY, Page
from app.gui.pages.welcome.pictures import StepPictures
from app.gui.theme import GRID_PX
from app.gui.views.labels import heading, text_label
from app.library.index import Library
from app.library.places import sessions_folder
from app.library.summary import SessionSummary

_RECENT = 5
_WIDTH_PX = 720


def _recent_sessions() -> tuple[SessionSummary, ...]:
    return Library((sessions_folder(),)).refresh()[:_RECENT]


class WelcomePage(Page):
    """Start with the mug in the simulated cell, with a session of one's own, or where one left off.

    Signals: `mug_wanted`, `new_wanted` and `open_wanted` when their buttons are pressed.
    """

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
        column.addWidget(StepPictures())
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

    @override
    def refresh(self) -> None:
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
        box = QWidget()
        column = QVBoxLayout(box)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(text_label("", "title", self.tr("Can I pour into it?")))
        explained = self.tr(
            "The robot scans an unknown object. A physics simulation imagines whether candies dropped on it "
            "would stay, and from where to pour. You check the evidence and confirm, and the arm pours."
        )
        column.addWidget(text_label("", text=explained))
        return box

    def _mug(self) -> QWidget:
        card = QFrame()
        card.setObjectName("side_panel")
        button = QPushButton(self.tr("Scan the mug"))
        button.setObjectName(PRIMARY)
        button.setProperty("role", "primary")
        button.setMinimumHeight(6 * GRID_PX)
        button.clicked.connect(self.mug_wanted)
        explained = self.tr(
            "In the simulated cell nothing real moves, and everything else works as on the real robot. A few "
            "clicks lead to poured candies; the bar at the bottom always names the next step."
        )
        row = QHBoxLayout(card)
        row.setContentsMargins(2 * GRID_PX, 2 * GRID_PX, 2 * GRID_PX, 2 * GRID_PX)
        row.setSpacing(2 * GRID_PX)
        row.addWidget(button)
        row.addWidget(text_label("", text=explained), 1)
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
            self._recent.addWidget(heading(self.tr("Recent sessions")))
        for session in sessions:
            button = QPushButton(_line(session))
            button.setProperty("role", "link")
            button.setToolTip(str(session.path))
            button.clicked.connect(lambda _=False, path=session.path: self.desk.open_session(path))
            self._recent.addWidget(button)


def _line(session: SessionSummary) -> str:
    made = session.created_here
    facts = [session.name, session.created[:10] if made is None else f"{made:%Y-%m-%d}", session.source]
    return "   ·   ".join(fact for fact in facts if fact)


def _clear(layout: QVBoxLayout) -> None:
    while layout.count():
        item = layout.takeAt(0)
        widget = item.widget() if item is not None else None
        if widget is not None:
            widget.deleteLater()
