"""The session's name in the top bar, and what can be done with sessions behind it."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu, QPushButton, QSizePolicy

from app.gui.desk.desk import Desk
from app.gui.theme import GRID_PX
from app.gui.views.name_dialog import ask_name
from app.library.index import Library
from app.library.places import sessions_folder
from app.library.summary import SessionSummary

_RECENT = 8
_WIDEST_PX = 45 * GRID_PX
"""The chips beside it stay in a window of the smallest size."""


class SessionButton(QPushButton):
    """Says which session is open; a click renames it, begins another one, or opens one of the last.

    Signals: `new_wanted` and `open_wanted` when these are chosen.
    """

    new_wanted = Signal()
    open_wanted = Signal()

    def __init__(self, desk: Desk) -> None:
        super().__init__()
        self.setObjectName("session_name")
        self.setProperty("role", "session")
        self.setSizePolicy(QSizePolicy.Policy.Maximum, QSizePolicy.Policy.Fixed)
        self._desk = desk
        self._recent: list[QAction] = []
        menu = QMenu(self)
        menu.setObjectName("session_menu")
        self._rename = menu.addAction(self.tr("Rename…"), self._ask_name)
        menu.addAction(self.tr("New session…"), self.new_wanted.emit)
        menu.addAction(self.tr("Open a session…"), self.open_wanted.emit)
        menu.addSeparator()
        menu.aboutToShow.connect(self._read_recent)
        self.setMenu(menu)
        desk.workspace.session_changed.connect(self._show)
        desk.workspace.renamed.connect(self._show)
        self._show()

    def _show(self) -> None:
        session = self._desk.workspace.session
        name = self.tr("No session") if session is None else session.name
        self.setToolTip("" if session is None else str(session.path))
        self.setAccessibleName(self.tr("Session: {name}").format(name=name))
        shown = self.fontMetrics().elidedText(name, Qt.TextElideMode.ElideMiddle, _WIDEST_PX)
        self.setText(shown.replace("&", "&&"))
        self._rename.setEnabled(session is not None)

    def _ask_name(self) -> None:
        ask_name(self.window(), self._desk.workspace.session_name, self._desk.rename_session)

    def _read_recent(self) -> None:
        """The library is read while the menu is open already."""
        self._desk.background.run("session menu", _recent_sessions, self._show_recent)

    def _show_recent(self, sessions: tuple[SessionSummary, ...]) -> None:
        menu, open_one = self.menu(), self._desk.workspace.folder
        for action in self._recent:
            menu.removeAction(action)
        others = [session for session in sessions if session.path != open_one]
        self._recent = [
            menu.addAction(_line(session), partial(self._desk.open_session, session.path))
            for session in others[:_RECENT]
        ]


def _recent_sessions() -> tuple[SessionSummary, ...]:
    return Library((sessions_folder(),)).refresh()[: _RECENT + 1]


def _line(session: SessionSummary) -> str:
    made = session.created_here
    day = session.created[:10] if made is None else f"{made:%Y-%m-%d %H:%M}"
    return f"{session.name}\t{day}".replace("&", "&&")
