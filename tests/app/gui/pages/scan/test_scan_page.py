"""The Scan page as a user meets it: nothing yet, a finished scan, an interrupted one, another object."""

from __future__ import annotations

import json
import shutil

import pytest
from PySide6.QtWidgets import QCheckBox, QComboBox, QListView

from app.jobs.arm_events import ArmConnected, ArmDisconnected
from app.library.session_folder import UNFINISHED_SCAN
from core.resources import RESOURCES
from hardware.cell import read_cell
from tests.app.gui.pages.scan.conftest import N_VIEWS, settle
from tests.app.gui.pages.scan.reading import button, details, headline, pick_thumbnail, primary, states, text


def opened(make_page, desk, folder):
    desk.workspace.open(folder)
    return make_page(read_cell())


def test_an_empty_page_says_what_to_do(small_cell_page):
    page = small_cell_page
    assert headline(page) == "Nothing has been scanned yet."
    assert "Press “Scan the mug”: the arm takes 5 views" in details(page)
    assert primary(page).text() == "Scan the mug"
    assert primary(page).isEnabled()
    assert states(page) == ["pending"] * N_VIEWS
    assert not button(page, "take_again").isVisible()
    combo = page.findChild(QComboBox, "object")
    names = [combo.itemText(k) for k in range(combo.count())]
    assert {"Mug", "Bowl", "Vase"} <= set(names)
    assert names[-1] == "Mesh file …"


def test_a_finished_scan_has_its_verdict_and_its_views(qtbot, desk, make_page, mug_session):
    page = opened(make_page, desk, mug_session)
    assert headline(page).startswith("Good scan: 99 % of the surface seen, pose error about 0.")
    assert states(page) == ["taken"] * 24
    assert primary(page).text() == "Scan again"
    assert "object" in page.left.view.scene.layers()
    page.left.view.view_picked.emit(6)
    settle(qtbot, desk, page)
    assert page.left.grid.selection == 6
    assert text(page, "caption") == "View 7: taken"
    assert page.side._depth.range_m[1] < 2
    assert page.side._image._image.width() > 200
    assert button(page, "take_again").isEnabled()


def test_a_list_that_gets_the_focus_chooses_nothing(qtbot, desk, make_page, mug_session):
    page = opened(make_page, desk, mug_session)
    page._follow()
    primary(page).setFocus()
    page.left.grid.findChild(QListView).setFocus()
    assert page.left.grid.findChild(QListView).hasFocus()
    assert page._images.selected is None


def test_another_object_begins_a_session_of_its_own(qtbot, desk, make_page, mug_session):
    page = opened(make_page, desk, mug_session)
    page.side.choice.choose("bowl")
    assert primary(page).text() == "Scan the bowl"
    assert "starts in a new session" in text(page, "remark")
    assert not button(page, "take_again").isVisible()
    page.side.choice.choose("mug")
    assert primary(page).text() == "Scan again"
    assert text(page, "remark") == ""


def interrupt(session, n_taken):
    """Leave of a finished scan what a program killed after some views leaves."""
    folder = session / UNFINISHED_SCAN
    shutil.move(session / "scan", folder)
    (folder / "record.json").unlink()
    table = json.loads((folder / "views.json").read_text())
    for view in table["views"][n_taken:]:
        view["state"] = "pending"
        for path in (folder / "rgbd").glob(view["name"] + ".*"):
            path.unlink()
    (folder / "views.json").write_text(json.dumps(table))


def test_an_interrupted_scan_can_be_continued_or_started_over(qtbot, desk, make_page, mug_session):
    interrupt(mug_session, 11)
    page = opened(make_page, desk, mug_session)
    assert headline(page) == "The scan was interrupted: 11 of 24 views are stored."
    assert states(page) == ["taken"] * 11 + ["pending"] * 13
    assert primary(page).text() == "Continue scan"
    assert button(page, "start_over").isVisible()
    page.side.choice.choose("bowl")
    assert "They show the object “Mug”" in details(page)
    assert primary(page).text() == "Scan the bowl"
    assert not button(page, "start_over").isVisible()


def test_views_of_another_seed_are_not_mixed_in(qtbot, desk, make_page, mug_session):
    interrupt(mug_session, 11)
    page = opened(make_page, desk, mug_session)
    desk.workspace.edit(desk.workspace.parameters.model_copy(update={"seed": 5}), "seed")
    settle(qtbot, desk, page)
    assert primary(page).text() == "Scan the mug"
    assert "another seed" in details(page)


def change_quality(session, **facts):
    path = session / "quality" / "quality.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | facts))
    record = session / "quality" / "record.json"
    table = json.loads(record.read_text())
    table["files"]["quality.json"] = path.stat().st_size  # a file of another size makes the stage stale
    record.write_text(json.dumps(table))


def test_a_poor_scan_says_why_and_offers_its_poor_views(desk, make_page, mug_session):
    table = json.loads((mug_session / "scan" / "views.json").read_text())
    table["views"][4] |= {"state": "poor", "problems": ["frame-000004 sees the table 12 mm above its place."]}
    table["views"][9] |= {"state": "failed", "problems": ["The goal of the move touches the table."]}
    (mug_session / "scan" / "views.json").write_text(json.dumps(table))
    reasons = ["usable: frame-000004 sees the table 12 mm above its place.", "usable: no view saw 14 %."]
    change_quality(mug_session, verdict="usable", reasons=reasons, unseen_share=0.14)
    page = opened(make_page, desk, mug_session)
    assert headline(page).startswith("Usable scan: 86 % of the surface seen")
    assert details(page) == "View 5 sees the table 12 mm above its place.\nNo view saw 14 %."
    assert states(page)[4] == "poor"
    assert states(page)[9] == "failed"
    assert button(page, "verdict_action").text() == "Retake 2 poor views"
    pick_thumbnail(page, 4)
    assert text(page, "caption") == "View 5: taken, but poor"
    assert text(page, "view_said") == "It sees the table 12 mm above its place."


def test_what_stayed_hidden_can_be_looked_for(desk, make_page, mug_session):
    path = mug_session / "quality" / "quality.json"
    cavity = json.loads(path.read_text())["cavity"] | {"area_m2": 0.01, "depth_m": 0.04, "width_m": 0.06}
    reasons = ["usable: it was not seen below 40 mm; look again from further views."]
    change_quality(mug_session, verdict="usable", reasons=reasons, cavity=cavity)
    page = opened(make_page, desk, mug_session)
    assert button(page, "verdict_action").text() == "Find views that show it"
    assert details(page) == "It was not seen below 40 mm; look again from further views."


def test_changed_parameters_make_the_verdict_stale(qtbot, desk, make_page, mug_session):
    page = opened(make_page, desk, mug_session)
    reconstruction = desk.workspace.parameters.reconstruction.model_copy(update={"voxel_m": 0.006})
    changed = desk.workspace.parameters.model_copy(update={"reconstruction": reconstruction})
    desk.workspace.edit(changed, "voxel")
    settle(qtbot, desk, page)
    assert details(page).startswith("Views or parameters have changed since")
    assert button(page, "verdict_action").text() == "Check the scan"


def test_a_session_that_is_closed_leaves_nothing_behind(qtbot, desk, make_page, mug_session):
    page = opened(make_page, desk, mug_session)
    desk.workspace.close()
    settle(qtbot, desk, page)
    assert headline(page) == "Nothing has been scanned yet."
    assert states(page) == ["pending"] * 24
    assert "object" not in page.left.view.scene.layers()
    assert text(page, "caption") == "What the camera sees"


@pytest.fixture
def real_cell():
    return read_cell(RESOURCES / "cells" / "ur5_example.toml")


def test_a_real_cell_asks_for_a_clear_area(make_page, real_cell, sessions):
    page = make_page(real_cell)
    assert "Put the object on the platform" in text(page, "place_object")
    assert not page.findChild(QComboBox, "object").isVisible()
    assert not primary(page).isEnabled()
    assert "Make sure the area is clear" in details(page)
    page.findChild(QCheckBox, "area_clear").setChecked(True)
    assert primary(page).isEnabled()
    assert primary(page).text() == "Scan"


def test_an_arm_that_is_connected_for_pouring_cannot_scan(desk, make_page, real_cell, sessions):
    page = make_page(real_cell)
    page.findChild(QCheckBox, "area_clear").setChecked(True)
    desk.arm.handle(ArmConnected("UR5 at 192.168.0.10", None, is_simulated=False))
    assert "disconnect it on the Robot page" in text(page, "obstacle")
    assert not primary(page).isEnabled()
    desk.arm.handle(ArmDisconnected())
    assert text(page, "obstacle") == ""
    assert primary(page).isEnabled()


def test_a_damaged_session_is_reported(qtbot, desk, make_page, mug_session):
    (mug_session / "quality" / "quality.json").write_text("{")
    told = []
    desk.message.connect(told.append)
    desk.workspace.open(mug_session)
    from app.gui.pages.scan.page import ScanPage

    page = ScanPage(desk)
    qtbot.addWidget(page)
    page.show()
    qtbot.waitUntil(lambda: bool(told))
    assert "quality.json" in told[0]


def test_the_box_drawn_is_the_one_that_the_plan_laid_around_the_object(qtbot, desk, make_page, mug_session):
    path = mug_session / "scan" / "views.json"
    table = json.loads(path.read_text())
    low, high = [-0.2, -0.5, 0.03], [0.1, -0.2, 0.45]
    views = [view["joints_rad"] for view in table["views"]]
    box = {"min_m": low, "max_m": high}
    path.write_text(json.dumps(table | {"plan": {"views_rad": views, "crop_box": box, "keep_out": box}}))
    page = opened(make_page, desk, mug_session)
    drawn = page.left.view.scene._boxes["box"]
    assert [list(drawn.min_m), list(drawn.max_m)] == [low, high]
    desk.open_session(mug_session.with_name("another"))
    settle(qtbot, desk, page)
    place = read_cell().place
    drawn = page.left.view.scene._boxes["box"]
    assert [list(drawn.min_m), list(drawn.max_m)] == [list(place.crop_min_m), list(place.crop_max_m)]
