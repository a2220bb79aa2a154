"""From nothing to a pour in the window: a simulated cell is made, set up and rehearsed, and its arm pours."""

from __future__ import annotations

import pytest
from PySide6.QtWidgets import QAbstractButton, QWidget

from app.gui.headless_check import HOLD_S, Walk
from app.gui.main import open_window
from app.library.places import SESSIONS_VARIABLE
from app.operations.calibration.steps import StepState, steps
from core.session.pour_runs import pour_runs
from tests.patience import HANG_S

MOST_CLICKS = 20


@pytest.mark.system
@pytest.mark.punctual
def test_a_stranger_gets_from_a_new_simulated_cell_to_a_pour_in_twenty_clicks(
    qapp, forgetful, tmp_path, monkeypatch
):
    for name in ("POURSIGHT_CELLS", SESSIONS_VARIABLE, "XDG_CONFIG_HOME"):
        monkeypatch.setenv(name, str(tmp_path / name))
    window = open_window(qapp)
    walk, desk = Walk(window), window.desk
    ready = []
    window.ready.connect(lambda: ready.append(True))
    try:
        walk.wait(lambda: ready, "the window is ready", HANG_S)
        walk.click("tab_cell")
        walk.click("primary")
        walk.wait(lambda: desk.cell.path is not None, "the cell is made", HANG_S)
        path = desk.cell.path
        for k, step in enumerate(steps(path)):
            walk.wait(lambda: desk.jobs.is_idle and desk.background.is_idle, "the page is read", HANG_S)
            walk.click("primary", within_s=HANG_S)
            walk.wait(lambda k=k: steps(path)[k].state is StepState.DONE, step.name, HANG_S)
        walk.wait_for_work("the last step is told", HANG_S)
        walk.wait(lambda: desk.background.is_idle, "the page is read", HANG_S)
        walk.click("primary")
        walk.wait(lambda: window.shown == "scan", "the page of the scan is shown", HANG_S)
        walk.click("primary", within_s=HANG_S)
        walk.wait(lambda: desk.workspace.is_fresh("collision"), "the object is scanned", HANG_S)
        walk.wait(lambda: desk.workspace.is_fresh("risk"), "pours are imagined", HANG_S)
        walk.wait_for_work("the imagination ends", HANG_S)
        walk.click("next")
        walk.wait(lambda: window.shown == "pours", "the pours are shown", HANG_S)
        walk.wait_for_work("the arm's motions are checked", HANG_S)
        walk.click("next")
        walk.wait(lambda: walk.shown(QWidget, "hold_to_pour"), "the pour is planned", HANG_S)
        walk.hold("hold_to_pour", HOLD_S)
        walk.wait_for_work("the arm pours", HANG_S)
        [run] = pour_runs(desk.workspace.folder)
        assert run.is_done
        assert walk.clicks <= MOST_CLICKS, f"{walk.clicks} clicks"
        walk.wait(lambda: walk.shown(QAbstractButton, "primary"), "the outcome can be recorded", HANG_S)
    finally:
        window.close_without_asking()
