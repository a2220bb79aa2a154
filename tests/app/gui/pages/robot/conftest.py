"""A robot page, and a simulated cell that hurries."""

from __future__ import annotations

import time

import pytest

from app.gui.pages.robot.page import RobotPage
from hardware.cell import SIMULATED_CELL

NEWS_S = 30.0
"""Longer than any news takes to come while no job runs: after it a step is not reached any more."""


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
        idle_since_s = None

        def is_there():
            nonlocal idle_since_s
            procedure, now_s = page.procedure, time.monotonic()
            is_idle = page.desk.jobs.is_idle and page.desk.background.is_idle
            idle_since_s = (idle_since_s or now_s) if is_idle else None
            if is_idle and procedure.step is step:
                return True
            if is_idle and now_s - idle_since_s > NEWS_S:
                pytest.fail(
                    f"{procedure.step} in place of {step}: {procedure.failure} {procedure.stopped} "
                    f"{page.desk.arm.farewell}"
                )
            return False

        qtbot.waitUntil(is_there)

    return reach_
