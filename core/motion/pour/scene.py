"""The scene of a pour, and how close arm and cup come to anything in it during moves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.errors import MotionError
from core.geometry import FloatArray, IntArray, invert_pose, make_pose
from core.motion.arm_models import arm_shape
from core.motion.clearance import Clearance, MotionScene, Obstacle, axis_aligned_obstacle
from core.motion.distances import cone_box_distance, cone_segment_distance
from core.motion.kinematics import flange_pose
from core.motion.pour.cell import GRIPPER, PourCell
from core.motion.pour.geometry import outer_cone
from core.motion.pour.plan import PlannedMove, Segment
from core.parameters.bodies import CupParameters

OBJECT, CUP = "object", "cup"
EXACT_BELOW_M = 0.03
"""Larger distances need not be exact."""
_WITHOUT_CUP = frozenset({Segment.TO_CUP, Segment.HOME})
"""Here the hand must stay clear of the standing cup."""
_AT_STATION = frozenset({Segment.LIFT, Segment.PUT_DOWN})
"""Here the cup may be close to what it stands on."""
_PENETRATION_M = 0.002
"""By the cell file's figures the standing cup may be this deep in what it stands on."""


class PourScene:
    """The cell with the object as its axis-aligned box, and with the cup as a truncated cone.

    Attributes:
        cell: what it was built from.
        hand: arm and tools among the obstacles and the object.
        route: the same with the cup at its station.
        cone: the cup's outside.
        obstacles: all boxes, the object last.
    """

    def __init__(self, cell: PourCell, object_aabb_m: FloatArray, cup: CupParameters) -> None:
        """Build it for an object (2, 3), lower and upper corner in the base frame."""
        self.cell = cell
        self.cone = outer_cone(cup)
        self.obstacles = (*cell.obstacles, axis_aligned_obstacle(OBJECT, *object_aabb_m))
        shape = arm_shape(cell.arm, cell.tools)
        self.hand = MotionScene(cell.arm, shape, self.obstacles)
        self.route = MotionScene(cell.arm, shape, [*self.obstacles, self._standing_cup()])
        self._parts = [k for k, part in enumerate(shape.capsules) if part.name != GRIPPER]
        self._radii_m = self.hand.radii_m[self._parts]
        self._T_grasp_flange = invert_pose(cell.T_flange_grasp)

    @property
    def station_pose(self) -> FloatArray:
        """`T_base_cup` (4, 4) of the cup at its station."""
        return make_pose(np.eye(3), self.cell.cup_station_m)

    def flange_poses(self, T_base_grasp: FloatArray) -> FloatArray:
        """`T_base_flange` (N, 4, 4) for poses (N, 4, 4) of the tool frame."""
        return T_base_grasp @ self._T_grasp_flange

    def grasp_poses(self, joints_rad: FloatArray) -> FloatArray:
        """`T_base_grasp` (N, 4, 4) at configurations (N, 6)."""
        return flange_pose(self.cell.arm, joints_rad) @ self.cell.T_flange_grasp

    def held_cups(self, joints_rad: FloatArray) -> FloatArray:
        """`T_base_cup` (N, 4, 4) of the cup in the hand, except for its angle about its axis."""
        return self.grasp_poses(joints_rad) @ make_pose(np.eye(3), (0, 0, -self.cell.grip_height_m))

    def hand_points(self, T_base_grasp: FloatArray) -> FloatArray:
        """The tool frame's origin and eight points (N, 9, 3) on the held cup's rims: they bound its motion"""
        low, high, grip = self.cone.low_radius_m, self.cone.high_radius_m, self.cell.grip_height_m
        around = np.array([[1.0, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]])
        base, mouth = np.array([0, 0, -grip]), np.array([0, 0, self.cone.height_m - grip])
        points = np.concatenate([np.zeros((1, 3)), base + low * around, mouth + high * around])
        return points @ np.swapaxes(T_base_grasp[:, :3, :3], 1, 2) + T_base_grasp[:, None, :3, 3]

    def cup_to_boxes(self, T_base_cup: FloatArray, exact_below_m: float = EXACT_BELOW_M) -> FloatArray:
        """Distances (N, B) of cups (N, 4, 4) to the obstacles and the object; never too large."""
        T_box_cup = self.hand.T_box_base[None] @ T_base_cup[:, None]
        half = np.broadcast_to(self.hand.half_sizes_m, (*T_box_cup.shape[:2], 3))
        middle = T_box_cup[..., :3, :3] @ self.cone.middle_m + T_box_cup[..., :3, 3]
        outside = middle - np.clip(middle, -half, half)
        distance: FloatArray = np.linalg.norm(outside, axis=-1) - self.cone.reach_m
        near = distance < exact_below_m
        distance[near] = cone_box_distance(self.cone, T_box_cup[near], half[near], exact_below_m)
        return distance

    def cup_to_arm(
        self, T_base_cup: FloatArray, joints_rad: FloatArray, exact_below_m: float = EXACT_BELOW_M
    ) -> FloatArray:
        """Distances (N, P) of cups (N, 4, 4) to all capsules but the gripper, at configurations (N, 6)."""
        ends = self.hand.capsule_ends(joints_rad)[:, self._parts]
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
        capsules = self.hand.shape.capsules
        names = [capsules[k].name for k in self._parts] + [self.obstacles[k].name for k in kept]
        pair: IntArray = distances.argmin(axis=1)
        nearest: FloatArray = distances[np.arange(len(distances)), pair]
        return Clearance(nearest, pair, tuple((CUP, name) for name in names))

    def _standing_cup(self) -> Obstacle:
        radius = max(self.cone.low_radius_m, self.cone.high_radius_m)
        foot = self.cell.cup_station_m
        around = np.array([radius, radius, 0.0])
        return axis_aligned_obstacle(CUP, foot - around, foot + around + [0, 0, self.cone.height_m])


def too_close(where: Segment, pair: tuple[str, str], distance_m: float, required_m: float) -> str:
    """A sentence on what comes too close to what, and by how much."""
    first, second = pair
    if distance_m <= 0:
        return f"In the move '{where.label}' {first} and {second} would touch."
    return (
        f"In the move '{where.label}' {first} and {second} would come within {distance_m * 1000:.1f} mm of "
        f"each other, where {required_m * 1000:g} mm are required."
    )


@dataclass(frozen=True)
class LeastClearance:
    """The smallest distances during some moves.

    Attributes:
        clearance_m: smallest distance of arm and tools to anything.
        nearest: names of the two that are this close.
        cup_clearance_m: smallest distance of the cup to anything but the gripper and what it stands on.
    """

    clearance_m: float
    nearest: tuple[str, str]
    cup_clearance_m: float

    def with_other(self, other: LeastClearance) -> LeastClearance:
        """The smallest distances of these and other moves."""
        closer = self if self.clearance_m <= other.clearance_m else other
        cup = min(self.cup_clearance_m, other.cup_clearance_m)
        return LeastClearance(closer.clearance_m, closer.nearest, cup)


def check_clearance(scene: PourScene, moves: Sequence[PlannedMove]) -> LeastClearance:
    """Verify the clearance of every sample of some moves, and return the smallest.

    Raises:
        MotionError: names the move, and what comes too close to what.
    """
    clearance, nearest = _check_hand(scene, moves)
    return LeastClearance(clearance, nearest, _check_cup(scene, moves))


def supports(scene: PourScene) -> frozenset[str]:
    """Names of what the standing cup rests on.

    Raises:
        MotionError: the cup would stand in something.
    """
    required = scene.cell.limits.cup_clearance_m
    standing = scene.station_pose
    raised = standing.copy()
    raised[2, 3] += required + _PENETRATION_M
    low, high = scene.cup_to_boxes(np.stack([standing, raised]))
    for box, above in zip(scene.obstacles, high, strict=True):
        if above < required:
            raise MotionError(
                f"At its station the cup would stand in the {box.name} or touch it; correct cup_station_m in "
                "the cell file, or remove the obstacle."
            )
    return frozenset(box.name for box, here in zip(scene.obstacles, low, strict=True) if here < required)


def _check_hand(scene: PourScene, moves: Sequence[PlannedMove]) -> tuple[float, tuple[str, str]]:
    """Arm and tools against everything; without the cup in the hand, also against the standing cup."""
    limits, smallest, names = scene.cell.limits, np.inf, ("", "")
    free = [move for move in moves if move.name in _WITHOUT_CUP]
    others = [move for move in moves if move.name not in _WITHOUT_CUP]
    for group, everything in ((free, scene.route), (others, scene.hand)):
        if not group:
            continue
        joints, owners = distinct(group)
        clearance = everything.clearance(joints)
        k = int(clearance.distance_m.argmin())
        distance = float(clearance.distance_m[k])
        if not distance >= limits.min_clearance_m:
            name = group[owners[k]].name
            raise MotionError(too_close(name, clearance.nearest(k), distance, limits.min_clearance_m))
        if distance < smallest:
            smallest, names = distance, clearance.nearest(k)
    return smallest, names


def _check_cup(scene: PourScene, moves: Sequence[PlannedMove]) -> float:
    """The cup, standing or in the hand, against everything but the gripper and what it stands on."""
    required = scene.cell.limits.cup_clearance_m
    waiting = [move for move in moves if not move.holds_cup]
    handled = [move for move in moves if move.holds_cup and move.name in _AT_STATION]
    carried = [move for move in moves if move.holds_cup and move.name not in _AT_STATION]
    smallest = np.inf
    for group in (waiting, handled, carried):
        if not group:
            continue
        ignored = frozenset[str]() if group is carried else supports(scene)
        joints, owners = distinct(group)
        cups = scene.station_pose[None] if group is waiting else scene.held_cups(joints)
        clearance = scene.cup_clearance(cups, joints, ignored)
        k = int(clearance.distance_m.argmin())
        distance = float(clearance.distance_m[k])
        if not distance >= required:
            raise MotionError(too_close(group[owners[k]].name, clearance.nearest(k), distance, required))
        smallest = min(smallest, distance)
        if group is handled:
            _check_standing(scene, cups, ignored)
    return smallest


def _check_standing(scene: PourScene, T_base_cup: FloatArray, on: frozenset[str]) -> None:
    """Near its station the cup may be as close to what it stands on as it is above its station."""
    height = T_base_cup[:, 2, 3] - scene.cell.cup_station_m[2]
    kept = [k for k, box in enumerate(scene.obstacles) if box.name in on]
    distance = scene.cup_to_boxes(T_base_cup)[:, kept].min(axis=1, initial=np.inf)
    if not (distance >= np.minimum(height, scene.cell.limits.cup_clearance_m) - _PENETRATION_M).all():
        raise MotionError("In the move 'lift' the cup would touch what it stands on; plan the pour again.")


def distinct(moves: Sequence[PlannedMove]) -> tuple[FloatArray, IntArray]:
    """All different configurations (N, 6) of some moves, and the index (N,) of the first move with each."""
    joints = np.concatenate([move.trajectory.joints_rad for move in moves])
    owners = np.repeat(np.arange(len(moves)), [len(move.trajectory.joints_rad) for move in moves])
    # by their bytes: many times faster than by rows, and moves back hold the very same numbers
    rows = np.ascontiguousarray(joints).view(np.dtype((np.void, joints.itemsize * joints.shape[1])))
    _, first = np.unique(rows, return_index=True)
    first.sort()
    return joints[first], owners[first]
