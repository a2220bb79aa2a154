"""What comes next: the bar's button, the key for it, and what a good scan begins by itself."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu, QPushButton

from app.gui.desk.memory import Memory
from app.gui.desk.page_states import PageState
from app.gui.pages.registry import WORK
from app.gui.shell.frame import Tab
from app.gui.shell.job_bar import next_step
from app.gui.shell.menus import Menus


def _next(window):
    return window.findChild(QPushButton, "next")


def _tab(window, key):
    return window.findChild(Tab, f"tab_{key}").state


@pytest.mark.parametrize("shown", WORK)
@pytest.mark.parametrize("robot", ["empty", "stale", "failed", "fresh"])
def test_next_leads_to_the_arm_until_the_candies_are_in_and_then_it_is_gone(shown, robot):
    states = {page: PageState("fresh") for page in WORK} | {"robot": PageState(robot)}
    step = next_step(states, True, shown)
    if robot == "fresh":
        assert step is None
    else:
        assert step is not None and step.page == ("robot" if shown in ("pours", "robot") else "pours")


def test_after_an_entered_outcome_nothing_is_next_anywhere(window, mug_session):
    window.desk.open_session(mug_session)
    workspace = window.desk.workspace
    run = SimpleNamespace(is_back_off=False, is_done=True, imagination=workspace.record("pouring").digest,
                          outcome=SimpleNamespace(n_spilled=0))  # fmt: skip
    workspace.runs = [run]
    workspace.stages_changed.emit()
    assert _tab(window, "robot").figure == "0 spilled"
    for page in WORK:
        window.show_page(page)
        assert _next(window).isHidden()


def test_next_leads_to_another_page_or_is_not_there(window, mug_session, qtbot):
    window.setMenuBar(Menus(window))
    window.desk.open_session(mug_session)
    window.show_page("imagination")
    assert _next(window).text() == "Next: review the pours"
    key = next(
        action
        for menu in window.menuBar().findChildren(QMenu)
        for action in menu.actions()
        if action.shortcut().toString() == "Ctrl+Return"
    )
    key.trigger()
    assert window.shown == "pours"
    assert _next(window).text() == "Next: let the arm pour"
    window.show_page("robot")
    assert _next(window).isHidden()


def test_a_good_scan_is_imagined_at_once_and_the_page_stays(window, mug_session, qtbot):
    desk = window.desk
    desk.open_session(mug_session)
    window.show_page("scan")
    with qtbot.waitSignal(desk.jobs.finished):
        desk.good_scan_taken.emit()
        assert desk.jobs.running.title == "Imagine"
        assert _tab(window, "imagination").word == "running"
    assert window.shown == "scan"


def test_who_does_not_want_it_is_asked_to_imagine_after_a_good_scan(window, mug_session):
    window.setMenuBar(Menus(window))
    window.desk.open_session(mug_session)
    wish = window.menuBar().findChild(QAction, "imagine_after_scan")
    assert wish.isChecked()
    wish.trigger()
    window.desk.good_scan_taken.emit()
    assert window.desk.jobs.is_idle
    assert not Memory().imagines_after_scan
