"""Labels that wrap, and texts they show."""

from __future__ import annotations

import re
from pathlib import Path

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


_FRAME = re.compile(r"(?<![/\\\w])(?:[Vv]iew )?frame-(\d+)(?!\.?\w|-)")
"""A frame's name in a sentence; not as part of a path."""


def view_number(frame: str) -> str:
    """Return a view's number by its frame's name, 4 for `frame-000003`; the name if it has no number."""
    digits = frame.rpartition("-")[2]
    return str(int(digits) + 1) if digits.isdecimal() else frame  # people count from one


def view_title(frame: str) -> str:
    """Return what people call a view, by its frame's name."""
    return QCoreApplication.translate("View", "View {number}").format(number=view_number(frame))


def with_view_numbers(sentence: str) -> str:
    """Return a sentence that names frames, with the views' numbers instead."""
    return _FRAME.sub(lambda found: view_title(found[0]), sentence)


def place_text(folder: Path) -> str:
    """Return where a folder is, from the home folder on if it lies there."""
    home = Path.home()
    return str(Path("~") / folder.relative_to(home)) if folder.is_relative_to(home) else str(folder)
