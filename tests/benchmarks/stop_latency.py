"""From a press on STOP to the controller: the window frozen behind an open dialog, every processor busy.

Usage, on a screen: python -m tests.benchmarks.stop_latency [--presses N] [--busy N]
"""

from __future__ import annotations

import argparse
import multiprocessing
import time

from PySide6.QtTest import QTest
from PySide6.QtWidgets import QMessageBox, QPushButton

from app.gui.desk.memory import Memory
from app.gui.main import make_application
from app.gui.shell.window import MainWindow
from app.gui.theme import LIGHT, apply_theme
from app.jobs.arm_events import ArmConnected
from tests.app.gui.dashboard import Dashboard
from tests.app.gui.x_pointer import XPointer

LIMIT_S = 0.05


def main() -> None:
    """Press, and print how long it took."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--presses", type=int, default=100)
    parser.add_argument("--busy", type=int, default=4)
    asked = parser.parse_args()
    application = make_application()
    apply_theme(application, LIGHT)
    window = MainWindow(Memory())
    window.give_stop_a_process()
    window.show()
    dashboard, pointer = Dashboard("127.0.71.3"), XPointer()
    window.desk.arm_host.open()
    window.desk.arm.handle(ArmConnected("UR5", dashboard.address, True, window.desk.arm_host.pid or 0))
    QMessageBox(QMessageBox.Icon.Information, "A dialog", "It blocks the window.", parent=window).open()
    button = window.findChild(QPushButton, "stop")
    middle = button.mapToGlobal(button.rect().center())
    pointer.move(middle.x(), middle.y())
    while dashboard.stops_s.empty():  # until the process is there
        QTest.qWait(200)
        _press(pointer)
    busy = [multiprocessing.Process(target=_compute, daemon=True) for _ in range(asked.busy)]
    for process in busy:
        process.start()
    time.sleep(2)
    while not dashboard.stops_s.empty():
        dashboard.stops_s.get()
    seconds = []
    for _ in range(asked.presses):  # from here on the window's loop does not run
        pressed_s = time.monotonic()
        _press(pointer)
        seconds.append(dashboard.stops_s.get(timeout=10) - pressed_s)
        time.sleep(0.05)
    for process in busy:
        process.kill()
    seconds.sort()
    within = sum(one <= LIMIT_S for one in seconds)
    median_ms = 1000 * seconds[len(seconds) // 2]
    print(
        f"{len(seconds)} presses, {asked.busy} busy processes: median {median_ms:.1f} ms, "
        f"worst {1000 * seconds[-1]:.1f} ms; {within} within {1000 * LIMIT_S:.0f} ms"
    )
    window.close_without_asking()


def _press(pointer: XPointer) -> None:
    pointer.press()
    time.sleep(0.03)
    pointer.release()


def _compute() -> None:
    while True:
        sum(range(100_000))


if __name__ == "__main__":
    main()
