"""The path on which the arm really took the cup, as its controller reported it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.errors import InputError
from core.geometry import BoolArray, FloatArray, rotation_error
from core.motion.arm_models import ArmModel
from core.motion.kinematics import flange_pose

_ROTATION_TOLERANCE = 1e-3
_RESTING_M = 0.0002
"""Below what a candy in the cup can feel, above what the encoders of an arm at rest report."""
_RESTING_RAD = 0.001
_REST_AT_ENDS_S = 0.2
"""Rest that stays at both ends, so that the motion begins and ends at rest."""


@dataclass(frozen=True)
class DrivenPath:
    """Poses of the cup over time; between them it moves straight and rotates evenly.

    Attributes:
        times_s: (N,) strictly rising, N at least 2.
        T_base_cup: (N, 4, 4) poses of the cup's frame (origin at the outer centre of its base, z to its
            mouth) in the robot's base frame.

    Raises:
        InputError: the arrays do not fit each other, times do not rise, or a matrix is no pose.
    """

    times_s: FloatArray
    T_base_cup: FloatArray

    def __post_init__(self) -> None:
        n = len(self.times_s)
        if n < 2 or self.T_base_cup.shape != (n, 4, 4):
            raise InputError(
                f"A driven path needs at least two times with a 4x4 pose each, not {n} times with poses of "
                f"shape {self.T_base_cup.shape}; record the arm while it moves."
            )
        if not (np.isfinite(self.times_s).all() and np.isfinite(self.T_base_cup).all()):
            raise InputError("The driven path holds values that are not finite; record the pour again.")
        if (np.diff(self.times_s) <= 0).any():
            at = int(np.argmax(np.diff(self.times_s) <= 0)) + 1
            raise InputError(
                f"The times of the driven path do not rise at sample {at} ({self.times_s[at]} s); sort the "
                "recorded states by the controller's time."
            )
        if max(rotation_error(pose[:3, :3]) for pose in self.T_base_cup) > _ROTATION_TOLERANCE:
            raise InputError("The driven path holds a matrix that is no pose; check T_flange_cup.")

    @property
    def duration_s(self) -> float:
        """From the first to the last sample."""
        return float(self.times_s[-1] - self.times_s[0])

    def at(self, times_s: FloatArray) -> FloatArray:
        """Return `T_base_cup` (K, 4, 4) at times (K,): linear and slerp; the ends before and after."""
        from scipy.spatial.transform import Rotation, Slerp

        times = np.clip(times_s, self.times_s[0], self.times_s[-1])
        poses = np.tile(np.eye(4), (len(times), 1, 1))
        for k in range(3):
            poses[:, k, 3] = np.interp(times, self.times_s, self.T_base_cup[:, k, 3])
        rotations = Rotation.from_matrix(self.T_base_cup[:, :3, :3])
        poses[:, :3, :3] = Slerp(self.times_s, rotations)(times).as_matrix()
        return poses

    def in_hand(self, T_cup_slipped: FloatArray) -> DrivenPath:
        """Return the path of a cup that sits at `T_cup_slipped` (4, 4) of where it is believed."""
        return DrivenPath(self.times_s, self.T_base_cup @ T_cup_slipped)

    def trimmed(self) -> DrivenPath:
        """Return the path without long rests at its ends: nothing happens in the cup there."""
        away_from_start, away_from_end = (np.flatnonzero(~self._is_at(end)) for end in (0, -1))
        if len(away_from_start) == 0 or len(away_from_end) == 0:
            return self
        first = self.times_s[away_from_start[0]] - _REST_AT_ENDS_S
        last = self.times_s[away_from_end[-1]] + _REST_AT_ENDS_S
        moving = (self.times_s >= first) & (self.times_s <= last)
        return DrivenPath(self.times_s[moving], self.T_base_cup[moving])

    def _is_at(self, sample: int) -> BoolArray:
        """Whether the cup is (N,) where it is at `sample`, but for what the encoders' noise does."""
        there = self.T_base_cup[sample]
        away_m = np.linalg.norm(self.T_base_cup[:, :3, 3] - there[:3, 3], axis=1)
        # The Frobenius norm of R1 - R2 is 2 sqrt(2) sin(angle / 2).
        rotated = np.linalg.norm(self.T_base_cup[:, :3, :3] - there[:3, :3], axis=(1, 2)) / np.sqrt(2)
        is_there: BoolArray = (away_m < _RESTING_M) & (rotated < _RESTING_RAD)
        return is_there


@dataclass(frozen=True)
class CupMotion:
    """A path in physics steps: where the cup is at each, and the velocities that take it to the next.

    Attributes:
        times_s: (K,) on the path's clock.
        T_base_cup: (K, 4, 4) poses of the cup's frame.
        quaternions: (K, 4) their rotations, (x, y, z, w).
        velocities_m_s: (K, 3) of the frame's origin; zero at the last.
        angular_velocities_rad_s: (K, 3); zero at the last.
    """

    times_s: FloatArray
    T_base_cup: FloatArray
    quaternions: FloatArray
    velocities_m_s: FloatArray
    angular_velocities_rad_s: FloatArray


def driven_path(
    arm: ArmModel, times_s: FloatArray, joints_rad: FloatArray, T_flange_cup: FloatArray
) -> DrivenPath:
    """Return the cup's path from what the controller reported.

    A state that was read twice (the same time) counts once.

    Args:
        arm: whose kinematics.
        times_s: (N,) the controller's time of each state.
        joints_rad: (N, 6) the actual joint angles.
        T_flange_cup: (4, 4) pose of the cup in the hand.

    Raises:
        InputError: fewer than two states, times that fall, or values that are not finite.
    """
    is_new = np.concatenate([[True], np.diff(times_s) != 0])
    return DrivenPath(times_s[is_new], flange_pose(arm, joints_rad[is_new]) @ T_flange_cup)


def cup_motion(path: DrivenPath, rate_hz: float) -> CupMotion:
    """Cut a path into steps of 1 / `rate_hz`."""
    from scipy.spatial.transform import Rotation

    steps = int(np.ceil(path.duration_s * rate_hz - 1e-9))
    times_s = path.times_s[0] + np.arange(steps + 1) / rate_hz
    poses = path.at(times_s)
    positions, rotations = poses[:, :3, 3], Rotation.from_matrix(poses[:, :3, :3])
    rest = np.zeros((1, 3))
    return CupMotion(
        times_s,
        poses,
        rotations.as_quat(),
        np.vstack([np.diff(positions, axis=0) * rate_hz, rest]),
        np.vstack([(rotations[1:] * rotations[:-1].inv()).as_rotvec() * rate_hz, rest]),
    )
