"""Distances of the arm to its surroundings, and to itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray, IntArray, invert_pose, make_pose
from core.motion.arm_models import ArmModel, ArmShape, Capsule
from core.motion.distances import segment_box_distance, segment_segment_distance
from core.motion.kinematics import link_poses

_CHUNK = 1000
"""Configurations at a time: about 100 MB of intermediate values."""


@dataclass(frozen=True)
class Obstacle:
    """A box that the arm must not touch.

    Attributes:
        name: as shown to the user.
        T_base_box: (4, 4) pose of its center.
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
    """The smallest distances of N configurations.

    Attributes:
        distance_m: (N,) the smallest distance; negative where something overlaps.
        pair: (N,) which pair that is, as an index into `pair_names`.
        pair_names: the arm's part, and the obstacle or the arm's other part.
    """

    distance_m: FloatArray
    pair: IntArray
    pair_names: tuple[tuple[str, str], ...]

    def nearest(self, k: int) -> tuple[str, str]:
        """Names of the nearest two in configuration `k`."""
        return self.pair_names[self.pair[k]]


class MotionScene:
    """An arm with its tools among obstacles: everything that a motion is checked against.

    Attributes:
        arm: its kinematics.
        shape: capsules (C) of the arm and its tools.
        obstacles: boxes (B).
        radii_m: (C,) of the capsules.
        T_box_base: (B, 4, 4) the base in the boxes' frames.
        half_sizes_m: (B, 3) of the boxes.
    """

    def __init__(self, arm: ArmModel, shape: ArmShape, obstacles: Sequence[Obstacle]) -> None:
        self.arm = arm
        self.shape = shape
        self.obstacles = tuple(obstacles)
        capsules = shape.capsules
        self.radii_m = np.array([capsule.radius_m for capsule in capsules])
        self.T_box_base = np.array([invert_pose(box.T_base_box) for box in self.obstacles]).reshape(-1, 4, 4)
        self.half_sizes_m = np.array([box.size_m for box in self.obstacles]).reshape(-1, 3) / 2
        self._links = np.array([capsule.link for capsule in capsules])
        self._ends_m = np.array([(capsule.start_m, capsule.end_m) for capsule in capsules])
        self._reaches_m = np.linalg.norm(self._ends_m[:, 1] - self._ends_m[:, 0], axis=1) / 2
        self._self_pairs = np.array(shape.pairs, dtype=int).reshape(-1, 2)
        self._box_pairs = _box_pairs(capsules, self.obstacles)
        self._pair_names = tuple(
            [(capsules[i].name, capsules[j].name) for i, j in self._self_pairs]
            + [(capsules[i].name, self.obstacles[j].name) for i, j in self._box_pairs]
        )

    def clearance(self, joints_rad: npt.ArrayLike) -> Clearance:
        """Return the smallest distances of configurations (N, 6); exact for the capsules and boxes."""
        joints = np.asarray(joints_rad, dtype=float)
        parts = [self._distances(joints[k : k + _CHUNK]) for k in range(0, len(joints), _CHUNK)]
        distances = np.concatenate([np.zeros((0, len(self._pair_names))), *parts])
        pair = distances.argmin(axis=1)
        return Clearance(distances[np.arange(len(joints)), pair], pair, self._pair_names)

    def capsule_ends(self, joints_rad: FloatArray) -> FloatArray:
        """Return the ends (N, C, 2, 3) of the capsules' segments in the base frame, in metres."""
        poses = link_poses(self.arm, joints_rad)[:, self._links]
        return np.asarray(self._ends_m @ np.swapaxes(poses[..., :3, :3], -1, -2) + poses[..., None, :3, 3])

    def _distances(self, joints: FloatArray) -> FloatArray:
        """Distances (N, P) of all pairs: the smallest of each configuration is exact, the others may be too
        small.

        Bounding spheres of the capsules exclude most pairs; exact distances are computed for the others.
        """
        ends = self.capsule_ends(joints)
        distances = self._lower_bounds(ends.mean(axis=-2))
        rows = np.arange(len(joints))
        first = distances.argmin(axis=1)
        nearest = self._exact(ends, rows, first)
        maybe = distances < nearest[:, None]
        maybe[rows, first] = False
        others, pairs = np.nonzero(maybe)
        distances[rows, first] = nearest
        distances[others, pairs] = self._exact(ends, others, pairs)
        return distances

    def _lower_bounds(self, middles: FloatArray) -> FloatArray:
        """Lower bounds (N, P) of the pairs' distances, for the capsules' centers (N, C, 3)."""
        (i, j), (c, b) = self._self_pairs.T, self._box_pairs.T
        around = self.radii_m + self._reaches_m
        between = middles[:, i] - middles[:, j]
        T = self.T_box_base
        in_boxes = np.einsum("bij,ncj->ncbi", T[:, :3, :3], middles) + T[:, :3, 3]
        outside = np.maximum(np.abs(in_boxes) - self.half_sizes_m, 0)[:, c, b]
        to_itself = np.linalg.norm(between, axis=-1) - around[i] - around[j]
        return np.concatenate([to_itself, np.linalg.norm(outside, axis=-1) - around[c]], axis=1)

    def _exact(self, ends: FloatArray, rows: IntArray, pairs: IntArray) -> FloatArray:
        """Exact distances (K,) of pairs (K,) in rows (K,) of the capsules' ends (N, C, 2, 3)."""
        distances = np.empty(len(rows))
        n_self = len(self._self_pairs)
        of_itself = pairs < n_self
        i, j = self._self_pairs[pairs[of_itself]].T
        a, b = ends[rows[of_itself], i], ends[rows[of_itself], j]
        between = segment_segment_distance(a[:, 0], a[:, 1], b[:, 0], b[:, 1])
        distances[of_itself] = between - self.radii_m[i] - self.radii_m[j]
        c, box = self._box_pairs[pairs[~of_itself] - n_self].T
        T = self.T_box_base[box]
        near = ends[rows[~of_itself], c] @ np.swapaxes(T[:, :3, :3], -1, -2) + T[:, None, :3, 3]
        to_box = segment_box_distance(near[:, 0], near[:, 1], self.half_sizes_m[box])
        distances[~of_itself] = to_box - self.radii_m[c]
        return distances


def _box_pairs(capsules: Sequence[Capsule], obstacles: Sequence[Obstacle]) -> IntArray:
    pairs = [
        (i, j)
        for i, capsule in enumerate(capsules)
        for j, obstacle in enumerate(obstacles)
        if capsule.name not in obstacle.exempt
    ]
    return np.array(pairs, dtype=int).reshape(-1, 2)
