"""The moves that `movePath` puts into the control script, and the trajectory that they make."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray, invert_pose
from core.motion.arm_models import ArmModel
from core.motion.kinematics import flange_pose
from hardware.robots.joint_motion import JointMotion
from hardware.robots.ur.pose_vectors import pose_from_vector
from hardware.simulation.ur_controller.motions import StraightLine, Trajectory

_MOVE = re.compile(r"^\s*(movej|movel|movep)\((p?)\[([^\]]*)\]([^)]*)\)", re.MULTILINE)
_MARKER = "# inject move path"
_BISECTIONS = 10


@dataclass(frozen=True)
class PathMove:
    """One line of the script.

    Attributes:
        is_joint_move: straight in joint space (movej), else in space (movel, movep).
        target: (6,) joint angles, or the tool's pose vector if `is_pose`.
        is_pose: what the target is.
        speed, acceleration: in rad or m, per second.
        blend_m: how far from the target the next move may begin.
    """

    is_joint_move: bool
    target: tuple[float, ...]
    is_pose: bool
    speed: float
    acceleration: float
    blend_m: float


def injected_moves(script: str) -> list[PathMove]:
    """Return the moves between the script's marker and the end of the function that holds it."""
    _, marker, rest = script.partition(_MARKER)
    body = rest.split("\n    end", 1)[0] if marker else ""
    return [_parse(*match.groups()) for match in _MOVE.finditer(body)]


def _parse(command: str, pose_mark: str, numbers: str, options: str) -> PathMove:
    option = dict(re.findall(r"([avr])\s*=\s*([-+.\deE]+)", options))
    target = tuple(float(number) for number in numbers.split(","))
    return PathMove(command == "movej", target, bool(pose_mark), float(option.get("v", 1.05)),
                    float(option.get("a", 1.4)), float(option.get("r", 0.0)))  # fmt: skip


class BlendedPath:
    """Moves in a row; where a blend is allowed, the next begins while the last one slows down.

    In a blend both displacements add up, so the joints pass the corner within its radius without stopping.

    Attributes:
        duration_s: from rest to rest.
        starts_s: when each move begins.
    """

    def __init__(
        self,
        position: Callable[[FloatArray], FloatArray],
        pieces: Sequence[Trajectory],
        corners_rad: FloatArray,
        blends_m: Sequence[float],
    ) -> None:
        """Join pieces, each from rest to rest.

        Args:
            position: the tool's places (N, 3) for joints (N, 6).
            pieces: N of them.
            corners_rad: (N, 6) where each begins.
            blends_m: N radii; the last one has no meaning.
        """
        self._pieces, self._corners = pieces, corners_rad
        self.starts_s = [0.0]
        for k in range(len(pieces) - 1):
            overlap_s = _overlap(position, pieces[k], pieces[k + 1], corners_rad[k + 1], blends_m[k])
            self.starts_s.append(self.starts_s[k] + pieces[k].duration_s - overlap_s)
        self.duration_s = self.starts_s[-1] + pieces[-1].duration_s

    def at(self, time_s: float) -> tuple[FloatArray, FloatArray, float]:
        """Return the joints, their speeds, and how many moves have begun before this one."""
        last = max(k for k, start_s in enumerate(self.starts_s) if start_s <= max(time_s, 0.0))
        joints, speeds, _ = self._pieces[last].at(time_s - self.starts_s[last])
        if last > 0:
            before, before_speeds, _ = self._pieces[last - 1].at(time_s - self.starts_s[last - 1])
            joints = joints + (before - self._corners[last])
            speeds = speeds + before_speeds
        return joints, speeds, float(last)


def _overlap(
    position: Callable[[FloatArray], FloatArray],
    before: Trajectory,
    after: Trajectory,
    corner_rad: FloatArray,
    blend_m: float,
) -> float:
    """How long the two may overlap so that both are within the blend radius of the corner meanwhile."""
    if blend_m <= 0:
        return 0.0

    def is_near(time_s: float) -> bool:
        joints = corner_rad, before.at(before.duration_s - time_s)[0], after.at(time_s)[0]
        corner, *places = position(np.stack(joints))
        return all(float(np.linalg.norm(place - corner)) <= blend_m for place in places)

    # Half of each at most, so that never more than two overlap.
    low_s, high_s = 0.0, min(before.duration_s, after.duration_s) / 2
    if is_near(high_s):
        return high_s
    for _ in range(_BISECTIONS):
        middle_s = (low_s + high_s) / 2
        low_s, high_s = (middle_s, high_s) if is_near(middle_s) else (low_s, middle_s)
    return low_s


def plan_path(
    arm: ArmModel, T_flange_tcp: FloatArray, moves: Sequence[PathMove], start_rad: FloatArray
) -> BlendedPath:
    """Plan the moves from a configuration on.

    Raises:
        NoSolution: one of them is out of reach.
    """
    pieces: list[Trajectory] = []
    corners = [start_rad]
    for move in moves:
        speed, acceleration = max(move.speed, 1e-3), max(move.acceleration, 1e-3)
        if move.is_pose:
            T_flange = pose_from_vector(move.target) @ invert_pose(T_flange_tcp)
        else:
            T_flange = flange_pose(arm, np.array(move.target))
        if move.is_joint_move and not move.is_pose:
            end = np.array(move.target)
            pieces.append(JointMotion(np.stack([corners[-1], end]), speed, acceleration))
        else:
            line = StraightLine(arm, corners[-1], T_flange, speed, acceleration)
            end = line.end_rad
            pieces.append(
                JointMotion(np.stack([corners[-1], end]), speed, acceleration) if move.is_joint_move else line
            )
        corners.append(end)

    def position(joints: FloatArray) -> FloatArray:
        places: FloatArray = (flange_pose(arm, joints) @ T_flange_tcp)[..., :3, 3]
        return places

    return BlendedPath(position, pieces, np.array(corners[:-1]), [move.blend_m for move in moves])
