"""A robot page, and a simulated cell that hurries."""

from __future__ import annotations

import pytest

from app.gui.pages.robot.page import RobotPage
from hardware.cell import SIMULATED_CELL


@pytest.fixture
def hurried_cell(tmp_path):
    """The simulated cell, twice as fast as it is shipped."""
    text = SIMULATED_CELL.read_text()
    assert "speed_up = 4.0" in text
    path = tmp_path / "cell.toml"
    path.write_text(text.replace("speed_up = 4.0", "speed_up = 8.0"))
    return path


@pytest.fixture
def page(desk, qtbot, hurried_cell):
    """Shown, with the cell read."""
    page = RobotPage(desk)
    qtbot.addWidget(page)
    page.resize(1060, 640)
    page.show()
    desk.cell.choose(hurried_cell)
    qtbot.waitUntil(lambda: desk.background.is_idle)
    return page


@pytest.fixture
def open_session(page, qtbot):
    """Opens a session and waits until it is shown."""

    def open_(folder):
        page.desk.workspace.open(folder)
        qtbot.waitUntil(lambda: page.desk.background.is_idle)

    return open_


@pytest.fixture
def reach(page, qtbot):
    """Waits until a step is reached and nothing is under way."""

    def reach_(step):
        def is_there():
            is_idle = page.desk.jobs.is_idle and page.desk.background.is_idle
            procedure = page.procedure
            assert procedure.step is step and is_idle, (
                f"{procedure.step}: {procedure.failure} {procedure.stopped}"
            )

        qtbot.waitUntil(is_there)

    return reach_
