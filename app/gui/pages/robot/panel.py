"""The base of the side's panels: a heading, sentences, and what belongs to one step."""

from __future__ import annotations

from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget

from app.gui.theme import GRID_PX


def label(name: str, role: str = "", text: str = "") -> QLabel:
    """Return a label that breaks its lines."""
    made = QLabel(text)
    made.setObjectName(name)
    made.setWordWrap(True)
    if role:
        made.setProperty("role", role)
    return made


def say(of: QLabel, text: str) -> None:
    """Let a label say something, or be away where there is nothing to say."""
    if text != of.text():
        of.setText(text)
    of.setVisible(bool(text))


class Panel(QWidget):
    """A column that begins with a heading.

    Attributes:
        heading: what the step is.
        column: takes the rest.
    """

    def __init__(self, name: str, heading: str) -> None:
        super().__init__()
        self.setObjectName(name)
        self.heading = label(f"{name}_heading", "verdict", heading)
        self.column = QVBoxLayout(self)
        self.column.setContentsMargins(0, 0, 0, 0)
        self.column.setSpacing(GRID_PX)
        self.column.addWidget(self.heading)
