from __future__ import annotations

import time

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtWidgets import QApplication, QLineEdit, QVBoxLayout, QWidget

from app.gui.views.hold_button import HoldButton

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def button(qtbot):
    window = QWidget()
    qtbot.addWidget(window)
    layout = QVBoxLayout(window)
    widget = HoldButton("Hold to pour", hold_s=0.3, parent=window)
    layout.addWidget(widget)
    layout.addWidget(QLineEdit())
    window.show()
    qtbot.waitExposed(window)
    yield widget
    window.close()


def test_held_to_the_end_it_confirms_once(qtbot, button):
    heard = []
    button.confirmed.connect(lambda: heard.append(time.perf_counter()))
    begin = time.perf_counter()
    qtbot.mousePress(button, LEFT)
    qtbot.waitUntil(lambda: bool(heard))
    assert heard[0] - begin >= 0.3
    qtbot.wait(150)
    qtbot.mouseRelease(button, LEFT)
    assert len(heard) == 1


def test_released_early_nothing_happens_and_the_ring_falls_back(qtbot, button):
    with qtbot.assertNotEmitted(button.confirmed, wait=500):
        qtbot.mousePress(button, LEFT)
        qtbot.wait(120)
        assert button.progress > 0.1
        qtbot.mouseRelease(button, LEFT)
        assert not button.is_holding
    assert button.progress == 0.0


@pytest.mark.parametrize("key", [Qt.Key.Key_Space, Qt.Key.Key_Return, Qt.Key.Key_Enter])
def test_keys_hold_as_well(qtbot, button, key):
    with qtbot.waitSignal(button.confirmed):
        qtbot.keyPress(button, key)
    qtbot.keyRelease(button, key)


def test_losing_the_focus_cancels(qtbot, button):
    button.setFocus()
    with qtbot.assertNotEmitted(button.confirmed, wait=500):
        qtbot.keyPress(button, Qt.Key.Key_Space)
        button.parentWidget().findChild(QLineEdit).setFocus()
        assert not button.is_holding


def test_leaving_it_with_the_mouse_cancels(qtbot, button):
    with qtbot.assertNotEmitted(button.confirmed, wait=500):
        qtbot.mousePress(button, LEFT)
        qtbot.mouseMove(button, QPoint(-20, -20))
        qtbot.waitUntil(lambda: not button.is_holding, timeout=300)


def test_blocked_says_why_and_cannot_be_held(qtbot, button):
    button.set_blocked("Tick the checklist first")
    assert button.toolTip() == "Tick the checklist first"
    with qtbot.assertNotEmitted(button.confirmed, wait=400):
        qtbot.mousePress(button, LEFT)
    button.set_blocked(None)
    assert button.isEnabled()
    assert button.toolTip() == ""


def test_being_blocked_while_held_cancels(qtbot, button):
    with qtbot.assertNotEmitted(button.confirmed, wait=400):
        qtbot.mousePress(button, LEFT)
        button.set_blocked("The plan has expired")
    assert not button.is_holding


def test_time_in_which_the_window_is_stuck_does_not_count(qtbot, button):
    with qtbot.assertNotEmitted(button.confirmed):
        qtbot.mousePress(button, LEFT)
        time.sleep(0.5)  # longer than the hold; a release in it could not have been seen
        qtbot.wait(30)
        qtbot.mouseRelease(button, LEFT)


def test_a_click_or_an_accessible_press_never_confirms(qtbot, button):
    with qtbot.assertNotEmitted(button.confirmed, wait=400):
        button.click()
        qtbot.mouseClick(button, LEFT)


def test_it_is_never_squeezed_below_its_two_lines(qtbot, button):
    application = QApplication.instance()
    before = application.styleSheet()
    application.setStyleSheet("QPushButton { min-height: 18px; }")
    button.window().resize(200, 40)
    qtbot.wait(20)
    assert button.height() >= button.sizeHint().height()
    application.setStyleSheet(before)
