"""One sentence above the page: what went wrong and how to go on; the details are behind a click."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QPainter, QPaintEvent
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QPlainTextEdit,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)
from typing_extensions import override

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.state_mark import State, paint_mark

_DETAILS_PX = 160


class MessageBar(QFrame):
    """Shows the newest message until it is closed or replaced."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("message_bar")
        self._mark = _Mark()
        self._sentence = QLabel()
        self._sentence.setObjectName("message")
        self._sentence.setWordWrap(True)
        self._sentence.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self._sentence.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self._action = QPushButton()
        self._action.setObjectName("message_action")
        self._more = QPushButton(self.tr("Details"))
        self._more.setObjectName("message_details")
        self._more.setCheckable(True)
        close = QPushButton(self.tr("Close"))
        close.setObjectName("message_close")
        close.clicked.connect(self.hide)
        self._details = QPlainTextEdit()
        self._details.setReadOnly(True)
        self._details.setFixedHeight(_DETAILS_PX)
        self._details.hide()
        self._more.toggled.connect(self._details.setVisible)
        self._do: Callable[[], object] | None = None
        self._action.clicked.connect(self._act)
        row = QHBoxLayout()
        row.setSpacing(GRID_PX)
        row.addWidget(self._mark)
        row.addWidget(self._sentence, 1)
        for button in (self._action, self._more, close):
            row.addWidget(button)
        column = QVBoxLayout(self)
        column.setContentsMargins(2 * GRID_PX, GRID_PX, GRID_PX, GRID_PX)
        column.addLayout(row)
        column.addWidget(self._details)
        self.hide()

    @property
    def sentence(self) -> str:
        """What it says; empty while it is hidden."""
        return "" if self.isHidden() else self._sentence.text()

    def say(
        self,
        sentence: str,
        *,
        state: State = "stale",
        details: str = "",
        action: str = "",
        do: Callable[[], object] | None = None,
    ) -> None:
        """Show a sentence.

        Args:
            sentence: what happened and what to do.
            state: whose mark stands before it.
            details: for whoever wants to know more.
            action: words of a button that does something about it.
            do: what that button does.
        """
        self._sentence.setText(sentence)
        self._mark.show_state(state)
        self._more.setChecked(False)
        self._more.setVisible(bool(details))
        self._details.setPlainText(details)
        self._do = do
        self._action.setText(action)
        self._action.setVisible(do is not None)
        self.show()

    def _act(self) -> None:
        do, self._do = self._do, None
        self.hide()
        if do is not None:
            do()


class _Mark(QWidget):
    """The mark of the message's kind."""

    def __init__(self) -> None:
        super().__init__()
        self._state: State = "stale"
        self.setFixedSize(QSize(18, 18))

    def show_state(self, state: State) -> None:
        self._state = state
        self.update()

    @override
    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        paint_mark(painter, self.rect().toRectF(), self._state, theme_of(self))
        painter.end()
