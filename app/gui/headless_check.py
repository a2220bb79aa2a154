"""The whole program clicked through without a screen: shows in a minute whether an installation works."""

from __future__ import annotations

import os
import resource
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from PySide6.QtCore import QEventLoop, QObject, Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QWidget

from app.gui.main import make_application, open_window
from app.gui.shell.window import MainWindow
from app.library.places import SESSIONS_VARIABLE
from core.errors import PoursightError, StageError
from core.session.pour_runs import PourRun, pour_runs

W = TypeVar("W", bound=QWidget)
READY_S, SCAN_S, IMAGINE_S, ARM_S, POUR_S = 60.0, 180.0, 240.0, 90.0, 240.0
HOLD_S = 1.8
BEAT_MS = 10
_POLL_MS = 20
_SCHEDULED = Path("/proc/thread-self/schedstat")
"""Linux: nanoseconds on a processor, nanoseconds ready and waiting for one, times that it ran."""


def check() -> int:
    """Click through the program, print each step and the window's longest stall; return the exit code."""
    with tempfile.TemporaryDirectory(prefix="poursight-check-") as home:
        # Offscreen, and without a trace in the user's settings and sessions.
        os.environ["QT_QPA_PLATFORM"] = "offscreen"
        os.environ.pop("DISPLAY", None)
        os.environ["XDG_CONFIG_HOME"] = home
        os.environ[SESSIONS_VARIABLE] = str(Path(home) / "sessions")
        return _click_through()


def _click_through() -> int:
    window = open_window(make_application())
    walk, heartbeat = Walk(window), Heartbeat(window)
    try:
        run = Tour(walk, lambda line: print(line, flush=True)).run()
    except PoursightError as error:
        print(f"poursight: {error}", file=sys.stderr)
        return 1
    finally:
        window.close_without_asking()
    outcome = run.outcome.sentence if run.outcome is not None else run.sentence
    print(
        f"{outcome} {walk.clicks} clicks; the window's longest stall was {1000 * heartbeat.worst_s:.0f} ms, "
        f"{1000 * heartbeat.worst_own_s:.0f} ms without what it waited for processor and disk."
    )
    return 0


def let_work(seconds: float) -> None:
    """Run the event loop for a while; `QTest.qWait` would keep Python's other threads from their work."""
    loop = QEventLoop()
    QTimer.singleShot(round(1000 * seconds), loop.quit)
    loop.exec()


class WalkEnded(StageError):
    """The walk could not go on: a button was not there, or something took too long."""


class Walk:
    """Walks through a window.

    Attributes:
        window: that is walked through.
        clicks: how often something was clicked.
    """

    def __init__(self, window: MainWindow) -> None:
        self.window = window
        self.clicks = 0

    def wait(self, condition: Callable[[], object], what: str, within_s: float) -> None:
        """Run the event loop until a condition holds.

        Raises:
            WalkEnded: it took too long, or a job failed meanwhile.
        """
        deadline_s = time.monotonic() + within_s
        while not condition():
            if time.monotonic() > deadline_s:
                message = self.window.messages.sentence
                raise WalkEnded(f"'{what}' did not happen within {within_s:.0f} s. {message}".rstrip())
            let_work(_POLL_MS / 1000)

    def wait_for_work(self, what: str, within_s: float) -> None:
        """Run the event loop until no job runs."""
        self.wait(lambda: self.window.desk.jobs.is_idle, what, within_s)

    def shown(self, kind: type[W], name: str = "") -> W | None:
        """Return a widget that can be seen and used, in the frame or on the page; none if there is none."""
        found = self.window.findChildren(kind, name) if name else self.window.findChildren(kind)
        usable = (widget for widget in found if widget.isVisibleTo(self.window) and widget.isEnabled())
        return next(usable, None)

    def click(self, name: str, within_s: float = 5.0) -> None:
        """Click a button as soon as it can be clicked."""
        self.wait(lambda: self.shown(QAbstractButton, name), f"button '{name}'", within_s)
        button = self.shown(QAbstractButton, name)
        assert button is not None, "waited for"
        self.clicks += 1
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)

    def hold(self, name: str, seconds: float) -> None:
        """Press a button, hold it, and release it."""
        self.wait(lambda: self.shown(QWidget, name), f"button '{name}'", 10)
        button = self.shown(QWidget, name)
        assert button is not None, "waited for"
        self.clicks += 1
        QTest.mousePress(button, Qt.MouseButton.LeftButton)
        let_work(seconds)
        QTest.mouseRelease(button, Qt.MouseButton.LeftButton)


class Tour:
    """Scans the mug, imagines, and pours, as a newcomer would."""

    def __init__(self, walk: Walk, report: Callable[[str], None]) -> None:
        """`report` is called with each step and the time it took; the window has just been opened."""
        self._walk = walk
        self._report = report
        self._desk = walk.window.desk
        self._is_ready = False
        walk.window.ready.connect(self._note_ready)

    def run(self) -> PourRun:
        """Go through all steps; return the pour that was made.

        Raises:
            WalkEnded: a step did not lead where it should.
        """
        for what, step in (
            ("The window is ready", self._wait_until_ready),
            ("The mug is scanned and its surface reconstructed", self._scan),
            ("Containability and pours are imagined", self._imagine),
            ("The pours are reviewed", self._review),
            ("The arm is connected and the pour is planned", self._plan),
            ("The mug is poured into, and the outcome recorded", self._pour),
        ):
            began_s = time.monotonic()
            step()
            self._report(f"{what}: {time.monotonic() - began_s:.1f} s.")
        return self._newest_run()

    def _note_ready(self) -> None:
        self._is_ready = True

    def _wait_until_ready(self) -> None:
        self._walk.wait(lambda: self._is_ready, "the window is ready", READY_S)

    def _scan(self) -> None:
        self._walk.click("primary")
        self._walk.wait(lambda: self._is_fresh("collision"), "the mug is scanned", SCAN_S)

    def _imagine(self) -> None:
        self._walk.click("tab_imagination")  # to watch: a good scan is imagined at once
        self._walk.wait(lambda: self._is_fresh("risk"), "pours are imagined", IMAGINE_S)
        self._walk.wait_for_work("the imagination ends", IMAGINE_S)

    def _review(self) -> None:
        self._walk.click("next")
        self._walk.wait(lambda: self._walk.window.shown == "pours", "the pours are shown", 5)
        self._walk.wait_for_work("the arm's motions are checked", ARM_S)

    def _plan(self) -> None:
        self._walk.click("next")
        self._walk.wait(lambda: self._walk.window.shown == "robot", "the arm is shown", 5)
        self._walk.wait(lambda: self._walk.shown(QWidget, "hold_to_pour"), "the pour is planned", ARM_S)

    def _pour(self) -> None:
        self._walk.hold("hold_to_pour", HOLD_S)
        self._walk.wait_for_work("the mug is poured into", POUR_S)
        self._walk.click("primary", within_s=30)
        self._walk.wait(lambda: self._newest_run().outcome, "the outcome is recorded", 10)

    def _is_fresh(self, stage: str) -> bool:
        return self._desk.workspace.is_fresh(stage)

    def _newest_run(self) -> PourRun:
        folder = self._desk.workspace.folder
        runs = [] if folder is None else pour_runs(folder)
        if not runs:
            raise WalkEnded("No pour was made.")
        return runs[-1]


class Heartbeat(QObject):
    """A timer that notices when it fires late.

    Attributes:
        worst_s: the longest stall since the last `reset`.
        worst_at_s: when it ended, in seconds since the last `reset`.
        worst_own_s: the longest one without the time in which it waited for a processor; where something came
            from the disk, its processor time alone. What is left is the program's own doing.
    """

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._timer = QTimer(self)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.setInterval(BEAT_MS)
        self._timer.timeout.connect(self._beat)
        self.reset()
        self._timer.start()

    def reset(self) -> None:
        """Start measuring again."""
        self.worst_s = self.worst_at_s = self.worst_own_s = 0.0
        self._began_s = self._last_s = time.perf_counter()
        self._waited_s = _waited_for_processor_s()
        self._busy_s, self._disk = time.process_time(), _times_at_disk()

    def _beat(self) -> None:
        now_s, waited_s = time.perf_counter(), _waited_for_processor_s()
        stall_s = now_s - self._last_s - BEAT_MS / 1000
        if stall_s > self.worst_s:
            self.worst_s, self.worst_at_s = stall_s, now_s - self._began_s
        busy_s, disk = time.process_time(), _times_at_disk()
        own_s = stall_s - (waited_s - self._waited_s)
        if disk != self._disk:
            own_s = min(own_s, busy_s - self._busy_s)
        self.worst_own_s = max(self.worst_own_s, own_s)
        self._last_s, self._waited_s, self._busy_s, self._disk = now_s, waited_s, busy_s, disk


def _times_at_disk() -> tuple[int, int]:
    """How often this process has waited for the disk so far: pages of libraries, and what it read."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_majflt, used.ru_inblock


def _waited_for_processor_s() -> float:
    """How long this thread has waited for a processor so far; 0 where the system does not count it."""
    try:
        return int(_SCHEDULED.read_text(encoding="ascii").split()[1]) / 1e9
    except (OSError, IndexError):
        return 0.0
