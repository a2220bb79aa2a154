"""The left half: a search line above the cards, or what to do where there are none."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeySequence, QShortcut
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from app.gui.pages.history.cards import CardList
from app.gui.pages.history.shelf import Found
from app.gui.theme import GRID_PX

_SEARCH_PX = 360
_EMPTY_PX = 440


class ListView(QWidget):
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
        self.setObjectName("list_view")
        self.cards = CardList()
        self._loading = self._build_message("loading", self.tr("Looking for sessions…"), "")
        self._none = self._build_empty()
        self._no_match = self._build_no_match()
        self._stack = QStackedWidget()
        for widget in (self._loading, self.cards, self._none, self._no_match):
            self._stack.addWidget(widget)
        column = QVBoxLayout(self)
        column.setContentsMargins(GRID_PX, 0, 0, 0)
        column.setSpacing(GRID_PX // 2)
        column.addWidget(self._build_top())
        column.addWidget(self._stack, 1)

    @property
    def shown(self) -> str:
        """Object name of what is below the search line: `sessions`, `loading`, `no_sessions`, `no_match`."""
        widget = self._stack.currentWidget()
        return "" if widget is None else widget.objectName()

    def show_found(self, found: Found) -> None:
        """Show what a search found."""
        self.cards.show_sessions(found.sessions)
        n = len(found.sessions)
        if not found.n_all:
            self._stack.setCurrentWidget(self._none)
            self._count.clear()
        elif not n:
            self._no_match_title.setText(
                self.tr("No session matches '{text}'.").format(text=found.text.strip())
            )
            self._stack.setCurrentWidget(self._no_match)
            self._count.setText(self.tr("0 of {all}").format(all=found.n_all))
        else:
            self._stack.setCurrentWidget(self.cards)
            said = self.tr("{n} of {all}") if n < found.n_all else self.tr("{n} sessions")
            self._count.setText(
                self.tr("1 session") if found.n_all == 1 else said.format(n=n, all=found.n_all)
            )
        self._top.setVisible(bool(found.n_all))

    def set_can_import(self, can: bool) -> None:
        """Enable the buttons that import."""
        self._import.setEnabled(can)
        self._import_first.setEnabled(can)

    def _build_top(self) -> QWidget:
        self._search = QLineEdit()
        self._search.setObjectName("search")
        self._search.setAccessibleName(self.tr("Search sessions"))
        self._search.setPlaceholderText(self.tr("Search name, verdict, outcome, date"))
        self._search.setToolTip(
            self.tr("Every word must occur, such as: mug container 2026-11 (Ctrl+F comes here).")
        )
        self._search.setClearButtonEnabled(True)
        self._search.setTextMargins(GRID_PX // 2, 0, GRID_PX // 2, 0)
        self._search.setMaximumWidth(_SEARCH_PX)
        self._search.setMinimumHeight(4 * GRID_PX)
        self._search.textChanged.connect(self.searched)
        self._search.returnPressed.connect(self.cards.setFocus)
        find = QShortcut(QKeySequence(QKeySequence.StandardKey.Find), self)
        find.setContext(Qt.ShortcutContext.WindowShortcut)
        find.activated.connect(self._search.setFocus)
        self._count = QLabel()
        self._count.setObjectName("count")
        self._count.setProperty("role", "muted")
        self._import = QPushButton(self.tr("Import ZIP…"))
        self._import.setObjectName("import")
        self._import.setToolTip(self.tr("Take in a session that was exported as ZIP."))
        self._import.clicked.connect(self.import_wanted)
        self._top = QWidget()
        row = QHBoxLayout(self._top)
        row.setContentsMargins(GRID_PX // 2, GRID_PX, GRID_PX, 0)
        row.setSpacing(2 * GRID_PX)
        row.addWidget(self._search, 2)
        row.addWidget(self._count)
        row.addStretch(1)
        row.addWidget(self._import)
        return self._top

    def _build_empty(self) -> QWidget:
        start = QPushButton(self.tr("Start with a scan"))
        start.setObjectName("start")
        start.setProperty("role", "primary")
        start.clicked.connect(self.start_wanted)
        self._import_first = QPushButton(self.tr("Import ZIP…"))
        self._import_first.setObjectName("import_first")
        self._import_first.clicked.connect(self.import_wanted)
        return self._build_message(
            "no_sessions",
            self.tr("No sessions yet"),
            self.tr(
                "Every object that is scanned becomes a session and stays here: with its picture, whether it "
                "is a container, the best pour, and what came of it."
            ),
            start,
            self._import_first,
        )

    def _build_no_match(self) -> QWidget:
        clear = QPushButton(self.tr("Show all sessions"))
        clear.setObjectName("clear_search")
        clear.clicked.connect(self._search_clear)
        self._no_match_title = QLabel()
        return self._build_message("no_match", self._no_match_title, "", clear)

    def _search_clear(self) -> None:
        self._search.clear()
        self._search.setFocus()

    def _build_message(self, name: str, title: QLabel | str, text: str, *buttons: QPushButton) -> QWidget:
        """A title, a sentence and buttons in the middle of the room."""
        head = QLabel(title) if isinstance(title, str) else title
        head.setProperty("role", "title")
        head.setWordWrap(True)
        said = QLabel(text)
        said.setWordWrap(True)
        said.setVisible(bool(text))
        row = QHBoxLayout()
        row.setSpacing(GRID_PX)
        for button in buttons:
            row.addWidget(button)
        row.addStretch(1)
        inside = QWidget()
        inside.setFixedWidth(_EMPTY_PX)
        column = QVBoxLayout(inside)
        column.setSpacing(2 * GRID_PX)
        for widget in (head, said):
            column.addWidget(widget)
        column.addLayout(row)
        whole = QWidget()
        whole.setObjectName(name)
        middle = QHBoxLayout()  # not an alignment, which would ask nobody how high the wrapped text is
        middle.addStretch(1)
        middle.addWidget(inside)
        middle.addStretch(1)
        outer = QVBoxLayout(whole)
        outer.addStretch(1)
        outer.addLayout(middle)
        outer.addStretch(2)
        return whole
