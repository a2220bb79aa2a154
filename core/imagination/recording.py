"""Recorded particle poses, from which an imagination is replayed without being simulated again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from core.geometry import AnyArray

POSITION_STEP_M = 1e-4
"""Positions are kept in steps of 0.1 mm, finer than a picture shows, in 16 bits: 3.2 m each way."""
QUATERNION_STEP = 1 / 32_767

Float32Array = npt.NDArray[np.float32]


@dataclass(frozen=True)
class Recording:
    """Poses of N particles and of one moving body (object or cup) at K moments.

    Attributes:
        time_s: (K,) seconds since the start.
        positions_m: (K, N, 3) particle centres in the frame of the reconstruction; NaN while a particle is
            not there (not yet poured, or fallen and removed).
        quaternions: (K, N, 4) particle orientations, (x, y, z, w).
        T_world_body: (K, 4, 4) pose of the moving body.
    """

    time_s: Float32Array
    positions_m: Float32Array
    quaternions: Float32Array
    T_world_body: Float32Array

    def to_arrays(self, prefix: str = "") -> dict[str, AnyArray]:
        """Return compact arrays for storage, about 14 bytes for each particle and moment."""
        steps = np.nan_to_num(self.positions_m / POSITION_STEP_M, nan=-32_768)
        return {
            f"{prefix}time_s": self.time_s,
            f"{prefix}position_steps": np.clip(np.rint(steps), -32_768, 32_767).astype(np.int16),
            f"{prefix}quaternion_steps": np.rint(self.quaternions / QUATERNION_STEP).astype(np.int16),
            f"{prefix}T_world_body": self.T_world_body,
        }

    @classmethod
    def from_arrays(cls, arrays: dict[str, AnyArray], prefix: str = "") -> Recording:
        """Read what `to_arrays` gave."""
        steps = arrays[f"{prefix}position_steps"].astype(np.float32)
        steps[steps == -32_768] = np.nan
        return cls(
            arrays[f"{prefix}time_s"],
            steps * np.float32(POSITION_STEP_M),
            arrays[f"{prefix}quaternion_steps"].astype(np.float32) * np.float32(QUATERNION_STEP),
            arrays[f"{prefix}T_world_body"],
        )


class Recorder:
    """Collects the moments of a `Recording`."""

    def __init__(self, n_particles: int) -> None:
        self._n = n_particles
        self._times: list[float] = []
        self._poses: list[AnyArray] = []
        self._bodies: list[AnyArray] = []

    def add(self, time_s: float, poses: AnyArray, T_world_body: AnyArray) -> None:
        """Add a moment: `poses` (N, 7) holds position and quaternion, NaN for an absent particle."""
        self._times.append(time_s)
        self._poses.append(poses.astype(np.float32))
        self._bodies.append(T_world_body.astype(np.float32))

    def recording(self) -> Recording:
        """Return all moments so far."""
        poses = np.array(self._poses, dtype=np.float32).reshape(-1, self._n, 7)
        return Recording(
            np.array(self._times, dtype=np.float32),
            poses[:, :, :3],
            np.nan_to_num(poses[:, :, 3:]),
            np.array(self._bodies, dtype=np.float32).reshape(-1, 4, 4),
        )
