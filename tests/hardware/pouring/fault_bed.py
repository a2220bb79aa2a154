"""A simulated controller and the real driver: into a phase of the work, a fault, and out of it again."""

from __future__ import annotations

import json
import os
import signal
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from core.errors import PoursightError
from core.session.pour_runs import PourRun
from hardware.errors import RobotError
from hardware.interfaces import ReadyStep
from hardware.pouring.run_log import RunLog
from hardware.scanning.moving import WatchedMoving
from hardware.scanning.views import name_views
from tests.hardware.pouring.rig import Rig, driver_pid
from tests.patience import wait_until

if TYPE_CHECKING:
    from app.operations.arm import Recoverable

PHASES = ("approach", "carry", "pour", "scan", "back-off")
WITH_CUP = ("carry", "pour", "back-off")
MOVES = {"approach": ("to the cup", 0.5), "carry": ("carry", 0.3), "pour": ("pour", 0.4)}
SIGNALS = {"driver killed": signal.SIGKILL, "driver frozen": signal.SIGSTOP}
MOVING_RAD_S = 0.15
SAID_WITHIN_S = 15.0
STOOD_WITHIN_S, TOLD_WITHIN_S = 0.3, 0.6
"""What is promised; a lost link is said later than the arm stands, for the driver looks again first."""
LASTING_S = 0.3
HURRIED = 6.0


@dataclass(frozen=True)
class Kind:
    """A fault: what repairs it, in which phases it can come, and whether the arm may go on."""

    repair: tuple[str, ...] = ()
    phases: tuple[str, ...] = PHASES
    goes_on: bool = False


KINDS = {
    "protective stop": Kind(),
    "emergency stop": Kind(("emergency release",)),
    "safety fault": Kind(),
    "program stop": Kind(),
    "program pause": Kind(),
    "power off": Kind(),
    "program hangs": Kind(),
    "foreign still": Kind(),
    "foreign moving": Kind(),
    "foreign gap still": Kind(),
    "foreign gap moving": Kind(),
    "stick 1 2 3 4 5 6": Kind(("unstick",)),
    "jump 2 0.03": Kind(),
    "output lost": Kind((), WITH_CUP),
    "force 80": Kind(("force 0",), WITH_CUP),
    "link drop": Kind(),
    "drop rtde 1": Kind(),
    "link silent": Kind(("link restore",)),
    "freeze": Kind(("thaw",)),
    "driver killed": Kind(),
    "driver frozen": Kind(),
    "latency 20 10": Kind(("link restore",), ("carry",), goes_on=True),
    "dashboard delay 2": Kind(("dashboard delay 0",), ("carry",), goes_on=True),
    "drop dashboard": Kind((), ("carry",), goes_on=True),
    "slider 0.5": Kind(("slider 1",), ("carry",), goes_on=True),
    "reduced": Kind(("normal",), ("carry",), goes_on=True),
}


@dataclass(frozen=True)
class Took:
    """One fault: what was said of it after how long, and how long until the arm stood; none: not measured."""

    name: str
    said: str
    said_s: float | None
    rested_s: float | None

    @property
    def is_late(self) -> bool:
        """Whether it took longer than is promised."""
        return (self.rested_s or 0.0) > STOOD_WITHIN_S or (self.said_s or 0.0) > TOLD_WITHIN_S


@dataclass
class Row:
    """What was measured of one kind."""

    rested_s: list[float] = field(default_factory=list)
    said_s: list[float] = field(default_factory=list)
    said: dict[str, str] = field(default_factory=dict)
    failures: list[str] = field(default_factory=list)
    n_poured: int = 0

    @property
    def n_tried(self) -> int:
        """In all."""
        return len(self.failures) + self.n_poured

    def note(self, phase: str, took: Took) -> None:
        """After a whole pour: keep what was measured; being late is a failure all the same."""
        self.said[phase] = took.said
        self.said_s += [] if took.said_s is None else [took.said_s]
        self.rested_s += [] if took.rested_s is None else [took.rested_s]
        if took.is_late:
            self.failures.append(
                f"{took.name} in {phase}: stood after {took.rested_s}, said after {took.said_s} s"
            )
        else:
            self.n_poured += 1


class Doing(threading.Thread):
    """Something that moves the arm; keeps the error, and when it ended."""

    def __init__(self, work: Callable[[], object]) -> None:
        super().__init__(daemon=True)
        self._work = work
        self.error: PoursightError | None = None
        self.ended_s = 0.0

    def run(self) -> None:
        try:
            self._work()
        except PoursightError as error:
            self.error = error
        self.ended_s = time.monotonic()


class Bed:
    """A rig that is driven into each phase, and out of it again."""

    def __init__(self, rig: Rig, folder: Path) -> None:
        self.rig = rig
        self._log = RunLog(folder / "scan")
        settings = rig.settings
        far = (settings.scan.views_rad[0], settings.robot.home_rad)
        self._far, self._home = name_views(far)
        self.pace(HURRIED)

    def pace(self, factor: float) -> None:
        self.rig.controller.command(f"pace {factor:g}")

    def begin(self, phase: str) -> Doing:
        """Something moves the arm in a phase when this returns, at the real pace."""
        if phase == "scan":
            doing = Doing(lambda: self._go(self._far))
        elif phase == "back-off":
            self._stopped_in("carry")
            self.rig.pouring.recover()
            moves = self.rig.pouring.plan_back_off()
            doing = Doing(lambda: self.rig.pouring.back_off(moves))
        else:
            fresh = self.rig.pouring.plan()
            doing = Doing(lambda: self.rig.pouring.carry_out(fresh))
        before = self.rig.pouring.last_run
        doing.start()
        if phase in MOVES:
            wait_until(lambda: not doing.is_alive() or self._is_in(MOVES[phase][0], before), 60)
        wait_until(lambda: not doing.is_alive() or self._speed() > MOVING_RAD_S, 60)
        self.pace(1)
        return doing

    def recover(self, phase: str) -> None:
        """Come back, and pour; each confirmed in the program."""
        self.pace(HURRIED)
        if phase == "scan":
            self._make_ready(self.rig.arm.robot)
            self._go(self._home)
        else:
            self._make_ready(self.rig.pouring)
            if self.rig.pouring.is_interrupted:
                self.rig.pouring.back_off(self.rig.pouring.plan_back_off())
        assert self.rig.is_home, "it did not come home"
        assert PourRun.load(self.rig.pouring.carry_out(self.rig.pouring.plan())).is_done

    def start_anew(self) -> None:
        """After a failure: another controller and another driver."""
        with suppress(PoursightError):
            self.rig.__exit__(None, None, None)
        self.rig.__enter__()
        self.pace(HURRIED)

    def _make_ready(self, stopped: Recoverable) -> None:
        """With every step that is asked about."""
        for _ in ReadyStep:
            try:
                stopped.recover()
                return
            except RobotError:
                pending = self.rig.arm.robot.pending_step()
                if pending is None:
                    raise
                stopped.take_step(pending[0])
        stopped.recover()

    def _stopped_in(self, phase: str) -> None:
        doing = self.begin(phase)
        self.rig.controller.command("program stop")
        doing.join(SAID_WITHIN_S)
        self.pace(HURRIED)

    def _go(self, view) -> None:
        moving = WatchedMoving(self.rig.arm, self._log, self.rig.reporter, lambda _: "confirmed")
        moving.prepare([view])
        moving.go(view)

    def _is_in(self, move: str, before: Path | None) -> bool:
        folder = self.rig.pouring.last_run
        if folder is None or folder == before:
            return False
        names = [event["name"] for event in PourRun.load(folder).events if event["kind"] == "move"]
        return move in names

    def _speed(self) -> float:
        return float(np.abs(json.loads(self.rig.controller.command("state"))["speeds_rad_s"]).max())


def try_one(bed: Bed, name: str, phase: str, row: Row) -> None:
    """One fault in one phase, with everything after it."""
    began_s = time.monotonic()
    outcome = "too late"
    for is_last in (False, False, True):
        try:
            took = one_fault(bed, name, phase)
            if not is_last and took.is_late:
                continue  # that may be the machine's fault: all that a busy one can do is to lengthen it
            row.note(phase, took)
            outcome = row.failures[-1] if took.is_late else "ok"
        except Exception as error:
            outcome = f"{name} in {phase}: {error!r}"
            row.failures.append(outcome)
            bed.start_anew()
        break
    print(f"{name} in {phase}: {outcome} ({time.monotonic() - began_s:.0f} s)", flush=True)


def seconds_to_lasting_rest(rig: Rig) -> float:
    """From now until the arm stands for good; another program may let it stand for a moment."""
    began_s = last_s = time.monotonic()
    while (now_s := time.monotonic()) - last_s < LASTING_S:
        if rig.is_moving:
            last_s = now_s
        assert now_s - began_s < SAID_WITHIN_S, "the arm does not come to rest"
    return last_s - began_s


def one_fault(bed: Bed, name: str, phase: str) -> Took:
    rig, kind = bed.rig, KINDS[name]
    doing = bed.begin(phase)
    assert doing.is_alive(), f"it never came to the fault: {doing.error!r}"
    began_s, said, said_s, rested_s = time.monotonic(), "(goes on)", None, None
    if name in SIGNALS:
        os.kill(driver_pid(), SIGNALS[name])
    else:
        rig.controller.command(name)
    if kind.goes_on:
        doing.join(60)
        assert not doing.is_alive(), "it did not end"
        assert doing.error is None, repr(doing.error)
    else:
        rested_s = None if name == "freeze" else seconds_to_lasting_rest(rig)
        doing.join(SAID_WITHIN_S)
        assert not doing.is_alive(), "it neither ended nor was it said"
        assert doing.error is not None, "it was not noticed"
        said, said_s = str(doing.error), doing.ended_s - began_s
    for line in kind.repair:
        rig.controller.command(line)
    wait_until(lambda: not rig.is_moving, 5)
    before = rig.joints_rad
    time.sleep(0.2)
    assert np.abs(rig.joints_rad - before).max() < 1e-4, "it went on by itself"
    bed.recover(phase)
    return Took(name, said, said_s, rested_s)
