"""Layouts that several pages share."""

from __future__ import annotations

from PySide6.QtWidgets import QHBoxLayout, QLayout, QVBoxLayout, QWidget

from app.gui.theme import GRID_PX


def row_of(*widgets: QWidget) -> QHBoxLayout:
    """Return a row of widgets, as wide as they are, from the left."""
    row = QHBoxLayout()
    row.setSpacing(GRID_PX)
    for widget in widgets:
        row.addWidget(widget)
    row.addStretch(1)
    return row


def lay_around(view: QWidget, top: QLayout, scene: QWidget, *below: QLayout) -> None:
    """Lay out a view: its 3D scene takes the space that what is above and below it leaves."""
    column = QVBoxLayout(view)
    column.setContentsMargins(0, 0, 0, 0)
    column.setSpacing(0)
    column.addLayout(top)
    column.addWidget(scene, 1)
    for layout in below:
        column.addLayout(layout)
