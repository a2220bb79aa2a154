"""Labels that wrap."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFrame, QLabel


def text_label(name: str, role: str = "", text: str = "") -> QLabel:
    """Return a label that wraps and whose text can be copied; `role` is one of the palette's."""
    label = QLabel(text)
    label.setObjectName(name)
    label.setWordWrap(True)
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    if role:
        label.setProperty("role", role)
    return label


def heading(text: str) -> QLabel:
    """Return a heading."""
    label = QLabel(text)
    label.setProperty("role", "heading")
    return label


def rule() -> QFrame:
    """Return a thin line between things."""
    line = QFrame()
    line.setProperty("role", "line")
    return line


def say(label: QLabel, text: str) -> None:
    """Show a text, or nothing at all."""
    if text != label.text():
        label.setText(text)
    label.setVisible(bool(text))
