"""The menus: everything that has a key is here, so that it can be found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from PySide6.QtGui import QAction, QActionGroup, QKeySequence, QUndoStack
from PySide6.QtWidgets import QMenu, QMenuBar

from app.gui.pages.registry import OTHERS, WORK, tab_facts


@dataclass(frozen=True)
class MenuWishes:
    """What the menus let the window do."""

    new_session: Callable[[], None]
    open_session: Callable[[], None]
    close_session: Callable[[], None]
    write_report: Callable[[], None]
    show_page: Callable[[str], None]
    toggle_log: Callable[[], None]
    use_theme: Callable[[str], None]
    reset_layout: Callable[[], None]
    use_simulated_cell: Callable[[], None]
    open_cell: Callable[[], None]
    show_keys: Callable[[], None]
    show_about: Callable[[], None]
    quit: Callable[[], None]


class Menus(QMenuBar):
    """The menu bar.

    Attributes:
        session_actions: that need an open session.
    """

    def __init__(self, wishes: MenuWishes, undo_stack: QUndoStack, theme: str) -> None:
        super().__init__()
        self.session_actions: list[QAction] = []
        self._session(wishes)
        self._edit(undo_stack)
        self._view(wishes, theme)
        self._cell(wishes)
        self._help(wishes)

    def _session(self, wishes: MenuWishes) -> None:
        menu = self.addMenu(self.tr("&Session"))
        _add(menu, self.tr("&New…"), "Ctrl+N", wishes.new_session)
        _add(menu, self.tr("&Open…"), "Ctrl+O", wishes.open_session)
        report = _add(menu, self.tr("Write &report"), "Ctrl+R", wishes.write_report)
        close = _add(menu, self.tr("&Close session"), "Ctrl+W", wishes.close_session)
        self.session_actions = [report, close]
        menu.addSeparator()
        _add(menu, self.tr("&Quit"), "Ctrl+Q", wishes.quit)

    def _edit(self, undo_stack: QUndoStack) -> None:
        menu = self.addMenu(self.tr("&Edit"))
        undo = undo_stack.createUndoAction(menu, self.tr("Undo"))
        undo.setShortcut(QKeySequence("Ctrl+Z"))
        redo = undo_stack.createRedoAction(menu, self.tr("Redo"))
        redo.setShortcut(QKeySequence("Ctrl+Shift+Z"))
        menu.addActions([undo, redo])

    def _view(self, wishes: MenuWishes, theme: str) -> None:
        menu = self.addMenu(self.tr("&View"))
        for number, key in enumerate((*WORK, *OTHERS), 1):
            _add(menu, tab_facts(key).title, f"Ctrl+{number}", partial(wishes.show_page, key))
        menu.addSeparator()
        _add(menu, self.tr("&Log"), "Ctrl+L", wishes.toggle_log)
        themes = menu.addMenu(self.tr("&Theme"))
        group = QActionGroup(self)
        names = {"system": self.tr("Like the system"), "light": self.tr("Light"), "dark": self.tr("Dark")}
        for name, text in names.items():
            action = _add(themes, text, "", partial(wishes.use_theme, name))
            action.setCheckable(True)
            action.setChecked(name == theme)
            group.addAction(action)
        _add(menu, self.tr("&Reset layout"), "", wishes.reset_layout)

    def _cell(self, wishes: MenuWishes) -> None:
        menu = self.addMenu(self.tr("&Cell"))
        _add(menu, self.tr("&Simulated cell"), "", wishes.use_simulated_cell)
        _add(menu, self.tr("&Open a cell file…"), "", wishes.open_cell)

    def _help(self, wishes: MenuWishes) -> None:
        menu = self.addMenu(self.tr("&Help"))
        _add(menu, self.tr("&Keys"), "F1", wishes.show_keys)
        _add(menu, self.tr("&About"), "", wishes.show_about)


def _add(menu: QMenu, text: str, key: str, do: Callable[[], None]) -> QAction:
    action = menu.addAction(text)
    if key:
        action.setShortcut(QKeySequence(key))
    action.triggered.connect(lambda _checked=False: do())
    return action
