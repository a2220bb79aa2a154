"""How much room a plan's moves leave: arm and tools against everything, and the cup against everything."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.errors import MotionError
from core.geometry import FloatArray, IntArray
from core.motion.pour.plan import PlannedMove
from core.motion.pour.scene import PourScene, too_near

FREE_MOVES = frozenset({"to the cup", "home"})
"""Here the hand stays clear of the standing cup."""
ON_STATION = frozenset({"lift", "put down"})
"""Here the cup may be near to what it stands on."""
STAND_M = 0.002
"""The standing cup may be this deep in what it stands on, by the cell file's figures."""


@dataclass(frozen=True)
class Room:
    """What moves leave at least.

    Attributes:
        clearance_m: smallest distance of arm and tools to anything.
        nearest: names of the two that are this near.
        cup_clearance_m: smallest distance of the cup to anything but the gripper and what it stands on.
    """

    clearance_m: float
    nearest: tuple[str, str]
    cup_clearance_m: float

    def with_other(self, other: Room) -> Room:
        """What this and other moves leave."""
        nearer = self if self.clearance_m <= other.clearance_m else other
        return Room(nearer.clearance_m, nearer.nearest, min(self.cup_clearance_m, other.cup_clearance_m))


def check_room(scene: PourScene, moves: Sequence[PlannedMove]) -> Room:
    """Verify that every sample of some moves leaves the room it must.

    Raises:
        MotionError: names the move, and what comes too near to what.
    """
    clearance, nearest = _check_hand(scene, moves)
    return Room(clearance, nearest, _check_cup(scene, moves))


def supports(scene: PourScene) -> frozenset[str]:
    """Names of what the standing cup rests on.

    Raises:
        MotionError: the cup would stand in something.
    """
    wanted = scene.cell.limits.cup_clearance_m
    standing = scene.station_pose
    raised = standing.copy()
    raised[2, 3] += wanted + STAND_M
    low, high = scene.cup_to_boxes(np.stack([standing, raised]))
    for box, above in zip(scene.obstacles, high, strict=True):
        if above < wanted:
            raise MotionError(
                f"At its station the cup would stand in the {box.name} or touch it; correct cup_station_m in "
                "the cell file, or move what is in the way."
            )
    return frozenset(box.name for box, here in zip(scene.obstacles, low, strict=True) if here < wanted)


def _check_hand(scene: PourScene, moves: Sequence[PlannedMove]) -> tuple[float, tuple[str, str]]:
    """Arm and tools against everything; on the free ways also against the standing cup."""
    limits, smallest, names = scene.cell.limits, np.inf, ("", "")
    free = [move for move in moves if move.name in FREE_MOVES]
    others = [move for move in moves if move.name not in FREE_MOVES]
    for group, everything in ((free, scene.route), (others, scene.hand)):
        if not group:
            continue
        joints, owners = distinct(group)
        room = everything.clearance(joints)
        k = int(room.distance_m.argmin())
        distance = float(room.distance_m[k])
        if not distance >= limits.min_clearance_m:
            name = group[owners[k]].name
            raise MotionError(too_near(name, room.nearest(k), distance, limits.min_clearance_m))
        if distance < smallest:
            smallest, names = distance, room.nearest(k)
    return smallest, names


def _check_cup(scene: PourScene, moves: Sequence[PlannedMove]) -> float:
    """The cup, standing or in the hand, against everything but the gripper and what it stands on."""
    wanted = scene.cell.limits.cup_clearance_m
    waiting = [move for move in moves if not move.holds_cup]
    handled = [move for move in moves if move.holds_cup and move.name in ON_STATION]
    carried = [move for move in moves if move.holds_cup and move.name not in ON_STATION]
    smallest = np.inf
    for group in (waiting, handled, carried):
        if not group:
            continue
        ignored = frozenset[str]() if group is carried else supports(scene)
        joints, owners = distinct(group)
        cups = scene.station_pose[None] if group is waiting else scene.held_cups(joints)
        room = scene.cup_clearance(cups, joints, ignored)
        k = int(room.distance_m.argmin())
        distance = float(room.distance_m[k])
        if not distance >= wanted:
            raise MotionError(too_near(group[owners[k]].name, room.nearest(k), distance, wanted))
        smallest = min(smallest, distance)
        if group is handled:
            _check_standing(scene, cups, ignored)
    return smallest


def _check_standing(scene: PourScene, T_base_cup: FloatArray, on: frozenset[str]) -> None:
    """Near its station the cup may be as near to what it stands on as it is above its station."""
    height = T_base_cup[:, 2, 3] - scene.cell.cup_station_m[2]
    kept = [k for k, box in enumerate(scene.obstacles) if box.name in on]
    room = scene.cup_to_boxes(T_base_cup)[:, kept].min(axis=1, initial=np.inf)
    if not (room >= np.minimum(height, scene.cell.limits.cup_clearance_m) - STAND_M).all():
        raise MotionError("In the move 'lift' the cup would touch what it stands on; plan the pour again.")


def distinct(moves: Sequence[PlannedMove]) -> tuple[FloatArray, IntArray]:
    """All different configurations (N, 6) of some moves, and the index (N,) of each one's first move."""
    joints = np.concatenate([move.trajectory.joints_rad for move in moves])
    owners = np.repeat(np.arange(len(moves)), [len(move.trajectory.joints_rad) for move in moves])
    # by their bytes: many times faster than by rows, and ways back hold the very same numbers
    rows = np.ascontiguousarray(joints).view(np.dtype((np.void, joints.itemsize * joints.shape[1])))
    _, first = np.unique(rows, return_index=True)
    first.sort()
    return joints[first], owners[first]
