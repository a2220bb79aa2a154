"""Straight moves in joint space: are they clear, and why not."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray
from core.motion.clearance import MotionScene
from core.motion.kinematics import within_limits

STEP_RAD = np.radians(1.0)
"""No joint turns more between two samples of a path: on a reach of 0.95 m the flange moves 17 mm at most."""
JOINT_NAMES = ("base", "shoulder", "elbow", "wrist 1", "wrist 2", "wrist 3")


class Obstruction(Enum):
    """What is wrong with a path."""

    LIMIT = "limit"
    CLEARANCE = "clearance"


@dataclass(frozen=True)
class PathProblem:
    """The first place on a path that the arm must not go to.

    Attributes:
        reason: which kind of problem.
        between: names of what comes too near to each other, or the joint and "its limit".
        segment: index of the straight move, from 0.
        share: of the move that is clear, 0 to 1.
        joints_rad: (6,) the configuration there.
        distance_m: the clearance there, negative if the two overlap; nan for a limit.
    """

    reason: Obstruction
    between: tuple[str, str]
    segment: int
    share: float
    joints_rad: FloatArray
    distance_m: float

    @property
    def what(self) -> str:
        """The problem without its place."""
        if self.reason is Obstruction.LIMIT:
            return f"the {self.between[0]} joint is beyond its limit"
        room = f"{self.distance_m * 1000:.0f} mm" if self.distance_m > 0 else "no room"
        return f"{room} between {self.between[0]} and {self.between[1]}"

    def __str__(self) -> str:
        return f"{self.what} {self.share:.0%} along move {self.segment + 1}"


@dataclass(frozen=True)
class PathCheck:
    """Whether a path may be driven.

    Attributes:
        problem: the first one, or `None`.
        clearance_m: the smallest distance on the way up to a problem's place, and there; inf if none was
        measured.
    """

    problem: PathProblem | None
    clearance_m: float

    @property
    def is_clear(self) -> bool:
        """Whether there is no problem."""
        return self.problem is None


def check_path(scene: MotionScene, configurations_rad: npt.ArrayLike, min_clearance_m: float) -> PathCheck:
    """Check straight joint moves through configurations (M, 6), M at least 1, sampled at most 1 degree apart.

    Args:
        scene: the arm and what stands around it.
        configurations_rad: (M, 6) where to pass, in this order.
        min_clearance_m: what must stay between any two things.
    """
    corners = np.atleast_2d(np.asarray(configurations_rad, dtype=float))
    smallest = np.inf
    for k in range(max(len(corners) - 1, 1)):
        samples = sample_move(corners[k], corners[min(k + 1, len(corners) - 1)])
        beyond = _beyond_limits(scene, samples, k)
        if beyond is not None:
            return PathCheck(beyond, smallest)
        clearance = scene.clearance(samples)
        near = clearance.distance_m < min_clearance_m
        if near.any():
            i = int(near.argmax())
            distance = float(clearance.distance_m[i])
            share = i / max(len(samples) - 1, 1)
            problem = PathProblem(Obstruction.CLEARANCE, clearance.nearest(i), k, share, samples[i], distance)
            return PathCheck(problem, min(smallest, float(clearance.distance_m[: i + 1].min())))
        smallest = min(smallest, float(clearance.distance_m.min()))
    return PathCheck(None, smallest)


def sample_move(start_rad: FloatArray, goal_rad: FloatArray, step_rad: float = STEP_RAD) -> FloatArray:
    """Configurations (K, 6) on a straight joint move, both ends included, no joint turning more than a
    step.
    """
    n_steps = int(np.ceil(np.abs(goal_rad - start_rad).max() / step_rad))
    return np.asarray(start_rad + np.linspace(0, 1, n_steps + 1)[:, None] * (goal_rad - start_rad))


def shorten(scene: MotionScene, way_rad: FloatArray, min_clearance_m: float) -> FloatArray:
    """From each corner of a clear way (M, 6), go straight to the farthest one that is clear."""
    corners = [0]
    while corners[-1] < len(way_rad) - 1:
        here = corners[-1]
        for there in range(len(way_rad) - 1, here, -1):
            if there == here + 1 or check_path(scene, way_rad[[here, there]], min_clearance_m).is_clear:
                corners.append(there)
                break
    return way_rad[corners]


def _beyond_limits(scene: MotionScene, samples: FloatArray, segment: int) -> PathProblem | None:
    inside = within_limits(scene.arm, samples)
    if inside.all():
        return None
    i = int((~inside).any(axis=1).argmax())
    joint = JOINT_NAMES[int((~inside[i]).argmax())]
    share = i / max(len(samples) - 1, 1)
    return PathProblem(Obstruction.LIMIT, (joint, "its limit"), segment, share, samples[i], float("nan"))
