"""From connecting to the outcome, and back after a stop, by clicks alone; with the simulated controller."""

from __future__ import annotations

import json
import os
import signal
import socket
import time
from dataclasses import replace
from types import SimpleNamespace

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QCheckBox, QLabel, QPushButton

from app.gui.pages.robot.panels import CheckPanel
from app.gui.pages.robot.steps import Step
from core.imagination.amount.result import PlannedAmount
from core.pipeline.session_view import SessionView
from core.session.cups import Cup
from core.session.pour_runs import pour_runs
from hardware.cell.reading import CELL_FOLDER
from hardware.simulation.ur_controller.identity import CONTROL_PORT
from tests.app.gui.pages.robot.presses import CHECKS, hold, pour_until, text, tick_all
from tests.awake import within

pytestmark = [pytest.mark.system, pytest.mark.punctual]

pytest.importorskip("rtde_control")


@pytest.fixture
def ready(page, open_session, mug_session, reach):
    """Connected, with the mug's session open."""
    open_session(mug_session)
    page.side.primary.click()
    reach(Step.PLAN)
    return page


def test_with_a_real_arm_nothing_is_ticked_before_somebody_does(qtbot):
    panel = CheckPanel()
    qtbot.addWidget(panel)
    planned = shown(panel, advice="", is_rehearsal=False)
    boxes = [panel.findChild(QCheckBox, name) for name in CHECKS]
    assert not any(box.isChecked() for box in boxes)
    assert "Tick each point" in panel.reason(planned)
    for box in boxes:
        box.setChecked(True)
    assert panel.reason(planned) == ""


def shown(panel, advice, is_rehearsal, number=1):
    expires_s = time.monotonic() + 60
    planned = SimpleNamespace(number=number, note="", advice=advice, plan=None, expires_s=expires_s)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("app.gui.pages.robot.panels.plan_facts", lambda _: [])
        panel.show_plan(planned, Cup(1, 1, 60, None), is_rehearsal=is_rehearsal)
    return planned


def test_what_is_not_advised_has_to_be_ticked_even_in_a_rehearsal(qtbot):
    panel = CheckPanel()
    qtbot.addWidget(panel)
    planned = shown(panel, advice="", is_rehearsal=True)
    anyway = panel.findChild(QCheckBox, "check_anyway")
    assert panel.reason(planned) == ""
    assert not anyway.isVisibleTo(panel)

    planned = shown(panel, advice="Pouring is not advised: it spills.", is_rehearsal=True, number=2)
    assert text(panel, "pour_advice") == "Pouring is not advised: it spills."
    assert anyway.isVisibleTo(panel)
    assert panel.reason(planned) == "1 more to tick."
    anyway.setChecked(True)
    assert panel.reason(planned) == ""


def test_of_several_cups_the_next_is_named_and_an_emptied_object_begins_with_the_first(ready, monkeypatch):
    panel, button = ready.side.start, ready.findChild(QPushButton, "object_emptied")
    assert not button.isVisibleTo(panel)
    session = ready.desk.workspace.session
    run = session.path / "pours" / "0001"
    run.mkdir(parents=True)
    events = [{"kind": "confirmed", "imagination": session.record("pouring").digest}, {"kind": "done"}]
    (run / "events.jsonl").write_text("".join(json.dumps(event) + "\n" for event in events))
    monkeypatch.setattr(PlannedAmount, "n_per_cup", (30, 30))
    ready.desk.workspace.view = SessionView(session)
    ready.procedure.changed.emit()
    assert "Next is cup 2 of 2, 30 candies in it" in text(ready, "start_text")
    assert button.isVisibleTo(panel)
    button.click()
    assert "Next is" not in text(ready, "start_text")
    assert not button.isVisibleTo(panel)
    assert pour_runs(session.path)[0].was_emptied


def test_from_the_plan_to_the_saved_outcome(ready, qtbot, reach, mug_session):
    page, side = ready, ready.side
    qtbot.waitUntil(lambda: "running" in [label.text() for label in side.state.findChildren(QLabel)])
    side.primary.click()
    reach(Step.CHECK)

    planned = page.procedure.planned
    motion = page.procedure.motion
    assert page.view.timeline.duration_s == pytest.approx(planned.plan.duration_s)
    page.view.timeline.set_time(motion.begins_s[6] + 0.1)
    assert text(page, "plan_now") == "pour: the cup rotates about its rim and pours"
    assert {"path", "pivot"} <= set(page.view.scene.layers())
    free = f"{1000 * planned.plan.clearance_m:.0f} mm, {planned.plan.nearest[0]} to"
    assert any(free in label.text() for label in side.check.findChildren(QLabel))

    button = side.hold_to_pour
    assert button.isEnabled(), "nothing real moves"
    assert "already ticked" in text(page, "rehearsal")
    tick_all(page, is_ticked=False)
    assert not button.isEnabled()
    assert "Tick each point" in text(page, "hold_reason")
    tick_all(page)
    assert button.isEnabled()
    page.procedure.planned = replace(planned, expires_s=0.0)
    page.update_actions()
    assert not button.isEnabled()
    assert "plan again" in text(page, "hold_reason")
    page.procedure.planned = planned
    page.update_actions()

    qtbot.mousePress(button, Qt.MouseButton.LeftButton)
    qtbot.wait(300)
    qtbot.mouseRelease(button, Qt.MouseButton.LeftButton)
    qtbot.wait(100)
    assert page.procedure.step is Step.CHECK, "released too early"
    assert not pour_runs(mug_session)

    hold(qtbot, button)
    assert page.procedure.step is Step.POUR
    assert not button.isVisibleTo(page)
    with qtbot.waitSignal(page.procedure.moved, check_params_cb=lambda told: told.name == "pour"):
        pass
    assert text(page, "live_move") == "pour: the cup rotates about its rim and pours"
    assert "Move 7 of 14" in text(page, "live_left")
    assert not page.view.timeline.isEnabled()
    reach(Step.OUTCOME)

    (run,) = pour_runs(mug_session)
    assert run.is_done
    assert run.outcome.is_simulated
    assert text(page, "spilled") == str(run.outcome.n_spilled)
    assert "SIMULATED" in text(page, "outcome_how")
    side.outcome.findChild(object, "spilled_more").click()
    side.primary.click()
    reach(Step.PLAN)
    kept = json.loads((run.folder / "outcome.json").read_text())
    assert (kept["n_spilled"], kept["is_simulated"]) == (run.outcome.n_spilled + 1, False)
    assert [row.values[2] for row in side.runs.table.rows] == ["poured"]

    side.runs.chosen.emit(run.folder)
    assert page.procedure.step is Step.OUTCOME
    assert "As it was entered" in text(page, "outcome_how")
    tick_all(page, is_ticked=False)
    side.again.click()
    reach(Step.CHECK)
    assert all(page.findChild(QCheckBox, name).isChecked() for name in CHECKS), "another plan, ticked anew"


def test_after_a_stop_the_guide_leads_back_to_a_new_plan(ready, qtbot, reach, mug_session):
    page, side = ready, ready.side
    pour_until(page, qtbot, reach, "carry")
    with qtbot.waitSignal(page.desk.arm.stopped) as stopped:
        page.desk.arm.stop()
    print(f"STOP was taken after {1000 * stopped.args[0].seconds:.1f} ms")
    assert stopped.args[0].seconds < 0.1
    reach(Step.STOPPED)
    assert "Stopped on request" in text(page, "recovery_what")
    assert side.primary.text() == "Make the arm ready"
    assert not side.hold_to_pour.isVisibleTo(page)
    joints_rad = page.desk.arm.status.state.joints_rad.copy()

    side.primary.click()
    reach(Step.PLAN_BACK_OFF)
    assert abs(page.desk.arm.status.state.joints_rad - joints_rad).max() < 1e-3, "it has not moved"
    assert side.primary.text() == "Plan the return"
    kinds = [event["kind"] for event in pour_runs(mug_session)[0].events]
    assert kinds[-2:] == ["stopped", "recovered"]
    side.primary.click()
    reach(Step.CHECK_BACK_OFF)
    assert [move.name for move in page.procedure.motion.moves][-1] == "home"
    assert page.view.timeline.duration_s > 1
    hold(qtbot, side.hold_to_back_off)
    assert page.procedure.step is Step.BACK_OFF
    reach(Step.PLAN)
    assert "Check that the cup stands on its station" in text(page, "start_note")
    assert [row.values[2] for row in side.runs.table.rows] == ["backed off", "stopped"]
    side.primary.click()
    reach(Step.CHECK)


def test_a_killed_process_is_told_and_connecting_again_works(ready, qtbot, reach, mug_session):
    page = ready
    pour_until(page, qtbot, reach, "lay")
    os.kill(page.desk.arm_host.pid, signal.SIGKILL)
    reach(Step.CONNECT)
    with within(2.0):
        qtbot.waitUntil(lambda: "ended unexpectedly" in text(page, "start_note"))
    assert not page.side.state.isVisibleTo(page)
    assert "Not connected" in text(page, "arm_caption")
    page.side.primary.click()
    reach(Step.PLAN)
    assert text(page, "start_note") == ""
    (run,) = pour_runs(mug_session)
    assert "ended while the arm moved" in run.sentence


def test_where_there_is_no_way_back_one_reconnects(ready, qtbot, reach):
    page, side = ready, ready.side
    pour_until(page, qtbot, reach, "to the cup")
    address = page.desk.arm.connected.stop_address
    with socket.create_connection((address, CONTROL_PORT), 5) as controller:
        controller.sendall(b"kill\n")
    reach(Step.STOPPED)
    assert page.procedure.stopped
    side.primary.click()
    qtbot.waitUntil(lambda: bool(page.procedure.failure))
    link = side.findChild(object, "by_hand")
    assert link.isVisibleTo(page)
    link.click()
    reach(Step.PLAN)


@pytest.fixture
def cell_of_nobody(tmp_path):
    """A real cell whose controller is switched off."""
    text = (CELL_FOLDER / "ur5_example.toml").read_text()
    path = tmp_path / "nobody.toml"
    path.write_text(text.replace("192.168.0.10", "127.9.9.9"))
    return path


def test_at_rest_stop_gripper_and_other_cells(ready, qtbot, reach, cell_of_nobody):
    page, side = ready, ready.side
    page.desk.arm.stop()
    reach(Step.STOPPED)
    assert not side.findChild(object, "guide_3").isVisibleTo(page), "nothing has to come back"
    side.primary.click()
    reach(Step.PLAN)

    side.findChild(object, "gripper_by_hand").click()
    button = side.findChild(object, "hold_gripper")
    assert button.text() == "Hold to close the gripper"
    hold(qtbot, button)
    qtbot.waitUntil(lambda: button.text() == "Hold to open the gripper")
    reach(Step.PLAN)
    qtbot.waitUntil(lambda: "The gripper is closed" in text(page, "start_note"))
    assert not side.primary.isEnabled()
    hold(qtbot, button)
    qtbot.waitUntil(lambda: text(page, "start_note") == "")
    reach(Step.PLAN)

    page.desk.cell.choose(None)
    reach(Step.CONNECT)
    side.primary.click()
    reach(Step.PLAN)
    side.findChild(object, "disconnect").click()
    reach(Step.CONNECT)
    assert text(page, "start_note") == ""

    page.desk.cell.choose(cell_of_nobody)
    reach(Step.CONNECT)
    assert "127.9.9.9" in text(page, "start_text")
    side.primary.click()
    reach(Step.CONNECT)
    assert "Nobody answers at 127.9.9.9" in text(page, "start_failure")
