"""The left half: the library, read in the background and searched, as cards; or what to do first."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QKeySequence, QShortcut
from PySide6.QtWidgets import QHBoxLayout, QLineEdit, QPushButton, QStackedWidget, QVBoxLayout, QWidget

from app.gui.desk.background import Background
from app.gui.pages.history.cards import CardList
from app.gui.theme import GRID_PX
from app.gui.views.labels import text_label
from app.library.index import Library
from app.library.places import sessions_folder
from app.library.summary import SessionSummary
from app.library.thumbnail import make_thumbnail

_SEARCH_PX, _MESSAGE_PX = 360, 440


@dataclass(frozen=True)
class Found:
    """What a search found.

    Attributes:
        sessions: the newest first.
        n_all: how many sessions there are at all.
        text: that was looked for.
    """

    sessions: tuple[SessionSummary, ...]
    n_all: int
    text: str


class Shelf(QObject):
    """Reads and searches the library, and has pictures made of the sessions that lack one.

    Signals: `found` with a `Found`; `pictured` with a session's folder and its new picture.

    Attributes:
        root: the folder that holds the sessions.
    """

    found = Signal(object)
    pictured = Signal(object, object)

    def __init__(self, background: Background, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.root = sessions_folder()
        self._background = background
        self._library = Library((self.root,))
        self._text = ""
        self._sessions: tuple[SessionSummary, ...] = ()
        self._pictures: dict[SessionSummary, Path | None] = {}  # none: being made, or it cannot be made
        self._is_drawing = False
        self._is_paused = True

    def refresh(self) -> None:
        """Look what sessions there are now; pictures are made from then on."""
        self._is_paused = False
        self._background.run("history", partial(_look, self._library, self._text, True), self._take)

    def search(self, text: str) -> None:
        """Show only sessions that hold every word of `text`."""
        self._text = text
        self._background.run("history", partial(_look, self._library, text, False), self._take)

    def pause(self) -> None:
        """Make no more pictures until the next `refresh`."""
        self._is_paused = True

    def remember(self, folder: Path) -> None:
        """Add a session from another folder; a library that cannot be written is no reason to complain."""
        remember = partial(self._library.remember, folder)
        self._background.run("history remember", remember, lambda _: None, lambda _: None)

    def forget(self, folder: Path) -> None:
        """Remove a session in another folder from the library, and look again."""
        forget = partial(self._library.forget, folder)
        self._background.run("history forget", forget, lambda _: self.refresh())

    def _take(self, found: Found) -> None:
        self._sessions = found.sessions
        pictured = (
            replace(one, thumbnail=one.thumbnail or self._pictures.get(one)) for one in found.sessions
        )
        self.found.emit(replace(found, sessions=tuple(pictured)))
        self._draw_next()

    def _draw_next(self) -> None:
        lacking = (one for one in self._sessions if _lacks_picture(one) and one not in self._pictures)
        session = next(lacking, None)
        if session is None or self._is_drawing or self._is_paused:
            return
        self._pictures[session] = None
        self._is_drawing = True
        self._background.run(
            "history picture",
            partial(make_thumbnail, session.path),
            partial(self._drawn, session),
            lambda _: self._drawn(
                session, None
            ),  # a session whose picture cannot be made is shown without one
        )

    def _drawn(self, session: SessionSummary, picture: Path | None) -> None:
        self._is_drawing = False
        self._pictures[session] = picture
        if picture is not None:
            self.pictured.emit(session.path, picture)
        self._draw_next()


def _look(library: Library, text: str, is_anew: bool) -> Found:
    everything = library.refresh() if is_anew else library.search("")
    return Found(library.search(text), len(everything), text)


def _lacks_picture(session: SessionSummary) -> bool:
    has_source = "scan" in session.stages or "mesh" in session.stages
    return has_source and session.thumbnail is None and not session.problem


class LibraryView(QWidget):
    """Search line and cards.

    Signals: `searched` with the text in the search line; `import_wanted` and `start_wanted` when their
    buttons are pressed.

    Attributes:
        cards: the cards.
    """

    searched = Signal(str)
    import_wanted = Signal()
    start_wanted = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.cards = CardList()
        self._imports = [
            _button(name, self.tr("Import ZIP…"), self.import_wanted.emit)
            for name in ("import", "import_first")
        ]
        self._count = text_label("count", "muted")
        self._no_match = text_label("no_match_title", "title")
        self._top = self._build_top()
        self._stack = QStackedWidget()
        self._places = {widget.objectName(): widget for widget in (*self._build_messages(), self.cards)}
        for widget in self._places.values():
            self._stack.addWidget(widget)
        column = QVBoxLayout(self)
        column.setContentsMargins(GRID_PX, 0, 0, 0)
        column.setSpacing(GRID_PX // 2)
        column.addWidget(self._top)
        column.addWidget(self._stack, 1)

    def _build_top(self) -> QWidget:
        self._search = QLineEdit()
        self._search.setObjectName("search")
        self._search.setAccessibleName(self.tr("Search sessions"))
        self._search.setPlaceholderText(self.tr("Search name, verdict, outcome, date"))
        self._search.setToolTip(self.tr("Every word must match, for example: mug container 2026-11 (Ctrl+F)"))
        self._search.setClearButtonEnabled(True)
        self._search.setTextMargins(GRID_PX // 2, 0, GRID_PX // 2, 0)
        self._search.setMaximumWidth(_SEARCH_PX)
        self._search.setMinimumHeight(4 * GRID_PX)
        self._search.textChanged.connect(self.searched)
        self._search.returnPressed.connect(self.cards.setFocus)
        find = QShortcut(QKeySequence(QKeySequence.StandardKey.Find), self)
        find.activated.connect(self._search.setFocus)
        self._imports[0].setToolTip(self.tr("Add a session that was exported as a ZIP file"))
        top = QWidget()
        row = QHBoxLayout(top)
        row.setContentsMargins(GRID_PX // 2, GRID_PX, GRID_PX, 0)
        row.setSpacing(2 * GRID_PX)
        row.addWidget(self._search, 2)
        row.addWidget(self._count, 1)
        row.addWidget(self._imports[0])
        return top

    def _build_messages(self) -> list[QWidget]:
        """What is said where there are no cards; the first is shown until the library is read."""
        start = _button("start", self.tr("Start with a scan"), self.start_wanted.emit)
        start.setProperty("role", "primary")
        clear = _button("clear_search", self.tr("Show all sessions"), self._clear_search)
        explained = self.tr(
            "Every object you scan becomes a session and is kept here: with its picture, whether it is a "
            "container, the best pour, and how the pour went."
        )
        return [
            _message("loading", [text_label("", "title", self.tr("Looking for sessions…"))]),
            _message(
                "no_sessions",
                [text_label("", "title", self.tr("No sessions yet")), text_label("", text=explained)],
                [start, self._imports[1]],
            ),
            _message("no_match", [self._no_match], [clear]),
        ]

    @property
    def shown(self) -> str:
        """Object name of what is below the search line: `sessions`, `loading`, `no_sessions`, `no_match`."""
        widget = self._stack.currentWidget()
        return "" if widget is None else widget.objectName()

    def show_found(self, found: Found) -> None:
        """Show what a search found."""
        self.cards.show_sessions(found.sessions)
        n = len(found.sessions)
        if n < found.n_all:
            said = self.tr("{n} of {all}")
        else:
            said = self.tr("1 session") if n == 1 else self.tr("{n} sessions")
        self._count.setText(said.format(n=n, all=found.n_all))
        no_match = self.tr("No session matches '{text}'.")
        self._no_match.setText(no_match.format(text=found.text.strip()))
        shown = "sessions" if n else "no_match" if found.n_all else "no_sessions"
        self._stack.setCurrentWidget(self._places[shown])
        self._top.setVisible(bool(found.n_all))

    def set_can_import(self, can: bool) -> None:
        """Enable the buttons that import."""
        for button in self._imports:
            button.setEnabled(can)

    def _clear_search(self) -> None:
        self._search.clear()
        self._search.setFocus()


def _button(name: str, text: str, pressed: Callable[[], object]) -> QPushButton:
    button = QPushButton(text)
    button.setObjectName(name)
    button.clicked.connect(lambda: pressed())
    return button


def _message(name: str, labels: list[QWidget], buttons: list[QPushButton] | None = None) -> QWidget:
    """Sentences and buttons in the middle of the view."""
    inside = QWidget()
    inside.setFixedWidth(_MESSAGE_PX)
    column = QVBoxLayout(inside)
    column.setSpacing(2 * GRID_PX)
    for label in labels:
        column.addWidget(label)
    row = QHBoxLayout()
    row.setSpacing(GRID_PX)
    for button in buttons or ():
        row.addWidget(button)
    row.addStretch(1)
    column.addLayout(row)
    whole = QWidget()
    whole.setObjectName(name)
    middle = QHBoxLayout()  # not an alignment, which would ignore how high the wrapped text is
    middle.addStretch(1)
    middle.addWidget(inside)
    middle.addStretch(1)
    outer = QVBoxLayout(whole)
    outer.addStretch(1)
    outer.addLayout(middle)
    outer.addStretch(2)
    return whole
