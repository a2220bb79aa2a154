"""Labels that wrap, and texts they show."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication, Qt
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


def duration_text(seconds: float) -> str:
    """Return a time as people say it: 40 s, 14 min, 1 h 20 min."""
    translate = QCoreApplication.translate
    if seconds < 59.5:
        return translate("Duration", "{s} s").format(s=max(round(seconds), 1))
    minutes = round(seconds / 60)
    if minutes < 60:
        return translate("Duration", "{min} min").format(min=minutes)
    return translate("Duration", "{h} h {min} min").format(h=minutes // 60, min=minutes % 60)
