"""STOP: red, large, always there."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication, QEvent, QObject, Qt
from PySide6.QtGui import QKeyEvent, QKeySequence, QShortcut, QWindow
from PySide6.QtWidgets import QPushButton, QWidget
from typing_extensions import override

KEYS = ("F12", "Pause")
_KEY_CODES = (Qt.Key.Key_F12, Qt.Key.Key_Pause)


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
        application = QCoreApplication.instance()
        if application is not None:
            application.installEventFilter(self)

    @override
    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Shortcuts sleep while a dialog is open; a stop must not. Each key comes to one window once."""
        if not isinstance(event, QKeyEvent) or not isinstance(watched, QWindow):
            return False
        if event.type() != QEvent.Type.KeyPress or event.key() not in _KEY_CODES:
            return False
        if not event.isAutoRepeat():
            self.pressed.emit()
        return True
