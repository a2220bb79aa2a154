"""The base of the side's panels: a heading, sentences, and what belongs to one step."""

from __future__ import annotations

from PySide6.QtWidgets import QVBoxLayout, QWidget

from app.gui.theme import GRID_PX
from app.gui.views.labels import text_label


class Panel(QWidget):
    """A column that begins with a heading.

    Attributes:
        heading: what the step is.
        column: takes the rest.
    """

    def __init__(self, name: str, heading: str) -> None:
        super().__init__()
        self.setObjectName(name)
        self.heading = text_label(f"{name}_heading", "verdict", heading)
        self.column = QVBoxLayout(self)
        self.column.setContentsMargins(0, 0, 0, 0)
        self.column.setSpacing(GRID_PX)
        self.column.addWidget(self.heading)
