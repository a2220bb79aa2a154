"""A simulated cell for tests that are not about the number of views."""

from __future__ import annotations

from pathlib import Path

from hardware.cell import SIMULATED_CELL, CellSettings, read_cell


def quick_cell(path: Path = SIMULATED_CELL) -> CellSettings:
    """Read a cell; the shipped one has a quarter of its views."""
    settings = read_cell(path)
    if path != SIMULATED_CELL:
        return settings
    few = settings.scan.model_copy(update={"views_rad": settings.scan.views_rad[::4]})
    return settings.model_copy(update={"scan": few})
