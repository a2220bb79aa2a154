"""Where the keyboard is: a button that goes leaves the focus on its page and gets it back afterwards."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QAbstractButton, QApplication, QWidget
from shiboken6 import isValid

_ENTER = (Qt.Key.Key_Return, Qt.Key.Key_Enter)


class FocusKeeper(QObject):
    """Keeps the focus of a window from wandering.

    Qt hands the focus of a widget that is disabled or hidden to the next one: when a job began, that was
    Cancel, or a table that took the focus for a choice.
    """

    def __init__(self, window: QWidget, page: Callable[[], QWidget | None]) -> None:
        """`page` returns the page that is shown."""
        super().__init__(window)
        self._window = window
        self._page = page
        self._gone: QWidget | None = None
        application = QApplication.instance()
        assert isinstance(application, QApplication), "there is a window"
        application.focusChanged.connect(self._follow)

    def _follow(self, old: QWidget | None, new: QWidget | None) -> None:
        page = self._page()
        if old is None or new is None or page is None or new is page or not isValid(old):
            return
        is_gone = not (old.isEnabled() and old.isVisible())
        if is_gone and self._window.isAncestorOf(old) and self._window.isAncestorOf(new):
            if page.isAncestorOf(old):
                self._gone = old
            page.setFocus()

    def give_back(self) -> None:
        """After a job: to the button that had the focus before, if it can be pressed again."""
        page, gone = self._page(), self._gone
        if page is None or gone is None or not page.hasFocus():
            return
        self._gone = None
        if isValid(gone) and gone.isEnabled() and gone.isVisible():
            gone.setFocus()


def press_by_enter(event: QKeyEvent) -> bool:
    """Press the button that has the focus, if Enter was pressed and nothing took it; return whether so."""
    button = QApplication.focusWidget()
    if event.key() not in _ENTER or event.modifiers() & ~Qt.KeyboardModifier.KeypadModifier:
        return False
    if not isinstance(button, QAbstractButton) or event.isAutoRepeat():
        return False
    button.click()
    return True
