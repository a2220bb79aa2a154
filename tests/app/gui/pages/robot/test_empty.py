"""Where there is no pour to make, the page says what is missing and where to get it."""

from __future__ import annotations

import shutil

import pytest
from PySide6.QtWidgets import QLabel

from app.gui.pages.robot.steps import Step
from core.parameters import apply_settings
from core.session import Session


def wanted(page, qtbot):
    """The page that the primary button leads to."""
    with qtbot.waitSignal(page.desk.page_wanted) as signal:
        page.side.primary.click()
    return signal.args[0]


def heading(page):
    return page.findChild(QLabel, "start_panel_heading").text()


def test_without_a_session_one_scans(page, qtbot):
    assert page.procedure.step is Step.EMPTY
    assert heading(page) == "No object yet"
    assert not page.side.hold_to_pour.isVisibleTo(page)
    assert wanted(page, qtbot) == "scan"


def test_a_scan_alone_is_to_be_imagined(page, qtbot, open_session, mug_session):
    for stage in ("containability", "pouring"):
        shutil.rmtree(mug_session / stage)
    open_session(mug_session)
    assert heading(page) == "No pours yet"
    assert wanted(page, qtbot) == "imagination"


def test_stale_pours_are_to_be_imagined_again(page, qtbot, open_session, mug_session):
    open_session(mug_session)
    assert page.procedure.step is Step.CONNECT
    workspace = page.desk.workspace
    workspace.edit(apply_settings(workspace.parameters, {"seed": 3}), "seed")
    assert heading(page) == "The pours are out of date"
    assert wanted(page, qtbot) == "imagination"
    workspace.undo_stack.undo()
    assert page.procedure.step is Step.CONNECT


def test_into_a_block_nothing_is_poured(page, qtbot, open_session, block_session):
    open_session(block_session)
    assert heading(page) == "Nothing to pour into"
    assert wanted(page, qtbot) == "imagination"


def test_a_mesh_has_no_place_in_the_cell(page, qtbot, open_session, tmp_path):
    with (
        Session.create_or_open(tmp_path / "mesh") as session,
        session.writing("mesh", inputs={}, parameters={"source": "somewhere.obj"}) as folder,
    ):
        (folder / "mesh.ply").write_text("ply")
    open_session(tmp_path / "mesh")
    assert heading(page) == "An imported mesh has no place in the cell"
    assert wanted(page, qtbot) == "scan"


def test_a_damaged_session_is_explained(page, open_session, mug_session):
    path = mug_session / "containability" / "containability.json"
    path.write_text("{".ljust(path.stat().st_size))
    open_session(mug_session)
    assert heading(page) == "The session cannot be read"
    assert "containability.json" in page.findChild(QLabel, "start_text").text()
    assert not page.side.primary.isVisibleTo(page)


def test_the_cell_and_the_object_are_shown(page, open_session, mug_session):
    open_session(mug_session)
    shown = set(page.view.scene.layers())
    assert {"table", "platform", "object", "cup", "arm", "planned arm"} <= shown
    assert "simulated UR5" in page.findChild(QLabel, "start_text").text()
    assert page.side.primary.text() == "Connect"


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_the_page_is_painted_in_both_themes(page, open_session, mug_session, theme, qapp):
    from app.gui.theme import THEMES, apply_theme

    open_session(mug_session)
    apply_theme(qapp, THEMES[theme])
    shown = page.side.grab().toImage()
    middle = shown.pixelColor(shown.width() // 2, shown.height() // 2)
    apply_theme(qapp, THEMES["light"])
    assert (middle.lightnessF() < 0.5) == (theme == "dark")
