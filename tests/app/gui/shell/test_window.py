"""The frame: what is always on the screen, and what it does."""

from __future__ import annotations

import psutil
import pytest
from PySide6.QtCore import Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel, QMessageBox, QPushButton

from app.gui.desk.memory import Memory
from app.gui.pages.page import SplitView
from app.gui.shell.frame import Chip, Tab
from app.gui.shell.job_bar import MessageBar
from app.gui.shell.menus import Menus, ShortcutOverview, actions_with_keys
from app.gui.shell.window import MainWindow
from app.gui.theme import DARK, LIGHT, apply_theme, theme_of
from app.jobs.messages import FailureKind
from app.jobs.session_work import SessionWork
from tests.awake import within


def _button(window, name):
    return window.findChild(QPushButton, name)


def _tab(window, key):
    return window.findChild(Tab, f"tab_{key}").state


def test_the_first_page_says_what_to_do_and_nothing_is_open(window):
    assert window.shown == "welcome"
    assert window.findChild(QLabel, "session_name").text() == "No session"
    assert window.findChild(Chip, "cell_chip").text == "SIMULATED"
    assert _button(window, "stop").isVisible()
    assert _button(window, "next").isHidden()


def test_tabs_show_the_state_of_the_session_and_the_bar_what_comes_next(window, mug_session, qtbot):
    window.desk.open_session(mug_session)
    assert _tab(window, "imagination").word == "fresh"
    assert _button(window, "next").text() == "Next: review the pours"
    assert window.findChild(QLabel, "session_name").text() == "mug"


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


@pytest.mark.parametrize("answer", ["Stop and close", "Keep working"])
def test_closing_while_work_runs_asks_and_leaves_no_process(window, mug_session, qtbot, answer):
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
        assert [
            child for child in psutil.Process().children() if "spawn_main" in " ".join(child.cmdline())
        ] == []
    else:
        assert not desk.jobs.is_idle
        with within(5.0), qtbot.waitSignal(desk.jobs.failed) as ended:
            qtbot.mouseClick(_button(window, "cancel"), Qt.MouseButton.LeftButton)
        assert ended.args[1].kind is FailureKind.CANCELLED


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
        assert theme_of(window.top_bar) is theme


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
