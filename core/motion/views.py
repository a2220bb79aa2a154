"""Views on a dome around the object that the arm can reach, and a choice of them that is spread over it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from core.geometry import BoolArray, FloatArray, IntArray, look_at, make_pose, rotation_z
from core.motion.clearance import MotionScene
from core.motion.joint_path import MIN_CLEARANCE_M
from core.motion.kinematics import (
    TURN_RAD,
    inverse_kinematics,
    nearest_turn,
    singularity_measure,
    within_limits,
)

_BOX_SAMPLES = 5
_BENEFIT_M = 0.05
"""Clearance beyond this makes a view no better."""
LOWEST_ELEVATION_DEG = 20.0
COVERED_WITHIN_DEG = 25.0
_STEEP_DEG = 75.0
_STEEP_WEIGHT = 4.0
"""Weight of directions this steep: floors of deep cups show only there, walls show from many sides."""
_KERNEL_DEG = 14.0
"""Angular range of a view's worth: with 24 views on the dome, neighbours are about 25 degrees apart."""
_DOME_SAMPLES = 1000


@dataclass(frozen=True)
class Dome:
    """Which camera poses to consider: all combinations, each looking at the target.

    Attributes:
        elevations_deg: above the horizon.
        azimuths_deg: of the camera as seen from the target, from base x towards base y.
        distances_m: from the target.
        rolls_deg: about the optical axis; 0 has the image's top up.
    """

    elevations_deg: Sequence[float] = tuple(range(20, 91, 5))
    azimuths_deg: Sequence[float] = tuple(range(-180, 180, 15))
    distances_m: Sequence[float] = (0.45, 0.55, 0.65, 0.75)
    rolls_deg: Sequence[float] = tuple(range(-180, 180, 45))


@dataclass(frozen=True)
class ViewTask:
    """What to look at, and with which camera.

    Attributes:
        T_flange_camera: (4, 4) pose of the optical frame.
        target_m: (3,) point on the optical axis, in the base frame.
        box_min_m: (3,) lower corner of the box around the object, in the base frame.
        box_max_m: (3,) its upper corner.
        home_rad: (6,) joints are chosen within half a turn of it, where possible.
        field_of_view_deg: the image's width and height.
        min_range_m: the camera measures nothing closer than this.
        min_clearance_m: required between any two things.
        min_singularity: smallest allowed `singularity_measure`.
    """

    T_flange_camera: FloatArray
    target_m: FloatArray
    box_min_m: FloatArray
    box_max_m: FloatArray
    home_rad: FloatArray
    field_of_view_deg: tuple[float, float] = (62.0, 48.0)
    min_range_m: float = 0.35
    min_clearance_m: float = MIN_CLEARANCE_M
    min_singularity: float = 0.03


@dataclass(frozen=True)
class ReachableView:
    """A configuration from which the camera looks at the target.

    Attributes:
        joints_rad: (6,).
        T_base_camera: (4, 4) the optical frame there.
        elevation_deg: of the camera above the target's horizon.
        azimuth_deg: of the camera around the target.
        distance_m: from the target.
        clearance_m: smallest distance of arm and tools to anything.
        seen_share: share of the box's volume inside the image and beyond the camera's minimum range.
    """

    joints_rad: FloatArray
    T_base_camera: FloatArray
    elevation_deg: float
    azimuth_deg: float
    distance_m: float
    clearance_m: float
    seen_share: float

    @property
    def direction(self) -> FloatArray:
        """Unit vector (3,) from the target to the camera."""
        return -self.T_base_camera[:3, 2]

    @property
    def quality(self) -> float:
        """How good the view is: the box in the image first, then clearance; 0 to 1.2."""
        return self.seen_share + 0.2 * min(self.clearance_m, _BENEFIT_M) / _BENEFIT_M


def reachable_views(
    scene: MotionScene,
    task: ViewTask,
    dome: Dome = Dome(),
) -> tuple[ReachableView, ...]:
    """Return every configuration that takes a pose of the dome, the best first; 2 s for the default dome.

    Reachable means: a branch of the inverse kinematics within the joint limits, not near-singular, and clear.
    Each branch of each pose comes with the joint angles nearest to the home configuration, and once more with
    joint 1 a turn away if its limits allow: an obstacle beside the base may block one side.
    """
    places = _dome_places(dome)
    T_base_camera = np.array([_dome_pose(task.target_m, *place) for place in places]).reshape(-1, 4, 4)
    joints, pose_index = _allowed_configurations(scene, task, T_base_camera)
    clearance_m = scene.clearance(joints).distance_m if len(joints) else np.zeros(0)
    seen = _seen_shares(task, T_base_camera)
    views = []
    for i, k in enumerate(pose_index):
        if clearance_m[i] >= task.min_clearance_m:
            elevation, azimuth, distance, _ = places[k]
            measured = float(clearance_m[i]), float(seen[k])
            views.append(ReachableView(joints[i], T_base_camera[k], elevation, azimuth, distance, *measured))
    return tuple(sorted(views, key=lambda view: view.quality, reverse=True))


def _dome_places(dome: Dome) -> list[tuple[float, float, float, float]]:
    """Elevation, azimuth, distance and roll; straight down, azimuth and roll are the same rotation."""
    return [
        place
        for place in product(dome.elevations_deg, dome.azimuths_deg, dome.distances_m, dome.rolls_deg)
        if place[0] < 90 or place[3] == dome.rolls_deg[0]
    ]


def _dome_pose(
    target_m: FloatArray, elevation_deg: float, azimuth_deg: float, distance_m: float, roll_deg: float
) -> FloatArray:
    """Pose `T_base_camera` (4, 4) at one place of the dome."""
    elevation, azimuth = np.radians(elevation_deg), np.radians(azimuth_deg)
    if elevation_deg >= 90:
        turn = make_pose(rotation_z(azimuth), (0, 0, 0))
        return look_at(target_m + np.array([0, 0, distance_m]), target_m) @ turn
    outwards = np.array(
        [np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation), np.sin(elevation)]
    )
    roll = make_pose(rotation_z(np.radians(roll_deg)), (0, 0, 0))
    return look_at(target_m + distance_m * outwards, target_m) @ roll


def _allowed_configurations(
    scene: MotionScene, task: ViewTask, T_base_camera: FloatArray
) -> tuple[FloatArray, IntArray]:
    """Configurations (K, 6) within limits and not near-singular, and the index (K,) of their poses."""
    branches = inverse_kinematics(scene.arm, T_base_camera @ np.linalg.inv(task.T_flange_camera))
    pose_index, branch = np.nonzero(branches.found & ~branches.undetermined)
    joints = nearest_turn(scene.arm, branches.joints_rad[pose_index, branch], task.home_rad)
    far_from_singular = singularity_measure(scene.arm, joints) >= task.min_singularity
    joints, pose_index = joints[far_from_singular], pose_index[far_from_singular]
    turn = TURN_RAD * np.eye(6)[0]
    both = np.concatenate([joints, joints + turn, joints - turn])
    inside = np.asarray(within_limits(scene.arm, both).all(axis=1))
    return both[inside], np.tile(pose_index, 3)[inside]


def _seen_shares(task: ViewTask, T_base_camera: FloatArray) -> FloatArray:
    """Share (N,) of the box's volume that each camera sees, by sample points."""
    low, high = task.box_min_m, task.box_max_m
    shares = (np.arange(_BOX_SAMPLES) + 0.5) / _BOX_SAMPLES
    grid = np.stack(np.meshgrid(shares, shares, shares), axis=-1).reshape(-1, 3)
    return np.asarray(seen_points(task, T_base_camera, low + grid * (high - low)).mean(axis=1))


def seen_points(task: ViewTask, T_base_camera: FloatArray, points_m: FloatArray) -> BoolArray:
    """Which points (P, 3) each camera (N, 4, 4) has in its image and beyond its least range: (N, P)."""
    T_camera_base = np.linalg.inv(T_base_camera)
    points = points_m @ np.swapaxes(T_camera_base[:, :3, :3], -1, -2)
    points += T_camera_base[:, None, :3, 3]
    half = np.tan(np.radians(task.field_of_view_deg) / 2)
    depth = np.maximum(points[..., 2:], 1e-6)
    inside = (np.abs(points[..., :2] / depth) <= half).all(axis=-1) & (points[..., 2] >= task.min_range_m)
    return np.asarray(inside)


def choose_spread_views(views: Sequence[ReachableView], n_views: int) -> tuple[ReachableView, ...]:
    """Pick views (at most `n_views`) that together cover as many dome directions as possible.

    Greedy, which is within 37 % of the best for this submodular measure (Nemhauser et al. 1978): each next
    view is the one that adds most, weighted by its quality; of one direction, only the best is considered.
    """
    candidates = _best_of_each_direction(views)
    if not candidates:
        return ()
    dome, weights = _weighted_dome()
    worth = np.array([view.quality for view in candidates])[:, None] * _nearness(candidates, dome)
    covered = np.zeros(len(dome))
    chosen: list[ReachableView] = []
    for _ in range(min(n_views, len(candidates))):
        gains = (np.maximum(worth - covered, 0) * weights).sum(axis=1)
        best = int(gains.argmax())
        chosen.append(candidates[best])
        covered = np.maximum(covered, worth[best])
        worth[best] = -1
    return tuple(chosen)


def coverage(directions: FloatArray) -> float:
    """Share of the dome's directions (20 to 90 degrees of elevation) within 25 degrees of a view's (K, 3)."""
    cosines = dome_directions(_DOME_SAMPLES, LOWEST_ELEVATION_DEG) @ directions.T
    return float((cosines.max(axis=1) >= np.cos(np.radians(COVERED_WITHIN_DEG))).mean())


def dome_directions(n: int, lowest_elevation_deg: float) -> FloatArray:
    """Unit vectors (n, 3) spread evenly over the dome's surface (a Fibonacci spiral)."""
    lowest = np.sin(np.radians(lowest_elevation_deg))
    z = lowest + (1 - lowest) * (np.arange(n) + 0.5) / n
    azimuth = np.arange(n) * np.pi * (3 - np.sqrt(5))
    radius = np.sqrt(1 - z**2)
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=-1)


def _weighted_dome() -> tuple[FloatArray, FloatArray]:
    dome = dome_directions(_DOME_SAMPLES, LOWEST_ELEVATION_DEG)
    steep = dome[:, 2] >= np.sin(np.radians(_STEEP_DEG))
    return dome, np.where(steep, _STEEP_WEIGHT, 1.0)


def _nearness(views: Sequence[ReachableView], dome: FloatArray) -> FloatArray:
    """How well (K, N), 0 to 1, each view covers each dome direction."""
    cosines = np.clip(np.array([view.direction for view in views]) @ dome.T, -1, 1)
    return np.asarray(np.exp(-((np.degrees(np.arccos(cosines)) / _KERNEL_DEG) ** 2)))


def _best_of_each_direction(views: Sequence[ReachableView]) -> list[ReachableView]:
    best: dict[tuple[float, ...], ReachableView] = {}
    for view in sorted(views, key=lambda view: view.quality, reverse=True):
        best.setdefault(tuple(view.direction.round(3)), view)
    return list(best.values())
