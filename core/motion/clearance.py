"""How far the arm stays from what stands around it, and from itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray, IntArray, make_pose
from core.motion.arm_models import ArmModel
from core.motion.arm_shape import ArmShape, Capsule
from core.motion.distances import segment_box_distance, segment_segment_distance
from core.motion.kinematics import link_poses

_CHUNK = 1000
"""Configurations at a time: about 100 MB of intermediate values."""


@dataclass(frozen=True)
class Obstacle:
    """A box that the arm must not touch.

    Attributes:
        name: as a person would call it.
        T_base_box: (4, 4) pose of its middle.
        size_m: (3,) its sides.
        exempt: names of the arm's parts that may touch it, such as the base on its table.
    """

    name: str
    T_base_box: FloatArray
    size_m: tuple[float, float, float]
    exempt: frozenset[str] = frozenset()


def axis_aligned_obstacle(
    name: str, min_m: npt.ArrayLike, max_m: npt.ArrayLike, exempt: frozenset[str] = frozenset()
) -> Obstacle:
    """A box (3,) to (3,) along the axes of the base frame."""
    low, high = np.asarray(min_m, dtype=float), np.asarray(max_m, dtype=float)
    x, y, z = (high - low).tolist()
    return Obstacle(name, make_pose(np.eye(3), (low + high) / 2), (x, y, z), exempt)


@dataclass(frozen=True)
class Clearance:
    """How near N configurations come to anything.

    Attributes:
        distance_m: (N,) the smallest distance; negative where something overlaps.
        pair: (N,) which pair that is, as an index into `pair_names`.
        pair_names: the arm's part, and the obstacle or the arm's other part.
    """

    distance_m: FloatArray
    pair: IntArray
    pair_names: tuple[tuple[str, str], ...]

    def nearest(self, k: int) -> tuple[str, str]:
        """Names of the two that are nearest in configuration `k`."""
        return self.pair_names[self.pair[k]]


class MotionScene:
    """An arm with its tools among obstacles: everything that a motion is checked against."""

    def __init__(self, arm: ArmModel, shape: ArmShape, obstacles: Sequence[Obstacle]) -> None:
        self.arm = arm
        self.shape = shape
        self.obstacles = tuple(obstacles)
        capsules = shape.capsules
        self._links = np.array([capsule.link for capsule in capsules])
        self._ends_m = np.array([(capsule.start_m, capsule.end_m) for capsule in capsules])
        self._radii_m = np.array([capsule.radius_m for capsule in capsules])
        self._self_pairs = np.array(shape.pairs, dtype=int).reshape(-1, 2)
        self._box_pairs = _box_pairs(capsules, self.obstacles)
        self._T_box_base = np.array([np.linalg.inv(box.T_base_box) for box in self.obstacles]).reshape(
            -1, 4, 4
        )
        self._half_sizes_m = np.array([box.size_m for box in self.obstacles]).reshape(-1, 3) / 2
        self._pair_names = tuple(
            [(capsules[i].name, capsules[j].name) for i, j in self._self_pairs]
            + [(capsules[i].name, self.obstacles[j].name) for i, j in self._box_pairs]
        )

    def clearance(self, joints_rad: npt.ArrayLike) -> Clearance:
        """Return the smallest distances of configurations (N, 6); exact for the capsules and boxes."""
        joints = np.asarray(joints_rad, dtype=float)
        parts = [self._distances(joints[k : k + _CHUNK]) for k in range(0, len(joints), _CHUNK)]
        distances = np.concatenate(parts)
        pair = distances.argmin(axis=1)
        return Clearance(distances[np.arange(len(joints)), pair], pair, self._pair_names)

    def _distances(self, joints: FloatArray) -> FloatArray:
        """Distances (N, P) of all pairs."""
        poses = link_poses(self.arm, joints)[:, self._links]
        ends = self._ends_m @ np.swapaxes(poses[..., :3, :3], -1, -2) + poses[..., None, :3, 3]
        return np.concatenate([self._to_itself(ends), self._to_boxes(ends)], axis=1)

    def _to_itself(self, ends: FloatArray) -> FloatArray:
        i, j = self._self_pairs.T
        between = segment_segment_distance(ends[:, i, 0], ends[:, i, 1], ends[:, j, 0], ends[:, j, 1])
        return np.asarray(between - self._radii_m[i] - self._radii_m[j])

    def _to_boxes(self, ends: FloatArray) -> FloatArray:
        i, j = self._box_pairs.T
        T = self._T_box_base[j]
        in_box = ends[:, i] @ np.swapaxes(T[:, :3, :3], -1, -2) + T[:, None, :3, 3]
        half_sizes = np.broadcast_to(self._half_sizes_m[j], (len(ends), len(j), 3))
        distance = segment_box_distance(in_box[:, :, 0], in_box[:, :, 1], half_sizes)
        return np.asarray(distance - self._radii_m[i])


def _box_pairs(capsules: Sequence[Capsule], obstacles: Sequence[Obstacle]) -> IntArray:
    pairs = [
        (i, j)
        for i, capsule in enumerate(capsules)
        for j, obstacle in enumerate(obstacles)
        if capsule.name not in obstacle.exempt
    ]
    return np.array(pairs, dtype=int).reshape(-1, 2)
