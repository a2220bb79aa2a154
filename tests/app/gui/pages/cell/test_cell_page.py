"""The Cell page: a cell is made, set up step by step, undone, and its steps say how far it is."""

from __future__ import annotations

import os
import signal

import numpy as np
import pytest
from PySide6.QtWidgets import QAbstractSpinBox, QComboBox, QDoubleSpinBox, QLabel, QSpinBox

from app.gui.pages.cell.step_list import StepLine, StepRow
from app.gui.views.depth_image import DepthPanel
from app.jobs.cell_events import CameraSeen
from app.jobs.scan_events import ScanQuestion
from app.operations.calibration import step_names
from app.operations.calibration.cell_file import new_cell
from app.operations.calibration.check import check_cell
from app.operations.calibration.cup_entry import entry_of
from app.operations.calibration.hand_eye import calibrate_cell
from app.operations.calibration.provenance import read_looks, runs
from core.progress import Reporter
from hardware.cell import read_cell
from tests.app.gui.pages.cell.acting import (
    button,
    choose,
    measured_cell,
    pick,
    press,
    settle,
    states,
    text,
)

STEPS = ["arm", "camera", "board", "hand-eye", "check", "table", "views", "reference", "cup", "dry-run"]
N_VIEWS = 8
PAUSE_MS = 3000


def test_of_the_shipped_cell_nothing_is_changed_but_a_new_one_is_offered(qtbot, desk, page, cells):
    assert button(page).text() == "Create the cell"
    assert not page.side.steps.isVisible()
    press(qtbot, page)
    qtbot.waitUntil(lambda: desk.cell.path == cells / "my-cell.toml")
    settle(qtbot, desk, page)
    assert list(states(page)) == STEPS and set(states(page).values()) == {"empty"}
    assert button(page).text() == "Find the arm"
    assert text(page, "headline").startswith("Next: Arm.")
    assert not button(page, "undo").isVisible()


def test_a_real_cell_needs_an_address(qtbot, desk, page, cells):
    kind = page.findChild(QComboBox, "cell_kind")
    kind.setCurrentIndex(1)
    assert not button(page).isEnabled()
    page.side.form._address.setText("192.168.0.7")
    press(qtbot, page)
    qtbot.waitUntil(lambda: desk.cell.path is not None)
    settle(qtbot, desk, page)
    assert read_cell(desk.cell.path).robot.address == "192.168.0.7"
    pick(qtbot, page, "board")
    assert "glue it flat" in text(page, "step_what")


def test_a_name_that_is_taken_is_said_and_the_form_stays(qtbot, desk, page):
    new_cell("my cell", is_simulated=True)
    said = []
    desk.background.failed.connect(said.append)
    press(qtbot, page)
    qtbot.waitUntil(lambda: bool(said))
    assert "already" in said[0]
    assert page.is_new and button(page).isEnabled()


def test_a_step_waits_for_the_one_before_it(qtbot, desk, page):
    choose(qtbot, desk, page, new_cell("bench", is_simulated=True))
    pick(qtbot, page, "hand-eye")
    assert text(page, "obstacle") == "First comes the step “Calibration board”."
    assert not button(page).isEnabled()
    pick(qtbot, page, "views")
    assert not page.findChild(QLabel, "obstacle").isVisible()
    assert button(page).isEnabled()


def test_the_board_is_printed_measured_and_undone(qtbot, desk, page, monkeypatch):
    opened = []
    monkeypatch.setattr("app.gui.pages.cell.page._open", opened.append)
    path = new_cell("bench", is_simulated=True)
    choose(qtbot, desk, page, path)
    pick(qtbot, page, "board")
    press(qtbot, page, "print_board")
    qtbot.waitUntil(lambda: bool(opened))
    assert opened[0].read_bytes().startswith(b"%PDF")
    settle(qtbot, desk, page)
    assert states(page)["board"] == "empty"
    page.side.options._side.setValue(29.85)
    press(qtbot, page)
    qtbot.waitUntil(lambda: states(page)["board"] == "fresh")
    assert "29.85 mm" in page.side.steps.lines[2].figure
    pick(qtbot, page, "board")
    press(qtbot, page, "undo")
    qtbot.waitUntil(lambda: states(page)["board"] == "empty")


def test_a_board_that_cannot_be_is_refused_with_its_reason(qtbot, desk, page):
    choose(qtbot, desk, page, new_cell("bench", is_simulated=True))
    pick(qtbot, page, "board")
    page.findChild(QSpinBox, "board_columns").setValue(20)
    page.findChild(QSpinBox, "board_rows").setValue(20)
    said = []
    desk.message.connect(said.append)
    press(qtbot, page)
    assert len(said) == 1 and "4X4_50" in said[0]


def test_steps_of_another_cell_are_never_shown_as_those_of_the_chosen_one(qtbot, desk, page):
    choose(qtbot, desk, page, measured_cell())
    assert states(page)["board"] == "fresh"
    desk.cell.choose(new_cell("other", is_simulated=True))
    qtbot.waitUntil(lambda: desk.cell.path.stem == "other")
    assert page.step == "" or page.content.path == desk.cell.path
    settle(qtbot, desk, page)
    assert states(page)["board"] == "empty"


def test_a_damaged_record_is_said_instead_of_the_steps(qtbot, desk, page, cells):
    path = measured_cell()
    (cells / "bench.calibration" / "board.json").write_text("{")
    desk.cell.choose(path)
    qtbot.waitUntil(lambda: desk.cell.path == path and desk.background.is_idle and bool(page.failure))
    assert text(page, "headline") == "The cell cannot be shown."
    assert "board.json" in text(page, "details")
    assert not button(page).isEnabled()


def test_a_cup_is_entered_refused_with_the_reason_and_undone(qtbot, desk, page):
    path = new_cell("bench", is_simulated=True)
    choose(qtbot, desk, page, path)
    pick(qtbot, page, "dry-run")
    assert text(page, "obstacle") == "First comes the step “Cup and station”."
    pick(qtbot, page, "cup")
    form = page.side.options.cup
    assert form.entry == entry_of(read_cell(path)), "nothing was changed yet"
    assert not form.read.isVisible(), "nobody guides a simulated arm"
    failed = []
    desk.jobs.failed.connect(lambda job, what: failed.append(str(what)))
    page.findChild(QDoubleSpinBox, "station_x").setValue(900.0)
    page.findChild(QDoubleSpinBox, "cup_length").setValue(95.0)
    press(qtbot, page)
    qtbot.waitUntil(lambda: bool(failed))
    assert "cannot pour from any side" in failed[0]
    settle(qtbot, desk, page)
    assert read_cell(path).cup is None
    pick(qtbot, page, "cup")
    page.findChild(QDoubleSpinBox, "station_x").setValue(-490.0)
    press(qtbot, page)
    qtbot.waitUntil(lambda: states(page)["cup"] == "fresh")
    settle(qtbot, desk, page)
    assert read_cell(path).cup.length_m == pytest.approx(0.095)
    assert read_cell(path).place.cup_station_m[0] == pytest.approx(-0.49)
    pick(qtbot, page, "cup")
    assert "of 8 sides" in text(page, "step_figure")
    press(qtbot, page, "undo")
    qtbot.waitUntil(lambda: states(page)["cup"] == "empty")
    assert read_cell(path).cup is None


@pytest.mark.system
def test_a_cell_is_calibrated_killed_continued_checked_and_undone(qtbot, desk, page):
    path = measured_cell(seed=7)
    before = read_cell(path).camera.pose
    choose(qtbot, desk, page, path)
    pick(qtbot, page, "hand-eye")
    page.findChild(QSpinBox, "n_looks").setValue(N_VIEWS)
    news, failed = [], []
    desk.jobs.event_received.connect(news.append)
    desk.jobs.failed.connect(lambda job, what: failed.append((job, what)))
    press(qtbot, page)
    assert states(page)["hand-eye"] == "running"
    qtbot.waitUntil(lambda: sum(not look.problem for look in page._looks) >= 3)
    assert text(page, "headline").startswith("Looking at the board: ")
    assert not page.view.now._image._image.isNull()
    assert {"board", "board ink"} <= set(page.view.scene.layers())
    os.kill(desk.scan_host.pid, signal.SIGKILL)
    qtbot.waitUntil(lambda: bool(failed))
    settle(qtbot, desk, page)
    n_kept = len(read_looks(runs(path, step_names.HAND_EYE)[-1])[1])
    assert n_kept >= 3
    pick(qtbot, page, "hand-eye")
    assert button(page).text() == "Continue calibration"
    assert button(page, "start_over").isVisible()

    press(qtbot, page)
    qtbot.waitUntil(lambda: desk.jobs.is_idle)
    settle(qtbot, desk, page)
    assert states(page)["hand-eye"] == "fresh", failed[1:]
    assert len(runs(path, step_names.HAND_EYE)) == 2
    assert abs(desk.cell.settings.camera.pose - before).max() > 1e-3

    pick(qtbot, page, "check")
    press(qtbot, page)
    qtbot.waitUntil(lambda: desk.jobs.is_idle)
    settle(qtbot, desk, page)
    assert states(page)["check"] == "fresh"
    assert not any(isinstance(one, ScanQuestion) for one in news), "nobody is asked in simulation"
    pick(qtbot, page, "hand-eye")
    press(qtbot, page, "undo")
    qtbot.waitUntil(lambda: states(page)["hand-eye"] == "empty")
    assert abs(desk.cell.settings.camera.pose - before).max() < 1e-8
    assert states(page)["check"] == "stale"


@pytest.mark.system
def test_a_calibration_is_paused_between_two_views_and_goes_on(qtbot, desk, page):
    choose(qtbot, desk, page, measured_cell(seed=9))
    pick(qtbot, page, "hand-eye")
    page.findChild(QSpinBox, "n_looks").setValue(N_VIEWS)
    press(qtbot, page)
    qtbot.waitUntil(lambda: button(page).isVisible() and button(page).isEnabled())
    assert button(page).text() == "Pause"
    press(qtbot, page)
    assert button(page).text() == "Resume" and text(page, "headline").startswith("Paused: ")
    qtbot.wait(PAUSE_MS)  # the view under way may still end
    n = len(page._looks)
    qtbot.wait(PAUSE_MS)
    assert len(page._looks) == n and not desk.jobs.is_idle
    press(qtbot, page)
    assert button(page).text() == "Pause" and text(page, "headline").startswith("Looking at the board: ")
    qtbot.waitUntil(lambda: desk.jobs.is_idle)
    settle(qtbot, desk, page)
    assert states(page)["hand-eye"] == "fresh"


@pytest.mark.system
def test_stop_ends_a_calibration_and_what_was_taken_is_kept(qtbot, desk, page):
    path = measured_cell(seed=8)
    choose(qtbot, desk, page, path)
    before = path.read_bytes()
    pick(qtbot, page, "hand-eye")
    press(qtbot, page)
    qtbot.waitUntil(lambda: len(page._looks) >= 2)
    desk.arm.stop()
    desk.jobs.cancel()
    settle(qtbot, desk, page)
    assert path.read_bytes() == before
    assert len(read_looks(runs(path, step_names.HAND_EYE)[-1])[1]) >= 2
    pick(qtbot, page, "hand-eye")
    assert button(page).text() == "Continue calibration"


def test_a_row_says_whole_parts_of_its_figure_and_wraps_what_is_too_long(qtbot):
    row = StepRow("check")
    qtbot.addWidget(row)
    lines = {}
    for figure in ("7 views agree; as expected", f"{'7 views agree ' * 4}; as expected", "too long " * 20):
        row.set_line(StepLine("check", "Check", "fresh", figure.strip(), "10:00"))
        lines[row.note(300)] = row.heightForWidth(300)
    [whole, first, wrapped] = lines
    assert whole == "7 views agree; as expected" and first.endswith("agree ") and "expected" not in first
    assert wrapped == ("too long " * 20).strip()
    assert lines[wrapped] > lines[whole] + 20
    assert "…" not in "".join(lines) and row.toolTip() == wrapped


def test_the_crop_box_is_typed_and_dragged_in_the_platforms_step_alone(qtbot, desk, page):
    path = new_cell("bench", is_simulated=True)
    choose(qtbot, desk, page, path)
    before = read_cell(path).place
    boxes = page.view.scene._boxes
    pick(qtbot, page, "cup")
    assert not boxes["box"].has_handles
    pick(qtbot, page, "table")
    assert boxes["box"].has_handles

    low, high = page.findChild(QDoubleSpinBox, "crop_low_x"), page.findChild(QDoubleSpinBox, "crop_high_z")
    assert low.value() == pytest.approx(1000 * before.crop_min_m[0])
    high.setValue(300.0)
    qtbot.waitUntil(lambda: read_cell(path).place.crop_max_m[2] == pytest.approx(0.3))
    settle(qtbot, desk, page)
    assert boxes["box"].max_m[2] == pytest.approx(0.3), "the view follows"

    dragged = np.add(before.crop_min_m, (0.01, 0, 0))
    page.view.scene.box_edited.emit("box", dragged, np.array(read_cell(path).place.crop_max_m))
    qtbot.waitUntil(lambda: read_cell(path).place.crop_min_m[0] == pytest.approx(dragged[0]))
    settle(qtbot, desk, page)
    assert low.value() == pytest.approx(1000 * dragged[0])

    said, kept = [], path.read_bytes()
    desk.message.connect(said.append)
    high.setValue(-500.0)
    qtbot.waitUntil(lambda: bool(said))
    settle(qtbot, desk, page)
    assert "crop box is empty" in said[0] and path.read_bytes() == kept
    assert high.value() == pytest.approx(300.0), "what was refused is not shown"


@pytest.mark.parametrize("step", ["board", "table", "views", "cup"])
def test_what_a_step_may_be_told_is_in_sight_once_it_is_chosen(qtbot, desk, page, step):
    choose(qtbot, desk, page, new_cell("bench", is_simulated=True))
    pick(qtbot, page, step)
    qtbot.waitUntil(lambda: not page.side.options.visibleRegion().isEmpty())
    told = page.side.options.currentWidget().findChildren(QAbstractSpinBox)[0]
    qtbot.waitUntil(lambda: not told.visibleRegion().isEmpty())


@pytest.mark.system
def test_a_touched_corner_is_read_and_said_with_the_check(qtbot, desk, page):
    path = measured_cell(seed=1)
    choose(qtbot, desk, page, path)
    pick(qtbot, page, "check")
    assert not button(page, "read_touch").isEnabled(), "where the board lies is not known yet"
    calibrate_cell(path, Reporter(), None, n_views=N_VIEWS)
    check_cell(path, Reporter(), None, lambda: None)
    choose(qtbot, desk, page, path)
    pick(qtbot, page, "check")
    assert [page.findChild(QDoubleSpinBox, f"tip_{axis}").value() for axis in "xyz"] == pytest.approx(
        1000 * read_cell(path).gripper.grasp_pose[:3, 3], abs=0.05
    )
    page.findChild(QDoubleSpinBox, "tip_z").setValue(231.5)
    press(qtbot, page, "read_touch")
    qtbot.waitUntil(lambda: "touch check: 1 corner within " in text(page, "step_figure"))
    settle(qtbot, desk, page)
    assert page.findChild(QDoubleSpinBox, "tip_z").value() == 231.5
    assert states(page)["check"] == "fresh"


def test_what_the_camera_sees_is_shown_live_until_it_is_cancelled(qtbot, desk, page):
    choose(qtbot, desk, page, measured_cell())
    pick(qtbot, page, "board")
    assert not button(page, "live").isVisible()
    pick(qtbot, page, "camera")
    depth = page.findChild(DepthPanel)
    seen = []
    desk.jobs.event_received.connect(lambda news: seen.append(news) if isinstance(news, CameraSeen) else None)
    press(qtbot, page, "live")
    qtbot.waitUntil(lambda: len(seen) >= 3)
    assert depth.isVisible() and not page.view.scene.isVisible()
    assert 0.3 < depth.range_m[0] < depth.range_m[1] < 2
    assert text(page, "headline") == "This is what the camera sees now."
    assert not button(page).isEnabled() and not button(page, "live").isVisible()
    desk.jobs.cancel()
    qtbot.waitUntil(lambda: desk.jobs.is_idle)
    settle(qtbot, desk, page)
    assert page.view.scene.isVisible() and not depth.isVisible()
    assert states(page)["camera"] == "empty", "to look is not to try"
