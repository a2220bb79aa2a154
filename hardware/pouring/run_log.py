"""What happened during one pour, written as it happens, so that even a crash leaves a readable run."""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Collection
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path
from types import TracebackType
from typing import Any, TextIO

import numpy as np

from core.geometry import FloatArray, make_pose
from core.imagination.cup import pivot_in_cup_m
from core.motion.arm_models import ArmModel
from core.motion.kinematics import flange_pose
from core.motion.pour.plan import Segment
from core.parameters.bodies import CupParameters
from core.session import explained
from core.session.pour_runs import EVENTS_FILE, STATES_FILE
from core.session.swapping import flush_entry
from hardware.interfaces import RobotState

STATE_EVERY_S = 0.039
"""25 states per second by the controller's clock: five of its cycles of 8 ms, less some rounding."""
_MADE = 2
"""Folders above a run's: its session, and the folder of all its runs, which may be new."""
_COLUMNS = (
    "time_s",
    "move",
    *(f"joint_{k}_rad" for k in range(1, 7)),
    *(f"target_{k}_rad" for k in range(1, 7)),
    *(f"speed_{k}_rad_s" for k in range(1, 7)),
    "tool_x_m",
    "tool_y_m",
    "tool_z_m",
    "robot_mode",
    "safety_mode",
    "program_running",
    "output_0",
    "output_1",
    "speed_scaling",
)


class RunLog:
    """Writes events (one JSON a line) and states (CSV) of one run into its folder.

    Attributes:
        folder: of the run.
    """

    def __init__(self, folder: Path) -> None:
        """Start in a folder, which is created.

        Raises:
            SessionError: it cannot be written.
        """
        self.folder = folder
        self._last_state_s = float("-inf")
        with explained(folder):
            folder.mkdir(parents=True, exist_ok=True)
            self._events: TextIO = (folder / EVENTS_FILE).open("a", encoding="utf-8")
            self._states: TextIO = (folder / STATES_FILE).open("a", encoding="utf-8", newline="")
            self._table = csv.writer(self._states)
            if self._states.tell() == 0:
                self._table.writerow(_COLUMNS)
            for place in (folder, *list(folder.parents)[:_MADE]):
                flush_entry(place)  # an event is of no use in a file whose name a power cut takes away

    def __enter__(self) -> RunLog:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._events.close()
        self._states.close()

    def event(self, kind: str, sentence: str, **facts: Any) -> None:
        """Log an event; it is on the disk when this returns.

        Args:
            kind: in a word, such as "move" or "stopped".
            sentence: as shown to the user.
            facts: plain JSON values.
        """
        now = datetime.now(timezone.utc).isoformat(timespec="milliseconds")
        line = json.dumps({"time": now, "kind": kind, "sentence": sentence, **facts})
        with explained(self.folder):
            self._events.write(line + "\n")
            self._events.flush()
            os.fsync(self._events.fileno())

    def stopped(self, error: BaseException, joints_rad: FloatArray | None, **facts: Any) -> None:
        """Log what stopped the arm, and where (6,) it is at rest; none if it does not answer."""
        where = None if joints_rad is None else joints_rad.tolist()
        kind = type(error).__name__
        self.event("stopped", str(error) or kind, error=kind, joints_rad=where, **facts)

    def state(self, move: str, state: RobotState) -> None:
        """Log a state of the robot, if the last one is old enough by the controller's clock."""
        if state.controller_s - self._last_state_s < STATE_EVERY_S:
            return
        self._last_state_s = state.controller_s
        numbers = (*state.joints_rad, *state.target_joints_rad, *state.joint_speeds_rad_s)
        row = (
            f"{state.controller_s:.4f}",
            move,
            *(f"{number:.6f}" for number in (*numbers, *state.T_base_tool[:3, 3])),
            int(state.robot_mode),
            int(state.safety_mode),
            int(state.is_program_running),
            *map(int, state.tool_outputs),
            f"{state.speed_scaling:.3f}",
        )
        with explained(self.folder):
            self._table.writerow(row)
            self._states.flush()


@dataclass(frozen=True)
class DrivenStates:
    """Joint positions that the controller reported.

    Attributes:
        times_s: (N,) by the controller's clock.
        joints_rad: (N, 6).
    """

    times_s: FloatArray
    joints_rad: FloatArray


def read_states(folder: Path, segments: Collection[str]) -> DrivenStates:
    """Read the states of a run that were logged during these segments."""
    with (folder / STATES_FILE).open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["move"] in segments]
    joints = [[float(row[f"joint_{k}_rad"]) for k in range(1, 7)] for row in rows]
    return DrivenStates(np.array([float(row["time_s"]) for row in rows]), np.array(joints).reshape(-1, 6))


def driven_pivot_error_m(
    folder: Path, arm: ArmModel, T_flange_cup: FloatArray, cup: CupParameters, pivot_m: FloatArray
) -> float:
    """Largest displacement of the pivot during the pour rotation of a run, by the reported joints.

    Args:
        folder: of the run.
        arm: its kinematics.
        T_flange_cup: (4, 4) the cup in the hand.
        cup: its dimensions.
        pivot_m: (3,) r_pivot in the base frame.
    """
    joints_rad = read_states(folder, {Segment.POUR}).joints_rad
    T_flange_pivot = T_flange_cup @ make_pose(np.eye(3), pivot_in_cup_m(cup))
    pivots_m = (flange_pose(arm, joints_rad) @ T_flange_pivot)[:, :3, 3]
    return float(np.linalg.norm(pivots_m - pivot_m, axis=1).max(initial=0.0))
