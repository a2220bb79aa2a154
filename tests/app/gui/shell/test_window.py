"""The frame: what is always on the screen, and what it does."""

from __future__ import annotations

import re

import psutil
import pytest
from PySide6.QtCore import QEvent, QObject, QPoint, Qt, QTimer, QUrl
from PySide6.QtGui import QTextDocument
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QInputDialog, QLabel, QMenu, QMessageBox, QPushButton, QWidget

from app.gui.desk.memory import Memory
from app.gui.pages.page import SplitView
from app.gui.pages.registry import OTHERS, WORK
from app.gui.pages.welcome.pictures import FOLDER, STEPS
from app.gui.shell.frame import Chip, Tab
from app.gui.shell.guide import GUIDE_FILE, Guide
from app.gui.shell.job_bar import MessageBar
from app.gui.shell.menus import Menus, ShortcutOverview, actions_with_keys
from app.gui.shell.window import MainWindow
from app.gui.theme import DARK, LIGHT, THEMES, apply_theme, theme_of
from app.jobs.arm_events import ArmConnected, ArmStatus
from app.jobs.messages import FailureKind
from app.jobs.session_work import SessionWork
from app.library.session_folder import remembered_parameters
from core.motion.pour.plan import Segment
from tests.awake import within


def _button(window, name):
    return window.findChild(QPushButton, name)


def _action(menu, beginning):
    return next(action for action in menu.actions() if action.text().startswith(beginning))


def _tab(window, key):
    return window.findChild(Tab, f"tab_{key}").state


def test_the_first_page_says_what_to_do_and_nothing_is_open(window):
    assert window.shown == "welcome"
    assert _button(window, "session_name").text() == "No session"
    assert window.findChild(Chip, "cell_chip").text == "SIMULATED"
    assert _button(window, "stop").isVisible()
    assert _button(window, "next").isHidden()
    row = window.findChild(QWidget, "step_pictures")
    for picture in (label for label in row.findChildren(QLabel) if label.accessibleName()):
        shown = picture.pixmap().deviceIndependentSize().toSize()
        assert shown == picture.size() and row.rect().contains(picture.geometry())


@pytest.mark.parametrize("theme", THEMES)
def test_there_is_a_picture_of_each_step_in_each_theme(theme):
    assert all((FOLDER / f"{step}-{theme}.png").is_file() for step in STEPS)


def test_tabs_show_the_state_of_the_session_and_the_bar_what_comes_next(window, mug_session, qtbot):
    window.desk.open_session(mug_session)
    assert _tab(window, "imagination").word == "fresh"
    assert _button(window, "next").text() == "Next: review the pours"
    assert _button(window, "session_name").text() == "mug"


def test_a_failure_is_a_sentence_with_details_and_a_second_try(window, tmp_path, qtbot):
    window.desk.open_session(tmp_path / "new")
    jobs, missing = window.desk.jobs, tmp_path / "missing"
    with qtbot.waitSignal(jobs.failed):
        jobs.start("Import", "scan", window.desk.session_host, SessionWork.import_scan,
                   window.desk.workspace.task(), missing)  # fmt: skip
    messages = window.findChild(MessageBar)
    assert str(missing) in messages.sentence
    assert _tab(window, "scan").word == "failed"
    assert "Traceback" in window.log.text
    assert "Traceback" not in messages.sentence
    with qtbot.waitSignal(jobs.failed):
        qtbot.mouseClick(_button(window, "message_action"), Qt.MouseButton.LeftButton)


def _spawned():
    return {child for child in psutil.Process().children() if "spawn_main" in " ".join(child.cmdline())}


@pytest.fixture
def spawned_by_others():
    """Child processes of tests that ran before; asked for before `window`."""
    return _spawned()


@pytest.mark.parametrize("answer", ["Stop and close", "Keep working"])
def test_closing_while_work_runs_asks_and_leaves_no_process(
    spawned_by_others, window, mug_session, qtbot, answer
):
    window.desk.open_session(mug_session)
    desk = window.desk
    changed = desk.workspace.parameters.model_copy(update={"seed": 5})
    desk.workspace.edit(changed, "seed")
    with qtbot.waitSignal(desk.jobs.progressed):
        desk.jobs.start(
            "Imagine", "imagination", desk.session_host, SessionWork.imagine, desk.workspace.task()
        )

    def press():
        box = window.findChild(QMessageBox, "closing")
        next(button for button in box.buttons() if button.text() == answer).click()

    QTimer.singleShot(300, press)
    is_closed = window.close()
    assert is_closed == (answer == "Stop and close")
    if is_closed:
        assert _spawned() <= spawned_by_others
    else:
        assert not desk.jobs.is_idle
        with within(5.0), qtbot.waitSignal(desk.jobs.failed) as ended:
            qtbot.mouseClick(_button(window, "cancel"), Qt.MouseButton.LeftButton)
        assert ended.args[1].kind is FailureKind.CANCELLED


@pytest.mark.parametrize(
    ("stopped_in", "is_closed", "said"),
    [
        (Segment.POUR, True, "holds the cup over the object; it was stopped in “pour”"),
        (Segment.CARRY, True, "holds the cup away from its station; it was stopped in “carry”"),
        (Segment.GRASP, False, "stands where it was stopped in “grasp”, its gripper open"),
        (None, True, "gripper of the UR5 is closed: it may hold the cup"),
    ],
)
def test_closing_says_what_the_arm_holds_and_where(window, qtbot, stopped_in, is_closed, said):
    desk = window.desk
    desk.arm_host.open()
    desk.arm.handle(ArmConnected("UR5", None, False, pid=desk.arm_host.pid))
    desk.arm.handle(ArmStatus(None, is_closed, "", stopped_in=stopped_in))
    asked = []

    def press(wanted):
        box = window.findChild(QMessageBox, "closing")
        asked.append((box.text(), box.informativeText()))
        assert box.defaultButton().text() == "Stay"
        next(button for button in box.buttons() if button.text() == wanted).click()
        box.setObjectName("answered")

    QTimer.singleShot(200, lambda: press("Stay"))
    assert not window.close()
    assert window.isVisible()
    QTimer.singleShot(200, lambda: press("Close anyway"))
    assert window.close()
    assert said in asked[0][0]
    assert "stays like that" in asked[0][1]
    assert asked[0] == asked[1]


def test_an_arm_at_home_that_holds_nothing_does_not_keep_the_window_open(window, qtbot):
    desk = window.desk
    desk.arm_host.open()
    desk.arm.handle(ArmConnected("UR5", None, False, pid=desk.arm_host.pid))
    desk.arm.handle(ArmStatus(None, False, ""))
    assert window.close()


def test_stop_works_by_button_and_by_key_whatever_has_the_focus(window, qtbot):
    pressed = []
    window.top_bar.stop.pressed.connect(lambda: pressed.append(True))
    qtbot.mousePress(_button(window, "stop"), Qt.MouseButton.LeftButton)
    assert pressed == [True]
    qtbot.mouseRelease(_button(window, "stop"), Qt.MouseButton.LeftButton)
    window.activateWindow()
    qtbot.waitActive(window) if window.isActiveWindow() else None
    qtbot.keyClick(window, Qt.Key.Key_F12)
    assert pressed == [True, True]
    assert window.log.text.count("STOP was pressed.") == 2


def test_stop_works_by_key_while_a_dialog_is_open(window, qtbot):
    pressed = []
    window.top_bar.stop.pressed.connect(lambda: pressed.append(True))
    box = QMessageBox(window)
    box.open()
    qtbot.waitExposed(box)
    QTest.keyClick(box.windowHandle(), Qt.Key.Key_F12)
    assert pressed == [True]
    box.close()


def test_the_layout_and_the_session_are_remembered(window, mug_session, qtbot):
    window.desk.open_session(mug_session)
    assert Memory().last_session == mug_session
    assert Memory().was_cut_off  # as long as the session is open: a kill now would be one
    window.resize(1400, 900)
    window.close_without_asking()
    assert not Memory().was_cut_off
    assert Memory().geometry is not None


def test_the_width_of_a_side_panel_is_remembered_from_window_to_window(window, qtbot):
    window.show_page("history")
    split = window.page("history").findChild(SplitView)
    qtbot.waitUntil(lambda: split.width() > 800)
    split.setSizes([split.width() - 500, 500])
    width = split.sizes()[1]
    assert width > 450
    window.close_without_asking()
    second = MainWindow(Memory())
    qtbot.addWidget(second)
    second.show()
    second.page("history")  # made, but not shown yet, as the window does at its start
    second.show_page("history")
    again = second.page("history").findChild(SplitView)
    qtbot.waitUntil(lambda: abs(again.sizes()[1] - width) <= 1)
    second.close_without_asking()


def test_after_a_kill_the_next_start_offers_the_session(window, mug_session, qtbot):
    window.memory.store_session(mug_session)
    window.offer_cut_off_session()
    assert "while the session 'mug' was open" in window.messages.sentence
    qtbot.mouseClick(_button(window, "message_action"), Qt.MouseButton.LeftButton)
    assert window.desk.workspace.folder == mug_session


def test_a_damaged_session_is_refused_in_a_sentence(window, tmp_path):
    (tmp_path / "session.json").write_text("{")
    assert not window.desk.open_session(tmp_path)
    assert "damaged" in window.messages.sentence
    assert window.desk.workspace.session is None


def test_both_themes_reach_the_widgets(window, qapp):
    for theme in (DARK, LIGHT):
        apply_theme(qapp, theme)
        assert theme_of(window.top_bar) is theme_of(window.top_bar.stop) is theme  # STOP is red in both


def test_the_overview_lists_every_key_of_the_menus(window):
    menus = Menus(window)
    window.setMenuBar(menus)
    keys = dict(actions_with_keys(menus))
    assert keys["Undo"] == "Ctrl+Z"
    assert len(set(keys.values())) == len(keys), "one key, one deed"
    overview = ShortcutOverview(menus, window)
    texts = {label.text() for label in overview.findChildren(QLabel)}
    assert set(keys) <= texts
    assert "F12, Pause" in texts


def test_whoever_cancels_a_job_sees_no_banner(window, mug_session, qtbot):
    window.desk.open_session(mug_session)
    desk, height = window.desk, window.page("scan").height()
    with qtbot.waitSignal(desk.jobs.started):
        desk.workspace.edit(desk.workspace.parameters.model_copy(update={"seed": 5}), "seed")
        desk.jobs.start(
            "Imagine", "imagination", desk.session_host, SessionWork.imagine, desk.workspace.task()
        )
    with qtbot.waitSignal(desk.jobs.failed):
        qtbot.mouseClick(_button(window, "cancel"), Qt.MouseButton.LeftButton)
    assert window.messages.sentence == ""
    assert window.findChild(QLabel, "job_text").text() == "Imagine: cancelled; what was finished is kept."
    assert window.page("scan").height() == height


def test_enter_presses_the_button_that_has_the_focus(window, qtbot):
    window.activateWindow()
    window.show_page("history")
    tab = window.findChild(Tab, "tab_scan")
    tab.setFocus()
    qtbot.keyClick(tab, Qt.Key.Key_Return)
    assert window.shown == "scan"
    log = _button(window, "log_toggle")
    log.setFocus()
    qtbot.keyClick(log, Qt.Key.Key_Enter)
    assert window.log.isVisible()


def test_the_focus_stays_when_its_button_goes_and_returns_with_it(window, mug_session, qtbot):
    window.activateWindow()
    window.desk.open_session(mug_session)
    window.show_page("imagination")
    qtbot.waitUntil(lambda: window.desk.background.is_idle)
    desk, page = window.desk, window.page("imagination")
    desk.workspace.edit(desk.workspace.parameters.model_copy(update={"seed": 5}), "seed")
    primary = page.findChild(QPushButton, "primary")
    primary.setFocus()
    qtbot.keyClick(primary, Qt.Key.Key_Return)
    assert not desk.jobs.is_idle
    assert not primary.isEnabled()
    assert page.hasFocus()
    with qtbot.waitSignal(desk.jobs.failed):
        qtbot.mouseClick(_button(window, "cancel"), Qt.MouseButton.LeftButton)
    qtbot.waitUntil(primary.hasFocus)


def test_no_widget_is_shown_outside_the_window_while_the_pages_are_made(window, mug_session, qtbot, qapp):
    shown = []

    class Watch(QObject):
        def eventFilter(self, watched, event):
            if event.type() == QEvent.Type.Show and isinstance(watched, QWidget) and watched.isWindow():
                shown.append(watched)
            return False

    watch = Watch()
    qapp.installEventFilter(watch)
    window.desk.open_session(mug_session)
    for key in (*WORK, *OTHERS):
        window.show_page(key)
        qtbot.waitUntil(lambda: window.desk.background.is_idle)
    qapp.removeEventFilter(watch)
    assert shown == []


def test_a_new_session_has_the_name_that_was_typed_and_goes_to_scan(window, qtbot, monkeypatch, tmp_path):
    monkeypatch.setenv("POURSIGHT_SESSIONS", str(tmp_path))
    monkeypatch.setattr(QInputDialog, "getText", lambda *_, **__: ("wood block", True))
    window.show_page("history")
    menus = Menus(window)
    menus.new_session()
    assert window.shown == "scan"
    assert _button(window, "session_name").text() == "wood block"
    assert window.windowTitle() == "wood block – Poursight"
    primary = window.page("scan").findChild(QPushButton, "primary")
    qtbot.waitUntil(lambda: primary.text() == "Scan the block")


def test_the_header_renames_the_session_and_opens_another_one(
    window, mug_session, qtbot, monkeypatch, tmp_path
):
    monkeypatch.setenv("POURSIGHT_SESSIONS", str(tmp_path))
    Menus(window)
    name, desk = _button(window, "session_name"), window.desk
    assert desk.new_session("first") and desk.new_session("second")
    menu = name.menu()
    menu.aboutToShow.emit()
    qtbot.waitUntil(lambda: any(action.text().startswith("first") for action in menu.actions()))
    assert not any(action.text().startswith("second") for action in menu.actions())  # it is open
    _action(menu, "Rename").trigger()
    dialog = window.findChild(QInputDialog, "rename_dialog")
    dialog.setTextValue("my mug & saucer")
    dialog.accept()
    assert name.text() == "my mug && saucer"
    assert window.windowTitle() == "my mug & saucer – Poursight"
    _action(menu, "first").trigger()
    assert desk.workspace.session_name == "first"


def test_the_header_begins_a_new_session_at_scan(window, qtbot, monkeypatch, tmp_path):
    monkeypatch.setenv("POURSIGHT_SESSIONS", str(tmp_path))
    monkeypatch.setattr(QInputDialog, "getText", lambda *_, **__: ("bowl", True))
    window.setMenuBar(Menus(window))
    menu = _button(window, "session_name").menu()
    assert not _action(menu, "Rename").isEnabled()
    _action(menu, "New").trigger()
    assert (window.shown, _button(window, "session_name").text()) == ("scan", "bowl")


def test_an_edit_is_kept_though_nothing_was_run_with_it(window, mug_session, qtbot):
    window.desk.open_session(mug_session)
    workspace = window.desk.workspace
    workspace.edit(workspace.parameters.model_copy(update={"seed": 77}), "seed")
    qtbot.waitUntil(lambda: remembered_parameters(mug_session)[1].seed == 77)
    workspace.close()
    window.desk.open_session(mug_session)
    assert workspace.parameters.seed == 77


def test_the_operators_guide_is_in_the_help_menu_with_all_its_pictures(window, qtbot):
    menus = Menus(window)
    help_menu = next(menu for menu in menus.findChildren(QMenu) if menu.title() == "&Help")
    _action(help_menu, "&Operator").trigger()
    guide = window.findChild(Guide)
    assert guide.isVisible() and not guide.isModal()  # it can stay open beside the work
    titles = [guide.headings.item(row).text() for row in range(guide.headings.count())]
    assert titles[:2] == ["Before you begin", "1 Scan"] and "After a stop" in titles
    qtbot.waitExposed(guide)
    qtbot.waitUntil(lambda: guide.text.verticalScrollBar().maximum() > 0)
    guide.headings.setCurrentRow(titles.index("History"))
    qtbot.waitUntil(lambda: guide.text.cursorForPosition(QPoint(40, 14)).block().text() == "History")
    for target in re.findall(r"!\[.*?\]\((.*?)\)", GUIDE_FILE.read_text(encoding="utf-8")):
        picture = guide.text.loadResource(QTextDocument.ResourceType.ImageResource.value, QUrl(target))
        assert 0 < picture.width() < guide.text.viewport().width()
    guide.close()
