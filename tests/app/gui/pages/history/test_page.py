from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QCheckBox,
    QFileDialog,
    QInputDialog,
    QLabel,
    QLineEdit,
    QPushButton,
    QTableWidget,
    QWidget,
)

from app.gui.pages.history.session_side import KINDS
from core.reconstruction.colors import ModelColors
from core.reconstruction.result import Reconstruction
from core.session import Session

HTML, PDF, ZIP, *_ = KINDS


def names(page):
    return [session.name for session in page._list.cards.sessions.sessions]


def said(page, name):
    return page.findChild(QLabel, name).text()


def button(page, name):
    return page.findChild(QPushButton, name)


def idle(page):
    return page.desk.background.is_idle


def test_nothing_yet_leads_to_a_scan(root, make_page, desk, qtbot):
    page = make_page()
    assert page._list.shown == "no_sessions"
    with qtbot.waitSignal(desk.page_wanted) as wanted:
        button(page, "start").click()
    assert wanted.args == ["welcome"]


def test_sessions_are_shown_the_newest_first(library, make_page):
    page = make_page()
    assert names(page) == ["block", "mug"]
    assert said(page, "count") == "2 sessions"
    assert said(page, "session_name") == "block"  # selected: a side panel is never empty
    assert "Not a container: hollow for 0\xa0% of its bulk" in said(page, "session_verdict")
    page.select(library / "mug")
    assert "Open container" in said(page, "session_verdict")
    assert said(page, "fact_chosen").endswith("chosen by the program")
    assert said(page, "fact_made").startswith("2026-11-19")
    assert button(page, "export_html").isEnabled()


def test_the_open_session_is_selected_and_not_opened_again(library, make_page, desk, qtbot):
    desk.workspace.open(library / "mug")
    page = make_page()
    assert said(page, "session_name") == "mug"
    session = desk.workspace.session
    with qtbot.waitSignal(desk.page_wanted) as wanted:
        page.press_primary()
    assert wanted.args == ["pours"]
    assert desk.workspace.session is session


def test_open_leads_to_the_results(library, make_page, desk, qtbot):
    page = make_page()
    assert button(page, "primary").text() == "Open session"
    with qtbot.waitSignal(desk.page_wanted) as wanted:
        page.press_primary()
    assert desk.workspace.folder == library / "block"
    assert wanted.args == ["imagination"]


def test_a_double_click_opens(library, make_page, desk, qtbot):
    page = make_page()
    cards = page._list.cards
    spot = cards.visualRect(cards.sessions.index(1)).center()
    qtbot.mouseClick(cards.viewport(), Qt.MouseButton.LeftButton, pos=spot)
    qtbot.mouseDClick(cards.viewport(), Qt.MouseButton.LeftButton, pos=spot)
    assert desk.workspace.folder == library / "mug"


def test_search_filters_as_one_types(library, make_page, qtbot):
    page = make_page()
    search = page.findChild(QLineEdit, "search")
    qtbot.keyClicks(search, "open cont")
    qtbot.waitUntil(lambda: names(page) == ["mug"])
    assert said(page, "count") == "1 of 2"
    assert said(page, "session_name") == "mug"
    qtbot.keyClicks(search, " xyz")
    qtbot.waitUntil(lambda: page._list.shown == "no_match")
    assert not button(page, "primary").isEnabled()
    button(page, "clear_search").click()
    qtbot.waitUntil(lambda: names(page) == ["block", "mug"])


def test_pictures_are_made_while_the_page_is_shown(library, make_page, qtbot):
    page = make_page()
    qtbot.waitUntil(lambda: all((library / name / ".thumbnail.png").exists() for name in ("mug", "block")))
    sessions = page._list.cards.sessions
    pictures = lambda: [sessions.index(row).data(Qt.ItemDataRole.DecorationRole) for row in (0, 1)]  # noqa: E731
    qtbot.waitUntil(lambda: all(pictures()))
    qtbot.keyClicks(page.findChild(QLineEdit, "search"), "mug")
    qtbot.waitUntil(lambda: names(page) == ["mug"])
    assert sessions.sessions[0].thumbnail, "what was made is not forgotten by a search"


def test_no_pictures_are_made_for_a_hidden_page(library, make_page, desk, qtbot):
    page = make_page()
    page.hide()
    qtbot.waitUntil(lambda: desk.background.is_idle)
    assert not (library / "mug" / ".thumbnail.png").exists()  # the block, which is newer, was under way


def test_two_sessions_are_compared(library, make_page, qtbot):
    page = make_page()
    page.select(library / "mug", library / "block")
    assert button(page, "primary").text() == "Compare"
    page.press_primary()
    qtbot.waitUntil(lambda: button(page, "primary").text() == "Back to sessions")
    table = page.findChild(QTableWidget, "comparison_table")
    rows = {table.item(row, 0).text(): row for row in range(table.rowCount())}
    marks = {name: table.item(row, 1).text() for name, row in rows.items() if table.item(row, 1)}
    assert marks["Verdict"] == "≠"
    assert marks["Views"] == "="
    assert table.item(rows["Verdict"], 2).text() == "open container"  # the older one is at the left
    page.findChild(QCheckBox, "only_differences").setChecked(True)
    shown = [table.item(row, 0).text() for row in range(table.rowCount())]
    assert "Verdict" in shown
    assert "Views" not in shown
    page.press_primary()
    assert page._list.isVisible()


def test_compared_models_are_seen_from_the_same_place_beside_their_pours(library, make_page, qtbot):
    page = make_page()
    page.compare(library / "mug", library / "block")
    pictures = page._comparison.pictures
    qtbot.waitUntil(lambda: all("object" in scene.layers() for scene in pictures.scenes))
    left, right = pictures.scenes
    right.look_from("top")
    assert left._navigator.camera == right._navigator.camera  # one scale, one side
    mug, block = pictures.maps
    button(page, "comparison_pours").click()
    assert mug.isVisible() and mug.shape == (8, 3)
    assert block.isHidden()
    assert said(page, "no_pours") == "No pours were imagined."
    button(page, "compared_colors_inside").click()
    assert not mug.shows_clean
    button(page, "comparison_lines").click()
    assert page.findChild(QTableWidget, "comparison_table").isVisible()
    assert not pictures.isVisible()


def test_a_session_is_compared_with_the_open_one(library, make_page, desk, qtbot):
    desk.workspace.open(library / "block")
    page = make_page()
    assert button(page, "compare_with_open").isHidden()
    page.select(library / "mug")
    button(page, "compare_with_open").click()
    qtbot.waitUntil(page._comparison.isVisible)
    assert [page._comparison.comparison.a.name, page._comparison.comparison.b.name] == ["block", "mug"]


def test_a_damaged_session_is_a_card_with_its_problem(library, make_page, desk, qtbot):
    (library / "mug" / "session.json").write_text("{")
    page = make_page()
    page.select(library / "mug")
    assert said(page, "session_verdict").endswith("Cannot be read")
    assert "damaged" in said(page, "session_problem")
    for name in ("primary", "export_zip"):
        assert not button(page, name).isEnabled()
    page.select(library / "mug", library / "block")
    assert not button(page, "primary").isEnabled()
    assert not page.grab().isNull()


def test_delete_asks_and_moves_to_the_trash(library, make_page, trash, qtbot):
    page = make_page()
    button(page, "trash").click()
    assert "Move 'block' to the trash?" in said(page, "trash_question")
    button(page, "trash_no").click()
    assert (library / "block").exists()
    button(page, "trash").click()
    button(page, "trash_yes").click()
    qtbot.waitUntil(lambda: names(page) == ["mug"])
    assert (trash / "block").is_dir()
    assert said(page, "notice") == "'block' is in the trash."
    assert said(page, "session_name") == "mug"


def test_the_open_session_is_closed_before_it_is_deleted(library, make_page, trash, desk, qtbot):
    desk.workspace.open(library / "mug")
    page = make_page()
    button(page, "trash").click()
    assert "is the open session" in said(page, "trash_question")
    button(page, "trash_yes").click()
    qtbot.waitUntil(lambda: names(page) == ["block"])
    assert desk.workspace.session is None
    assert (trash / "mug").is_dir()


def test_a_session_that_another_program_writes_is_not_deleted(library, make_page, trash, desk, qtbot):
    page = make_page()
    with Session.open(library / "block"), qtbot.waitSignal(desk.message) as told:
        button(page, "trash").click()
        button(page, "trash_yes").click()
    assert "another program" in told.args[0]
    assert (library / "block").exists()


def test_a_session_elsewhere_is_remembered_until_it_is_taken_off(root, mug_session, make_page, desk, qtbot):
    desk.workspace.open(mug_session)
    page = make_page()
    desk.workspace.close()
    qtbot.waitUntil(lambda: idle(page))
    assert names(page) == ["mug"]
    button(page, "forget").click()
    qtbot.waitUntil(lambda: page._list.shown == "no_sessions")
    assert (mug_session / "session.json").exists()


def test_sessions_made_in_the_meantime_are_there_when_the_page_is_shown_again(library, make_page, qtbot):
    page = make_page()
    page.hide()
    Session.create_or_open(library / "new")
    page.show()
    qtbot.waitUntil(lambda: "new" in names(page))
    page.select(library / "new")
    assert not button(page, "export_html").isEnabled()  # nothing was found that a report could tell
    assert button(page, "export_zip").isEnabled()


def photograph(folder):
    """Colour a session's model, as its pipeline does before a report."""
    with Session.open(folder) as session:
        mesh = Reconstruction.load(session.path / "reconstruction").mesh
        digests = {stage: session.record(stage).digest for stage in ("scan", "reconstruction")}
        with session.writing("colors", inputs=digests, parameters={}) as stage:
            ModelColors(np.full(mesh.vertices_m.shape, 90, dtype=np.uint8)).save(stage)


def test_a_model_without_colours_cannot_be_exported(library, make_page):
    page = make_page()
    assert not button(page, "export_ply").isEnabled()
    assert not button(page, "export_glb").isEnabled()


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.key)
def test_the_file_dialog_proposes_the_session_s_name(library, make_page, tmp_path, kind, monkeypatch):
    photograph(library / "block")
    page = make_page()
    page._exports_to = tmp_path
    asked = []
    monkeypatch.setattr(page.desk.jobs, "start", lambda *arguments, **_: asked.append(arguments))
    button(page, f"export_{kind.key}").click()
    dialog = page.findChild(QFileDialog, "export_dialog")
    assert dialog.selectedFiles() == [str(tmp_path / f"block.{kind.key}")]
    dialog.accept()
    assert asked[0][3:] == (kind.method, library / "block", tmp_path / f"block.{kind.key}")


def test_a_session_goes_out_as_zip_and_comes_back(library, make_page, desk, tmp_path, qtbot):
    page = make_page()
    target = tmp_path / "block.zip"
    with qtbot.waitSignal(desk.jobs.finished):
        page.export(ZIP, library / "block", target)
        assert not button(page, "export_zip").isEnabled()
    assert str(target) in said(page, "notice")
    assert button(page, "notice_folder").isVisible()
    with qtbot.waitSignal(desk.jobs.finished):
        page.import_zip(target)
    qtbot.waitUntil(lambda: len(names(page)) == 3)
    assert page.selected[0].path == library / "block-2"
    assert Session.open(library / "block-2").record("containability") is not None


def test_an_export_that_fails_is_reported_by_the_job(library, make_page, desk, qtbot):
    page = make_page()
    with qtbot.waitSignal(desk.jobs.failed) as failed:
        page.export(ZIP, library / "block", Path("/nowhere/block.zip"))
    assert "There is no folder /nowhere" in failed.args[1].sentence
    assert button(page, "export_zip").isEnabled()


@pytest.mark.parametrize("is_open", [True, False])
def test_a_session_is_renamed(library, make_page, desk, qtbot, is_open):
    if is_open:
        desk.workspace.open(library / "mug")
    page = make_page()
    page.select(library / "mug")
    button(page, "rename").click()
    dialog = page.findChild(QInputDialog, "rename_dialog")
    assert dialog.textValue() == "mug"
    dialog.setTextValue("blue mug")
    dialog.accept()
    qtbot.waitUntil(lambda: "blue mug" in names(page))
    assert Session.open(library / "mug").name == "blue mug"
    if is_open:
        assert desk.workspace.session_name == "blue mug"


def test_nothing_in_the_side_panel_is_wider_than_it_is_in_a_small_window(library, make_page):
    page = make_page()
    page.resize(1144, 650)
    inside = page.findChild(QWidget, "side_body")
    assert inside.minimumSizeHint().width() <= inside.parentWidget().width()
