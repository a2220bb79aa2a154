"""A box for one of three numbers beside a title."""

from __future__ import annotations

from PySide6.QtWidgets import QAbstractSpinBox, QDoubleSpinBox

_WIDTH_PX = 62
"""Three of them beside a title are as wide as the panel."""


def number_box(name: str, least: float, most: float, decimals: int = 1) -> QDoubleSpinBox:
    """Return a narrow box without buttons."""
    box = QDoubleSpinBox()
    box.setObjectName(name)
    box.setButtonSymbols(QAbstractSpinBox.ButtonSymbols.NoButtons)
    box.setFixedWidth(_WIDTH_PX)
    box.setRange(least, most)
    box.setDecimals(decimals)
    return box
