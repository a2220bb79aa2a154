"""The scene of a pour: the arm, and the cup standing or in the hand, against everything."""

from __future__ import annotations

import numpy as np

from core.geometry import FloatArray, IntArray, invert_pose, make_pose
from core.motion.arm_shape import arm_shape
from core.motion.clearance import Clearance, MotionScene, Obstacle, axis_aligned_obstacle
from core.motion.cone import cone_box_distance, cone_segment_distance
from core.motion.kinematics import flange_pose, link_poses
from core.motion.pour.cell import GRIPPER, PourCell
from core.motion.pour.geometry import outer_cone
from core.parameters.imagination import CupParameters

OBJECT, CUP = "object", "cup"
EXACT_BELOW_M = 0.03
"""Larger distances need not be exact."""


class PourScene:
    """The cell with the object as its axis-aligned box, and with the cup as a truncated cone.

    Attributes:
        cell: what it was built from.
        hand: arm and tools among the obstacles and the object.
        route: the same with the cup standing at its station.
        cone: the cup's outside.
        obstacles: all boxes, the object the last.
    """

    def __init__(self, cell: PourCell, object_aabb_m: FloatArray, cup: CupParameters) -> None:
        """Build it for an object (2, 3), lower and upper corner in the base frame."""
        self.cell = cell
        self.cone = outer_cone(cup)
        self.obstacles = (*cell.obstacles, axis_aligned_obstacle(OBJECT, *object_aabb_m))
        shape = arm_shape(cell.arm, cell.tools)
        self.hand = MotionScene(cell.arm, shape, self.obstacles)
        self.route = MotionScene(cell.arm, shape, [*self.obstacles, self._standing_cup()])
        self._parts = [part for part in shape.capsules if part.name != GRIPPER]
        self._links = np.array([part.link for part in self._parts])
        self._ends_m = np.array([(part.start_m, part.end_m) for part in self._parts])
        self._radii_m = np.array([part.radius_m for part in self._parts])
        self._T_box_base = np.array([invert_pose(box.T_base_box) for box in self.obstacles])
        self._half_sizes_m = np.array([box.size_m for box in self.obstacles]) / 2
        self._T_grasp_flange = invert_pose(cell.T_flange_grasp)

    @property
    def station_pose(self) -> FloatArray:
        """`T_base_cup` (4, 4) of the cup that stands at its station."""
        return make_pose(np.eye(3), self.cell.cup_station_m)

    def flange_poses(self, T_base_grasp: FloatArray) -> FloatArray:
        """`T_base_flange` (N, 4, 4) for poses (N, 4, 4) of the tool frame."""
        return T_base_grasp @ self._T_grasp_flange

    def grasp_poses(self, joints_rad: FloatArray) -> FloatArray:
        """`T_base_grasp` (N, 4, 4) at configurations (N, 6)."""
        return flange_pose(self.cell.arm, joints_rad) @ self.cell.T_flange_grasp

    def held_cups(self, joints_rad: FloatArray) -> FloatArray:
        """`T_base_cup` (N, 4, 4) of the cup in the hand, but for its angle about its axis."""
        return self.grasp_poses(joints_rad) @ make_pose(np.eye(3), (0, 0, -self.cell.grip_height_m))

    def hand_points(self, T_base_grasp: FloatArray) -> FloatArray:
        """The tool frame's origin and eight points (N, 9, 3) on the held cup's rims: no point of it moves
        much farther than one of these.
        """
        low, high, grip = self.cone.low_radius_m, self.cone.high_radius_m, self.cell.grip_height_m
        around = np.array([[1.0, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]])
        base, mouth = np.array([0, 0, -grip]), np.array([0, 0, self.cone.height_m - grip])
        points = np.concatenate([np.zeros((1, 3)), base + low * around, mouth + high * around])
        return points @ np.swapaxes(T_base_grasp[:, :3, :3], 1, 2) + T_base_grasp[:, None, :3, 3]

    def cup_to_boxes(self, T_base_cup: FloatArray, exact_below_m: float = EXACT_BELOW_M) -> FloatArray:
        """Distances (N, B) of cups (N, 4, 4) to the obstacles and the object; never too large."""
        T_box_cup = self._T_box_base[None] @ T_base_cup[:, None]
        half = np.broadcast_to(self._half_sizes_m, (*T_box_cup.shape[:2], 3))
        middle = T_box_cup[..., :3, :3] @ self.cone.middle_m + T_box_cup[..., :3, 3]
        outside = middle - np.clip(middle, -half, half)
        distance: FloatArray = np.linalg.norm(outside, axis=-1) - self.cone.reach_m
        near = distance < exact_below_m
        distance[near] = cone_box_distance(self.cone, T_box_cup[near], half[near], exact_below_m)
        return distance

    def cup_to_arm(
        self, T_base_cup: FloatArray, joints_rad: FloatArray, exact_below_m: float = EXACT_BELOW_M
    ) -> FloatArray:
        """Distances (N, P) of cups (N, 4, 4) to the arm's parts but the gripper, at configurations (N, 6)."""
        poses = link_poses(self.cell.arm, joints_rad)[:, self._links]
        ends = self._ends_m @ np.swapaxes(poses[..., :3, :3], -1, -2) + poses[..., None, :3, 3]
        in_cup = (ends - T_base_cup[:, None, None, :3, 3]) @ T_base_cup[:, None, :3, :3]
        start, end = in_cup[:, :, 0], in_cup[:, :, 1]
        along = end - start
        share = np.einsum("npi,npi->np", self.cone.middle_m - start, along)
        share = np.clip(share / np.maximum(np.einsum("npi,npi->np", along, along), 1e-12), 0, 1)
        to_middle = np.linalg.norm(start + share[..., None] * along - self.cone.middle_m, axis=-1)
        distance: FloatArray = to_middle - self.cone.reach_m - self._radii_m
        near = distance < exact_below_m
        radii = np.broadcast_to(self._radii_m, distance.shape)[near]
        distance[near] = cone_segment_distance(self.cone, start[near], end[near]) - radii
        return distance

    def cup_clearance(
        self,
        T_base_cup: FloatArray,
        joints_rad: FloatArray,
        ignored: frozenset[str] = frozenset(),
        exact_below_m: float = EXACT_BELOW_M,
    ) -> Clearance:
        """Smallest distance of cups (N, 4, 4), or of one (1, 4, 4), to the arm at configurations (N, 6) and
        to all boxes but the ignored ones.
        """
        kept = [k for k, box in enumerate(self.obstacles) if box.name not in ignored]
        to_boxes = self.cup_to_boxes(T_base_cup, exact_below_m)[:, kept]
        to_arm = self.cup_to_arm(T_base_cup, joints_rad, exact_below_m)
        to_boxes = np.broadcast_to(to_boxes, (len(to_arm), len(kept)))
        distances = np.concatenate([to_arm, to_boxes], axis=1)
        names = [part.name for part in self._parts] + [self.obstacles[k].name for k in kept]
        pair: IntArray = distances.argmin(axis=1)
        nearest: FloatArray = distances[np.arange(len(distances)), pair]
        return Clearance(nearest, pair, tuple((CUP, name) for name in names))

    def _standing_cup(self) -> Obstacle:
        radius = max(self.cone.low_radius_m, self.cone.high_radius_m)
        foot = self.cell.cup_station_m
        around = np.array([radius, radius, 0.0])
        return axis_aligned_obstacle(CUP, foot - around, foot + around + [0, 0, self.cone.height_m])


def too_near(where: str, pair: tuple[str, str], distance_m: float, wanted_m: float) -> str:
    """Say in a sentence what comes too near to what, and by how much."""
    first, second = pair
    if distance_m <= 0:
        return f"In the move '{where}' {first} and {second} would touch."
    return (
        f"In the move '{where}' {first} and {second} would come to {distance_m * 1000:.1f} mm of each other, "
        f"where {wanted_m * 1000:g} mm must stay."
    )
