"""From a new session to the recorded outcome of a simulated pour, by clicks alone."""

from __future__ import annotations

import time
from collections.abc import Callable

from PySide6.QtWidgets import QWidget

from app.gui.walk import Walk, WalkEnded
from core.session.pour_runs import PourRun, pour_runs

READY_S, SCAN_S, IMAGINE_S, ARM_S, POUR_S = 60.0, 180.0, 240.0, 90.0, 240.0
HOLD_S = 1.8


class Tour:
    """Scans the mug, imagines, and pours, as a newcomer would."""

    def __init__(self, walk: Walk, say: Callable[[str], None]) -> None:
        """`say` is told each step with the time it took; the window has just been opened."""
        self._walk = walk
        self._say = say
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
            ("The pours are looked at", self._review),
            ("The arm is connected and the pour is planned", self._plan),
            ("The mug is poured into, and the outcome kept", self._pour),
        ):
            began_s = time.monotonic()
            step()
            self._say(f"{what}: {time.monotonic() - began_s:.1f} s.")
        return self._newest_run()

    def _note_ready(self) -> None:
        self._is_ready = True

    def _wait_until_ready(self) -> None:
        self._walk.wait(lambda: self._is_ready, "the window is ready", READY_S)

    def _scan(self) -> None:
        self._walk.click("primary")
        self._walk.wait(lambda: self._is_fresh("collision"), "the mug is scanned", SCAN_S)
        self._walk.wait_for_work("the scan is judged", SCAN_S)

    def _imagine(self) -> None:
        self._walk.click("next")
        self._walk.wait(lambda: self._is_fresh("pouring"), "pours are imagined", IMAGINE_S)
        self._walk.wait_for_work("the imagination ends", IMAGINE_S)

    def _review(self) -> None:
        self._walk.click("next")
        self._walk.wait(lambda: self._walk.window.shown == "pours", "the pours are shown", 5)
        self._walk.wait_for_work("the arm's motions are judged", ARM_S)

    def _plan(self) -> None:
        self._walk.click("next")
        self._walk.wait(lambda: self._walk.window.shown == "robot", "the arm is shown", 5)
        self._walk.wait(lambda: self._walk.shown(QWidget, "hold_to_pour"), "the pour is planned", ARM_S)

    def _pour(self) -> None:
        self._walk.hold("hold_to_pour", HOLD_S)
        self._walk.wait_for_work("the mug is poured into", POUR_S)
        self._walk.click("primary", within_s=30)
        self._walk.wait(lambda: self._newest_run().outcome, "the outcome is kept", 10)

    def _is_fresh(self, stage: str) -> bool:
        return self._desk.workspace.is_fresh(stage)

    def _newest_run(self) -> PourRun:
        folder = self._desk.workspace.folder
        runs = [] if folder is None else pour_runs(folder)
        if not runs:
            raise WalkEnded("No pour was made.")
        return runs[-1]
