"""A row of buttons of which exactly one is down."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QButtonGroup, QHBoxLayout, QPushButton, QWidget

from app.gui.theme import GRID_PX


class ModeRow(QWidget):
    """Chooses what is shown.

    Signals: `chosen` with the mode's key when another one is, by the user or the program.
    """

    chosen = Signal(str)

    def __init__(self, name: str, parent: QWidget | None = None) -> None:
        """Make an empty row called `name`; its buttons are called `<name>_<key>`."""
        super().__init__(parent)
        self.setObjectName(name)
        self._buttons: dict[str, QPushButton] = {}
        self._mode = ""
        self._group = QButtonGroup(self)
        self._row = QHBoxLayout(self)
        self._row.setContentsMargins(0, 0, 0, 0)
        self._row.setSpacing(GRID_PX // 2)

    def add(self, key: str, text: str, tip: str) -> None:
        """Add a mode; the first one is chosen."""
        button = QPushButton(text)
        button.setObjectName(f"{self.objectName()}_{key}")
        button.setCheckable(True)
        button.setToolTip(tip)
        button.setAccessibleDescription(tip)
        button.clicked.connect(lambda: self.choose(key))
        self._group.addButton(button)
        self._row.addWidget(button)
        self._buttons[key] = button
        if not self._mode:
            self._mode = key
            button.setChecked(True)

    @property
    def mode(self) -> str:
        """Key of the one that is down."""
        return self._mode

    def choose(self, key: str) -> None:
        """Choose a mode."""
        self._buttons[key].setChecked(True)
        if key != self._mode:
            self._mode = key
            self.chosen.emit(key)

    def set_text(self, key: str, text: str) -> None:
        """Change what a button says."""
        self._buttons[key].setText(text)

    def set_enabled(self, key: str, is_enabled: bool) -> None:
        """Let a mode be chosen or not; it stays the one that is down."""
        self._buttons[key].setEnabled(is_enabled)

    def set_available(self, key: str, is_available: bool, tip: str) -> None:
        """Let a mode be chosen or not, and say why; the first one takes the place of one that went."""
        self._buttons[key].setEnabled(is_available)
        self._buttons[key].setToolTip(tip)
        if not is_available and key == self._mode:
            self.choose(next(iter(self._buttons)))
