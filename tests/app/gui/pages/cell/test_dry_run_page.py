"""A dry run from the Cell page."""

from __future__ import annotations

import pytest

from app.operations.calibration.cell_file import new_cell
from app.operations.calibration.cup import enter_cup
from app.operations.calibration.cup_entry import entry_of
from core.progress import Reporter
from hardware.cell import read_cell
from tests.app.gui.pages.cell.acting import choose, pick, press, settle, states, text

LEAST_MOVED_RAD = 0.5
"""The base alone turns by more between cup and platform."""


@pytest.mark.system
@pytest.mark.punctual
def test_a_dry_run_goes_through_a_pour_and_the_arm_is_shown(qtbot, desk, page):
    path = new_cell("bench", is_simulated=True)
    enter_cup(path, entry_of(read_cell(path)), Reporter())
    choose(qtbot, desk, page, path)
    pick(qtbot, page, "dry-run")
    seen, failed = [], []
    desk.arm.changed.connect(lambda: seen.append(desk.arm.status))
    desk.jobs.failed.connect(lambda job, what: failed.append(str(what)))
    press(qtbot, page)
    assert states(page)["dry-run"] == "running"
    assert text(page, "headline") == "The arm goes through a pour with an empty cup …"
    qtbot.waitUntil(lambda: desk.jobs.is_idle)
    settle(qtbot, desk, page)
    assert not failed and states(page)["dry-run"] == "fresh"
    assert "at 30% of the speed" in page.side.steps.lines[-1].figure
    joints = [one.state.joints_rad for one in seen if one is not None and one.state is not None]
    assert max(abs(one - joints[0]).max() for one in joints) > LEAST_MOVED_RAD
