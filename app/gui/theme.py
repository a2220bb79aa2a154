"""Colours and sizes, light and dark. Red belongs to STOP alone; nothing is told by colour only."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QWidget

GRID_PX = 8
"""Distances are multiples of it."""


@dataclass(frozen=True)
class Theme:
    """Named colours, `#rrggbb`.

    Attributes:
        name: `light` or `dark`.
        window: behind everything.
        surface: of panels and inputs.
        raised: of buttons, headers and chips.
        line: between things.
        text: to read.
        muted: to read second.
        accent: the one colour that says "here": primary buttons, selection, progress.
        on_accent: text on it.
        good: a state that is as it should be.
        attention: something to look at: stale, poor, a warning, a real cell.
        failed: something went wrong; no red, which is STOP's.
        simulated: the simulated cell's chip.
        stop: STOP, and nothing else.
        kept: candies that stayed.
        lost: candies that did not.
        scene: background of 3D views.
        body: of the object in 3D.
        arm: of the arm in 3D.
        ghost: of the planned arm in 3D.
    """

    name: str
    window: str
    surface: str
    raised: str
    line: str
    text: str
    muted: str
    accent: str
    on_accent: str
    good: str
    attention: str
    failed: str
    simulated: str
    stop: str
    kept: str
    lost: str
    scene: str
    body: str
    arm: str
    ghost: str

    def color(self, name: str) -> QColor:
        """Return a named colour for painting."""
        return QColor(getattr(self, name))

    @property
    def is_dark(self) -> bool:
        """Whether light text stands on dark."""
        return self.name == "dark"


LIGHT = Theme(
    name="light",
    window="#f3f4f6",
    surface="#ffffff",
    raised="#e7e9ed",
    line="#cfd3da",
    text="#1b1f26",
    muted="#596273",
    accent="#0b6e75",
    on_accent="#ffffff",
    good="#2f7d4f",
    attention="#9a5b00",
    failed="#8b3a86",
    simulated="#1f5fbf",
    stop="#d0021b",
    kept="#1f6fd0",
    lost="#d98a00",
    scene="#e9ebef",
    body="#b9bfc9",
    arm="#8d97a6",
    ghost="#0b8a92",
)
DARK = Theme(
    name="dark",
    window="#16191e",
    surface="#1e2229",
    raised="#2a2f38",
    line="#3b424e",
    text="#e8ebf0",
    muted="#a0a9b8",
    accent="#3fb6bd",
    on_accent="#0c1416",
    good="#6fc792",
    attention="#f0b04a",
    failed="#d78ad2",
    simulated="#7fb0ff",
    stop="#e5152e",
    kept="#5aa2f5",
    lost="#f2ae3d",
    scene="#12151a",
    body="#aab1bd",
    arm="#7f8998",
    ghost="#4fd0d8",
)
THEMES = {theme.name: theme for theme in (LIGHT, DARK)}


def theme_of(widget: QWidget) -> Theme:
    """Return the theme a widget is shown in; ask again on `QEvent.Type.PaletteChange`."""
    window = widget.palette().color(QPalette.ColorRole.Window)
    return DARK if window.lightnessF() < 0.5 else LIGHT
