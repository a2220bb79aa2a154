"""Asking what something is to be called."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QCoreApplication
from PySide6.QtWidgets import QInputDialog, QWidget


def ask_name(parent: QWidget, name: str, then: Callable[[str], None]) -> None:
    """Ask what a session is to be called; nothing happens if the dialog is cancelled."""
    dialog = QInputDialog(parent)
    dialog.setObjectName("rename_dialog")
    dialog.setWindowTitle(QCoreApplication.translate("History", "Rename the session"))
    dialog.setLabelText(QCoreApplication.translate("History", "Name"))
    dialog.setTextValue(name)
    dialog.textValueSelected.connect(then)
    dialog.finished.connect(dialog.deleteLater)
    dialog.open()
