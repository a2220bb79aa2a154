"""A simulated controller, the real driver, and a short pour planned for them."""

from __future__ import annotations

import json
import threading
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import psutil

from core.errors import PoursightError
from core.imagination.pours import indentations_m, pivots_m, pour_directions_rad
from core.imagination.results import Footprint
from core.motion.pour.cell import MotionSettings
from core.motion.pour.plan import PourTarget
from core.parameters.imagination import PouringParameters
from core.progress import Reporter
from core.session.pour_runs import PourRun
from hardware.cell import CellSettings, open_arm, read_cell
from hardware.cell.scene import pour_cell
from hardware.driving import refuse_unready
from hardware.errors import RobotError, RobotLost
from hardware.pouring.pouring import Pouring
from tests.awake import AwakeClock, in_time

BOX_SIZE_M = np.array([0.12, 0.12, 0.07])
POURING = PouringParameters(settle_s=0.1, turn_s=1.0, wait_s=0.1)
QUICK = MotionSettings(
    joint_speed_rad_s=1.2,
    joint_acceleration_rad_s2=8.0,
    tool_speed_m_s=0.5,
    pour_joint_speed_rad_s=2.0,
    pour_acceleration_rad_s2=10.0,
    lift_m=0.06,
)
"""A pour of a few seconds: what is tested is the stopping, not the patience."""
MOST_BEGINNINGS = 3


def quick_cell(speed_up: float, version: str) -> CellSettings:
    settings = read_cell()
    simulation = settings.simulation.model_copy(update={"speed_up": speed_up, "controller_version": version})
    return settings.model_copy(update={"motion": QUICK, "simulation": simulation})


def a_target(settings: CellSettings) -> PourTarget:
    """A pour into a box in the middle of the platform."""
    center = settings.place.platform_center_m
    half = np.array([BOX_SIZE_M[0] / 2, BOX_SIZE_M[1] / 2, 0.0])
    aabb = np.array([center - half, center + half + [0.0, 0.0, BOX_SIZE_M[2]]])
    footprint = Footprint(np.array([*center[:2], aabb[1, 2] + POURING.pivot_height_m]), 0.0, np.ones(2))
    thetas = pour_directions_rad(footprint, POURING)
    pivots = pivots_m(footprint, thetas, indentations_m(aabb, POURING))
    i, j = 3, 0
    return PourTarget(aabb, i, j, float(thetas[i]), pivots[i, j], POURING, "digest of an imagination")


@dataclass
class Rig:
    """Everything one test needs; entering it connects."""

    session: Path
    speed_up: float = 6.0
    version: str = "3.15"
    robotiq: str | None = None

    def __enter__(self) -> Rig:
        self.settings = quick_cell(self.speed_up, self.version)
        if self.robotiq is not None:
            hand = {"kind": "robotiq", "model": self.robotiq}
            gripper = self.settings.gripper.model_copy(update=hand)
            self.settings = self.settings.model_copy(update={"gripper": gripper})
        self.arm = open_arm(self.settings)
        self.arm.__enter__()
        self.controller = self.arm.controller
        self.begin_again()
        return self

    def begin_again(self) -> None:
        self.reporter = Reporter()
        self.pouring = Pouring(
            self.arm, pour_cell(self.settings), a_target(self.settings), self.session, self.reporter
        )

    def __exit__(self, *exception: object) -> None:
        self.arm.__exit__(None, None, None)

    @property
    def is_moving(self) -> bool:
        return bool(json.loads(self.controller.command("state"))["is_moving"])

    @property
    def joints_rad(self) -> np.ndarray:
        return np.array(json.loads(self.controller.command("state"))["joints_rad"])

    @property
    def is_home(self) -> bool:
        away_rad = np.abs(self.joints_rad - np.array(self.settings.robot.home_rad)).max()
        return not self.pouring.is_interrupted and bool(away_rad < 2e-3)

    @property
    def is_fit_for_the_next_test(self) -> bool:
        """Whether the arm is home and accepts moves: a failed test must not make those after it fail."""
        with suppress(RobotError):
            refuse_unready(self.arm.robot.state())
            return self.is_home
        return False

    def pour_in_background(self) -> PourThread:
        thread = PourThread(self.pouring)
        thread.start()
        return thread

    def pour_until(self, name: str, share: float) -> PourThread:
        """Begin a pour and wait until about a share of a move's time has passed.

        A machine that stands still for too long loses the arm, as it should; then the pour is begun again.
        """
        for _ in range(MOST_BEGINNINGS):
            thread = self.pour_in_background()
            while thread.is_alive() and name not in self._moves_started(thread.run_before):
                time.sleep(0.005)
            if thread.is_alive():
                time.sleep(share * thread.duration_s(name) / self.speed_up)
                return thread
            if not isinstance(thread.error, RobotLost):
                break
            self.pouring.recover()
            self.pouring.back_off(self.pouring.plan_back_off())
        raise AssertionError(f"the move '{name}' never started: {thread.error!r}")

    def seconds_to_rest(self) -> float:
        with AwakeClock() as clock:
            started_s = clock.now_s()
            while self.is_moving:
                in_time(clock.now_s() - started_s, 5, "coming to rest")
            return clock.now_s() - started_s

    def _moves_started(self, run_before: Path | None) -> list[str]:
        """Of the present run: until it has a folder of its own, the newest one is an earlier run's."""
        folder = self.pouring.last_run
        if folder is None or folder == run_before:
            return []
        return [event["name"] for event in PourRun.load(folder).events if event["kind"] == "move"]


class PourThread(threading.Thread):
    """Plans and pours; stores the error."""

    def __init__(self, pouring: Pouring) -> None:
        super().__init__(daemon=True)
        self._pouring = pouring
        self.fresh = pouring.plan()
        self.run_before = pouring.last_run
        self.error: BaseException | None = None

    def run(self) -> None:
        try:
            self._pouring.carry_out(self.fresh)
        except PoursightError as error:
            self.error = error

    def duration_s(self, name: str) -> float:
        moves = {move.name: move.trajectory.duration_s for move in self.fresh.plan.moves}
        return moves[name]


def driver_pid() -> int:
    """The newest child that runs the driver's worker."""
    children = psutil.Process().children()
    spawned = [child for child in children if "multiprocessing.spawn" in " ".join(child.cmdline())]
    return max(spawned, key=lambda child: child.create_time()).pid
