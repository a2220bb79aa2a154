"""What a person presses on the robot page on the way to a pour."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QCheckBox, QLabel

from app.gui.pages.robot.steps import Step

CHECKS = ("check_cup", "check_area", "check_speed", "check_stop")


def press(qtbot, button):
    """Click a button as soon as it can be clicked."""
    qtbot.waitUntil(button.isEnabled)
    button.click()


def hold(qtbot, button):
    """Press a button until it is confirmed."""
    qtbot.mousePress(button, Qt.MouseButton.LeftButton)
    with qtbot.waitSignal(button.confirmed):
        pass
    qtbot.mouseRelease(button, Qt.MouseButton.LeftButton)


def tick_all(page, is_ticked=True):
    for name in CHECKS:
        page.findChild(QCheckBox, name).setChecked(is_ticked)


def pour_until(page, qtbot, reach, move):
    """Plan, confirm, and return when a move is well under way."""
    press(qtbot, page.side.primary)
    reach(Step.CHECK)
    tick_all(page)
    hold(qtbot, page.side.hold_to_pour)
    with qtbot.waitSignal(
        page.procedure.moved,
        check_params_cb=lambda told: told.name == move and told.fraction > 0.2,
    ):
        pass


def text(page, name):
    return page.findChild(QLabel, name).text()
