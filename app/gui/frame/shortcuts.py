"""The overview of all keys, gathered from the menus, so that it cannot be outdated."""

from __future__ import annotations

from PySide6.QtGui import QAction
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QGridLayout, QLabel, QMenuBar, QVBoxLayout, QWidget

from app.gui.frame.stop_button import KEYS
from app.gui.theme import GRID_PX


def actions_with_keys(menus: QMenuBar) -> list[tuple[str, str]]:
    """Return what can be done from the menus, and its key, both for people."""
    found: list[tuple[str, str]] = []
    for menu in menus.actions():
        submenu = menu.menu()
        actions: list[QAction] = submenu.actions() if submenu is not None else []  # type: ignore[attr-defined]
        found += [
            (action.text().replace("&", ""), action.shortcut().toString())
            for action in actions
            if not action.shortcut().isEmpty()
        ]
    return found


class ShortcutOverview(QDialog):
    """Keys and what they do."""

    def __init__(self, menus: QMenuBar, parent: QWidget) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Keys"))
        rows = [(self.tr("STOP the arm"), ", ".join(KEYS)), *actions_with_keys(menus)]
        rows += [
            (self.tr("Play or pause a replay"), self.tr("Space")),
            (self.tr("Step in a replay, or to the next pour"), self.tr("Arrow keys")),
            (self.tr("Hold to pour"), self.tr("Space or Enter, held")),
        ]
        grid = QGridLayout()
        grid.setHorizontalSpacing(4 * GRID_PX)
        for k, (what, keys) in enumerate(rows):
            grid.addWidget(QLabel(what), k, 0)
            key = QLabel(keys)
            key.setProperty("role", "heading")
            grid.addWidget(key, k, 1)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.setContentsMargins(3 * GRID_PX, 2 * GRID_PX, 3 * GRID_PX, 2 * GRID_PX)
        column.setSpacing(2 * GRID_PX)
        column.addLayout(grid)
        column.addWidget(buttons)
