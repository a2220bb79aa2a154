"""A program that was killed with the cup in the hand: the next window finds the way back, by clicks alone."""

from __future__ import annotations

import os
import signal

import pytest

from app.gui.pages.robot.steps import Step
from core.session.pour_runs import pour_runs
from hardware.cell import SIMULATED_CELL, read_cell
from hardware.simulation.ur_controller.process import ControllerProcess
from tests.app.gui.pages.robot.presses import hold, pour_until, press, text, tick_all

pytestmark = [pytest.mark.system, pytest.mark.punctual]

pytest.importorskip("rtde_control")


@pytest.fixture
def rehearsal(tmp_path):
    """A cell whose arm is a controller that outlives whoever drives it."""
    home_rad = read_cell(SIMULATED_CELL).robot.home_rad
    with ControllerProcess(joints_rad=home_rad, speed_up=3.0) as controller:
        head, camera, robot, hand = SIMULATED_CELL.read_text().split('kind = "simulated"')
        driven = f'kind = "ur5"\naddress = "{controller.address}"'
        path = tmp_path / "rehearsal.toml"
        path.write_text(
            f'is_rehearsal = true\n{head}kind = "simulated"{camera}{driven}{robot}kind = "ur5"{hand}'
        )
        yield path


def test_the_way_back_after_a_restart_with_a_closed_gripper(
    page, open_session, qtbot, reach, mug_session, rehearsal
):
    side, start = page.side, page.side.primary
    open_session(mug_session)
    page.desk.cell.choose(rehearsal)
    reach(Step.CONNECT)
    press(qtbot, start)
    reach(Step.PLAN)
    pour_until(page, qtbot, reach, "carry")
    os.kill(page.desk.arm_host.pid, signal.SIGKILL)
    reach(Step.CONNECT)

    press(qtbot, start)
    reach(Step.PLAN)
    qtbot.waitUntil(lambda: start.text() == "Find the way back")
    assert "its cup may be in the hand" in text(page, "start_text")
    assert side.findChild(object, "hold_gripper").isVisibleTo(page), "or somebody takes the cup"
    press(qtbot, start)
    reach(Step.PLAN_BACK_OFF)
    assert "The arm is on the path of run 0001" in text(page, "recovery_failure")
    press(qtbot, start)
    reach(Step.CHECK_BACK_OFF)
    hold(qtbot, side.hold_to_back_off)
    reach(Step.PLAN)
    assert "Check that the cup stands on its station" in text(page, "start_note")
    assert start.text() == "Plan"

    press(qtbot, start)
    reach(Step.CHECK)
    tick_all(page)
    hold(qtbot, side.hold_to_pour)
    reach(Step.OUTCOME)
    runs = pour_runs(mug_session)
    assert [run.is_done for run in runs] == [False, True, True]
    assert runs[2].outcome is not None
