"""Short work in a thread: results come back one in a turn of the event loop."""

from __future__ import annotations

import threading

import pytest
from PySide6.QtCore import QObject, Qt, Signal

from app.gui.desk.background import Background
from tests.patience import HANG_S


class Presses(QObject):
    """Events that arrive while a result is being shown."""

    made = Signal()

    def __init__(self, order: list[str]) -> None:
        super().__init__()
        self.made.connect(lambda: order.append("press"), Qt.ConnectionType.QueuedConnection)


@pytest.fixture
def background(qtbot):
    made = Background()
    yield made
    made.forget()


def all_ended(background, order, presses):
    """Start three calls, and keep the window's thread busy until all have ended."""
    has_run = threading.Event()

    def show(name: str) -> None:
        order.append(name)
        if name == "first":
            presses.made.emit()

    background.run("1", lambda: "first", show)
    background.run("2", lambda: "second", show)
    background.run("3", lambda: has_run.set() or "third", show)
    assert has_run.wait(HANG_S)


def test_a_press_need_not_wait_for_the_results_behind_the_one_that_is_shown(qtbot, background):
    order: list[str] = []
    presses = Presses(order)
    all_ended(background, order, presses)
    qtbot.waitUntil(lambda: background.is_idle, timeout=round(1000 * HANG_S))
    assert order == ["first", "press", "second", "third"]


def test_what_is_forgotten_is_not_shown(qtbot, background):
    order: list[str] = []
    presses = Presses(order)
    all_ended(background, order, presses)
    background.forget()
    background.run("4", lambda: "fourth", order.append)
    qtbot.waitUntil(lambda: background.is_idle, timeout=round(1000 * HANG_S))
    assert order == ["fourth"]
