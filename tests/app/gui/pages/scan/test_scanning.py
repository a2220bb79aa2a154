"""Scans from the page, watched, paused, killed and tried again; and what comes from files."""

from __future__ import annotations

import os
import signal

import pytest
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDragLeaveEvent, QDropEvent
from PySide6.QtWidgets import QApplication, QCheckBox, QWidget

from app.jobs.arm_events import ArmStatus
from hardware.simulation.objects import builtin_object
from tests.app.gui.pages.scan.conftest import N_VIEWS, settle
from tests.app.gui.pages.scan.reading import button, details, headline, pick_thumbnail, primary, states, text
from tests.app.sessions import quick_parameters

pytestmark = pytest.mark.system


def n_taken(page):
    return states(page).count("taken")


def test_a_scan_is_watched_killed_and_tried_again(qtbot, desk, small_cell_page, sessions):
    page = small_cell_page
    news, failed = [], []
    desk.jobs.event_received.connect(news.append)
    desk.jobs.failed.connect(lambda job, what: failed.append((job, what)))
    qtbot.mouseClick(primary(page), Qt.MouseButton.LeftButton)
    [folder] = sessions.iterdir()
    assert folder.name.endswith("-mug")
    assert headline(page) == "Connecting to the cell …"
    assert not primary(page).isEnabled()
    desk.workspace.edit(quick_parameters(), "quick")

    qtbot.waitUntil(lambda: n_taken(page) >= 1)
    assert headline(page) == f"Taking view {n_taken(page) + 1} of {N_VIEWS}."
    assert primary(page).text() == "Pause"
    assert any(isinstance(one, ArmStatus) for one in news)
    qtbot.waitUntil(lambda: "object" in page.left.view.scene.layers())
    assert not page.side._image._image.isNull()
    qtbot.mouseClick(primary(page), Qt.MouseButton.LeftButton)
    assert headline(page).startswith("Paused")
    assert desk.jobs.running.seconds_left is None
    assert primary(page).text() == "Resume"
    qtbot.wait(1500)
    held = n_taken(page)
    qtbot.wait(700)
    assert n_taken(page) == held < N_VIEWS

    os.kill(desk.scan_host.pid, signal.SIGKILL)
    qtbot.waitUntil(lambda: bool(failed))
    settle(qtbot, desk, page)
    assert headline(page) == f"The scan was interrupted: {held} of {N_VIEWS} views are stored."
    assert primary(page).text() == "Continue scan"

    failed[0][0].start_again()
    qtbot.waitUntil(lambda: n_taken(page) == N_VIEWS)
    qtbot.waitUntil(lambda: "scan:" in headline(page) or "Scan again:" in headline(page))
    settle(qtbot, desk, page)
    assert desk.workspace.is_fresh("quality")
    assert desk.workspace.folder == folder
    assert primary(page).text() == "Scan again"


def test_after_a_stop_the_arm_is_seen_through_where_it_was_and_going_on_asks(qtbot, desk, small_cell_page):
    page, view = small_cell_page, small_cell_page.left.view
    clear = page.findChild(QCheckBox, "area_clear")
    assert not clear.isVisible()
    qtbot.mouseClick(primary(page), Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: n_taken(page) >= 1)
    assert view.arm_looks == "solid"
    desk.arm.stop()
    settle(qtbot, desk, page)
    stopped_rad = desk.arm.last_seen_rad.copy()
    assert abs(stopped_rad - view._cell.model.home_rad).max() > 0.1, "away from home"
    assert view.arm_looks == "ghost"
    assert "drawn see-through where it was last seen" in text(page, "obstacle")
    assert primary(page).text() == "Continue scan"
    assert not primary(page).isEnabled()
    assert clear.isVisible()

    qtbot.mouseClick(clear, Qt.MouseButton.LeftButton, pos=QPoint(8, clear.height() // 2))
    assert text(page, "obstacle") == ""
    qtbot.mouseClick(primary(page), Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: desk.arm.connected is not None)
    assert view.arm_looks == "solid"
    assert not clear.isVisible()
    qtbot.waitUntil(lambda: n_taken(page) == N_VIEWS)
    settle(qtbot, desk, page)
    assert view.arm_looks == "ghost", "it stays where it took its last view, and nobody watches it any more"
    assert not clear.isVisible()


def test_a_view_is_taken_again_and_judged_anew(qtbot, desk, make_page, mug_session):
    from hardware.cell import read_cell

    desk.workspace.open(mug_session)
    page = make_page(read_cell())
    finished, good = [], []
    desk.jobs.finished.connect(lambda job, _: finished.append(job.title))
    desk.good_scan_taken.connect(lambda: good.append(list(finished)))
    image = mug_session / "scan/rgbd/frame-000002.depth.png"
    written_ns = image.stat().st_mtime_ns
    pick_thumbnail(page, 2)
    qtbot.mouseClick(button(page, "take_again"), Qt.MouseButton.LeftButton)
    assert not button(page, "take_again").isEnabled()
    qtbot.waitUntil(lambda: len(finished) == 2)
    settle(qtbot, desk, page)
    assert finished == ["Scan", "Check the scan"]
    assert good == [finished], "told once, when it was checked"
    assert image.stat().st_mtime_ns != written_ns
    assert headline(page).startswith("Good scan")
    assert text(page, "caption") == "View 3: taken"


def mime(*paths):
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(path)) for path in paths])
    return data


def drop(page, *paths):
    data, copy = mime(*paths), Qt.DropAction.CopyAction
    buttons, keys = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    entered = QDragEnterEvent(QPoint(50, 50), copy, data, buttons, keys)
    QApplication.sendEvent(page, entered)
    assert entered.isAccepted()
    assert page.findChild(QWidget, "drop_hint").isVisible()
    QApplication.sendEvent(page, QDropEvent(QPointF(50, 50), copy, data, buttons, keys))
    assert not page.findChild(QWidget, "drop_hint").isVisible()


@pytest.fixture
def mesh_file(tmp_path):
    path = tmp_path / "my cup.obj"
    mesh = builtin_object("mug")
    lines = [f"v {x} {y} {z}" for x, y, z in mesh.vertices_m]
    lines += [f"f {a} {b} {c}" for a, b, c in mesh.faces + 1]
    path.write_text("\n".join(lines))
    return path


def test_a_dropped_mesh_is_imported_into_a_session_of_its_own(
    qtbot, desk, small_cell_page, sessions, mesh_file
):
    page = small_cell_page
    drop(page, mesh_file)
    qtbot.waitUntil(lambda: desk.workspace.has("mesh"))
    settle(qtbot, desk, page)
    assert [folder.name[11:] for folder in sessions.iterdir()] == ["my-cup"]
    assert headline(page) == "An imported mesh: its place in the cell is not known."
    assert details(page) == "Size: 114 x 80 x 97 mm."
    assert page.left.view.scene.layers() == ("object", "ground", "views")
    assert primary(page).text() == "Scan the mug"
    assert "new session" in text(page, "remark")


def test_a_dropped_folder_is_imported(qtbot, desk, small_cell_page, sessions, scan_folder):
    page = small_cell_page
    failed = []
    desk.jobs.failed.connect(lambda _, what: failed.append(what.sentence))
    drop(page, scan_folder)
    qtbot.waitUntil(lambda: bool(failed) or desk.workspace.is_fresh("quality"))
    settle(qtbot, desk, page)
    assert states(page)[:4] == ["taken"] * 4
    assert headline(page).startswith("Scan again: "), failed
    assert not button(page, "take_again").isVisible(), "nobody knows the joints of imported views"


@pytest.mark.parametrize(
    ("names", "said"),
    [(["notes.txt"], "notes.txt is neither a folder of views nor a mesh"), (["a.ply", "b.ply"], "at a time")],
)
def test_a_wrong_drop_gets_a_sentence(desk, small_cell_page, sessions, tmp_path, names, said):
    told = []
    desk.message.connect(told.append)
    paths = [tmp_path / name for name in names]
    for path in paths:
        path.write_text("nothing")
    drop(small_cell_page, *paths)
    assert said in told[0]
    assert desk.jobs.is_idle
    assert desk.workspace.session is None


def test_a_drag_that_leaves_takes_its_hint_along(small_cell_page, tmp_path):
    page = small_cell_page
    data = mime(tmp_path)
    copy, buttons = Qt.DropAction.CopyAction, Qt.MouseButton.LeftButton
    QApplication.sendEvent(
        page, QDragEnterEvent(QPoint(9, 9), copy, data, buttons, Qt.KeyboardModifier.NoModifier)
    )
    QApplication.sendEvent(page, QDragLeaveEvent())
    assert not page.findChild(QWidget, "drop_hint").isVisible()


def test_a_page_that_is_asked_to_scan_before_it_is_ready_does_so_then(qtbot, desk, few_views, sessions):
    from app.gui.pages.scan.page import ScanPage

    page = ScanPage(desk)
    qtbot.addWidget(page)
    page.show()
    page.scan("bowl")
    assert desk.jobs.is_idle
    desk.cell.settings = few_views
    desk.cell.changed.emit()
    qtbot.waitUntil(lambda: not desk.jobs.is_idle)
    assert desk.workspace.folder.name.endswith("-bowl")
    desk.jobs.cancel()
    qtbot.waitUntil(lambda: desk.jobs.is_idle)


def test_an_import_that_fails_leaves_no_session(qtbot, desk, small_cell_page, sessions, tmp_path):
    empty = tmp_path / "no views"
    empty.mkdir()
    with qtbot.waitSignal(desk.jobs.failed):
        drop(small_cell_page, empty)
    settle(qtbot, desk, small_cell_page)
    assert desk.workspace.session is None
    assert not sessions.exists() or list(sessions.iterdir()) == []
