"""What somebody does on the Cell page, and reads there."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QPushButton

from app.gui.pages.cell.step_list import StepRow
from app.operations.calibration.cell_file import new_cell
from app.operations.calibration.steps import enter_board
from core.calibration.board import BoardSpec


def settle(qtbot, desk, page):
    """Wait until nothing is under way and the page shows the chosen cell."""
    qtbot.waitUntil(lambda: desk.jobs.is_idle and desk.background.is_idle)
    qtbot.waitUntil(lambda: page.content is not None and page.content.path == desk.cell.path)


def choose(qtbot, desk, page, path):
    desk.cell.choose(path)
    settle(qtbot, desk, page)


def button(page, name="primary"):
    return page.findChild(QPushButton, name)


def press(qtbot, page, name="primary"):
    assert button(page, name).isEnabled() and button(page, name).isVisible(), name
    qtbot.mouseClick(button(page, name), Qt.MouseButton.LeftButton)


def pick(qtbot, page, step):
    qtbot.mouseClick(page.findChild(StepRow, f"step_{step}"), Qt.MouseButton.LeftButton)


def text(page, name):
    return page.findChild(QLabel, name).text()


def states(page):
    return {line.key: line.state for line in page.side.steps.lines}


def measured_cell(seed=0):
    path = new_cell("bench", is_simulated=True, seed=seed)
    enter_board(path, BoardSpec(), "a4", 0.030)
    return path
