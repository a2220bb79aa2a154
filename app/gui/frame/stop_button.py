"""STOP: red, large, always there."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtGui import QKeySequence, QShortcut
from PySide6.QtWidgets import QPushButton, QWidget

KEYS = ("F12", "Pause")


class StopButton(QPushButton):
    """Acts when it is pressed, not when it is released; so do its keys, wherever the focus is."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.setObjectName("stop")
        self.setText(self.tr("STOP"))
        self.setAccessibleName(self.tr("Stop the arm"))
        self.setToolTip(
            self.tr(
                "Stops the arm and the work with it, at once (keys: {keys}). A software stop, not "
                "safety-rated: in danger press the emergency stop at the arm."
            ).format(keys=", ".join(KEYS))
        )
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        for key in KEYS:
            shortcut = QShortcut(QKeySequence(key), window)
            shortcut.setContext(Qt.ShortcutContext.ApplicationShortcut)
            shortcut.activated.connect(self.pressed)
