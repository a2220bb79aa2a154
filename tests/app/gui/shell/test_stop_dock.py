"""STOP in a process of its own: it works whatever the window is doing."""

from __future__ import annotations

import os
import signal
import time
from contextlib import contextmanager

import psutil
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QCursor
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel, QMenu, QMessageBox, QPushButton

from app.gui.stop.messages import Answered, Dock
from app.gui.stop.panel import StopPanel
from app.jobs.arm_events import ArmConnected, ArmDisconnected
from tests.app.gui.dashboard import Dashboard
from tests.app.gui.x_pointer import XPointer
from tests.patience import HANG_S, wait_until

PLACE = Dock(300, 40, 120, 48)


@pytest.fixture
def panel(qtbot):
    panel = StopPanel()
    qtbot.addWidget(panel)
    panel.dock(PLACE)
    panel.show()
    return panel


def said(panel) -> str:
    return panel.findChild(QLabel, "stop_channel").text()


def test_it_acts_when_the_button_or_its_key_goes_down(panel, qtbot):
    with qtbot.waitSignal(panel.pressed):
        QTest.mousePress(panel.findChild(QPushButton, "stop"), Qt.MouseButton.LeftButton)
    panel.activateWindow()
    with qtbot.waitSignal(panel.pressed):
        QTest.keyPress(panel, Qt.Key.Key_F12)


def test_it_says_whether_its_channel_is_open_and_what_the_last_press_took(panel):
    panel.show_channel(False)
    assert said(panel) == "no channel"
    panel.show_answer(Answered(0.0034, ""))
    panel.show_channel(True)
    assert said(panel) == "channel open · 3 ms"
    panel.show_answer(Answered(0.9, "The controller cannot be reached."))
    panel.show_channel(False)
    assert said(panel) == "no channel · no answer"


def test_dragged_it_stays_and_a_double_click_puts_it_back(panel):
    grip = next(one for one in panel.findChildren(QLabel) if one.text() == "⋮")
    QTest.mousePress(grip, Qt.MouseButton.LeftButton, pos=QPoint(4, 4))
    QTest.mouseMove(grip, QPoint(204, 104))
    QTest.mouseRelease(grip, Qt.MouseButton.LeftButton)
    away = panel.pos()
    assert away != QPoint(PLACE.x, PLACE.y)
    panel.dock(Dock(10, 10, 120, 48))
    assert panel.pos() == away
    QTest.mouseDClick(grip, Qt.MouseButton.LeftButton)
    assert panel.pos() == QPoint(PLACE.x, PLACE.y)


def test_an_open_menu_does_not_swallow_a_press_on_stop(window, qtbot):
    stop = window.findChild(QPushButton, "stop")
    menu = QMenu(window)
    menu.addAction("An entry")
    menu.popup(window.mapToGlobal(QPoint(300, 300)))
    qtbot.waitUntil(menu.isVisible)
    there = stop.mapToGlobal(stop.rect().center())
    with qtbot.waitSignal(stop.pressed):
        QTest.mousePress(menu.windowHandle(), Qt.MouseButton.LeftButton, pos=menu.mapFromGlobal(there))
    beside, pressed = window.mapToGlobal(QPoint(400, 600)), []
    stop.pressed.connect(lambda: pressed.append(True))
    menu.popup(window.mapToGlobal(QPoint(300, 300)))
    QTest.mousePress(menu.windowHandle(), Qt.MouseButton.LeftButton, pos=menu.mapFromGlobal(beside))
    assert not pressed
    menu.close()


@contextmanager
def arm_at(window, address):
    """As if an arm with a channel at this address were connected."""
    link = window.desk.arm
    link.handle(ArmConnected("UR5", address, is_simulated=True, pid=window.desk.arm_host.pid))
    try:
        yield window._stop_dock
    finally:
        link.handle(ArmDisconnected(""))


@pytest.fixture
def dashboard():
    dashboard = Dashboard(f"127.0.71.{os.getpid() % 250 + 1}")  # one for each process that tests
    yield dashboard
    dashboard.close()


def test_it_comes_and_goes_with_the_arm_and_comes_back_when_it_is_killed(window, dashboard, qtbot):
    window.give_stop_a_process()
    assert window._stop_dock.pid is None
    with arm_at(window, dashboard.address) as dock:
        qtbot.waitUntil(lambda: dock.pid is not None)
        first = dock.pid
        assert psutil.pid_exists(first)
        os.kill(first, signal.SIGKILL)
        qtbot.waitUntil(lambda: dock.pid not in (None, first))
        second = dock.pid
    assert dock.pid is None and not psutil.pid_exists(second)


@pytest.mark.gl
@pytest.mark.system
def test_a_dialog_and_a_frozen_window_do_not_hold_it_up(window, dashboard, qtbot):
    window.give_stop_a_process()
    pointer = XPointer()
    with arm_at(window, dashboard.address):
        dialog = QMessageBox(window)
        dialog.setModal(True)
        dialog.open()
        button = window.findChild(QPushButton, "stop")
        middle = button.mapToGlobal(button.rect().center())
        qtbot.waitUntil(lambda: QCursor.pos() is not None)
        wait_until(lambda: _reaches(pointer, middle, dashboard), HANG_S)
        before = dashboard.stops_s.qsize()
        for _ in range(10):  # this thread, which is the window's, does not come back to its loop in between
            pointer.press()
            time.sleep(0.05)
            pointer.release()
            time.sleep(0.05)
        wait_until(lambda: dashboard.stops_s.qsize() >= before + 10, HANG_S)
        dialog.close()


def _reaches(pointer, place, dashboard) -> bool:
    """Whether a press at a place of the screen tells the controller to stop."""
    before = dashboard.stops_s.qsize()
    pointer.move(place.x(), place.y())
    pointer.press()
    time.sleep(0.2)
    pointer.release()
    return dashboard.stops_s.qsize() > before
