"""Where the upright cup may be held, and the paths on which it is carried there from above its station.

Placements form a lattice in coordinates natural to the arm: angle about the base's axis, radius, height, and
the hand's azimuth relative to that angle. The lattice is checked once for all pours onto an object.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from core.geometry import BoolArray, FloatArray, IntArray
from core.motion.joint_path import shortcuts
from core.motion.kinematics import TURN_RAD, inverse_kinematics, singularity_measure, wrapped
from core.motion.pour.geometry import upright_grasps
from core.motion.pour.plan import Segment
from core.motion.pour.scene import PourScene, too_close
from core.motion.pour.station import Grip, lifted_m
from core.motion.pour.tool_path import ToolPath

if TYPE_CHECKING:
    from scipy.sparse import csr_array

_N_ANGLES, _N_AZIMUTHS = 16, 12
"""24 and 24 take longer and find fewer pours: those that are tried first are then too similar."""
_ANGLES_RAD = np.arange(_N_ANGLES) * TURN_RAD / _N_ANGLES
_AZIMUTHS_RAD = np.arange(_N_AZIMUTHS) * TURN_RAD / _N_AZIMUTHS
_RADII_M = np.arange(0.2, 0.86, 0.08)
_OVER_M = 0.02
"""Between the object's top and the lowest point of the cup, however it is tilted."""
_HIGHER_M = np.array([0.0, 0.1])
METRE_COST_RAD = 6.0
"""A metre of path costs as much as rotating the hand by this."""
_STEP_COSTS = (
    METRE_COST_RAD * 0.5 * TURN_RAD / _N_ANGLES,
    METRE_COST_RAD * 0.08,
    METRE_COST_RAD * 0.1,
    TURN_RAD / _N_AZIMUTHS,
)
"""Of a step in angle (at half a metre), radius, height and azimuth."""
_SLACK_M, _SINGULARITY_SHARE = 0.001, 1.2
"""Extra margin, for what lies between the few poses that are checked first."""
_LARGEST_STEP_RAD = 1.0
_COARSE_M, _COARSE_RAD = 0.04, np.radians(8)
_SAME = 1e-6
_ENTRIES = 12


@dataclass(frozen=True)
class Lattice:
    """Placements at which a branch of the arm holds the cup upright, clear of everything.

    Attributes:
        branch: of the inverse kinematics.
        places: (U, 4) angle about the base's axis in [0, 2 pi), radius, height of the tool frame's origin,
            and the azimuth of its x-axis relative to that angle.
        net: (U, U) costs of the paths between neighbours, which are clear at both ends.
    """

    branch: int
    places: FloatArray
    net: csr_array

    @property
    def positions_m(self) -> FloatArray:
        """(U, 3) of the tool frame's origin."""
        return place_grasps(self.places)[:, :3, 3]

    @property
    def azimuths_rad(self) -> FloatArray:
        """(U,) of the tool frame's x-axis in the base frame."""
        return np.asarray(self.places[:, 0] + self.places[:, 3])

    def paths_from(self, nodes: IntArray) -> tuple[FloatArray, IntArray]:
        """Cost (U,) of the best path from any of some nodes to each, inf where there is none, and the
        previous node (U,) on it.
        """
        if not len(nodes):
            n = len(self.places)
            return np.full(n, np.inf), np.full(n, -1)
        from scipy.sparse.csgraph import dijkstra  # late: it costs the window memory

        cost, before, _ = dijkstra(self.net, False, nodes, True, min_only=True)
        return cost, before.astype(np.int64)


def place_grasps(places: FloatArray) -> FloatArray:
    """`T_base_grasp` (N, 4, 4) at placements (N, 4)."""
    angle, radius, height, azimuth = places.T
    positions = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=1)
    return upright_grasps(positions, angle + azimuth)


def place_of(position_m: FloatArray, azimuth_rad: float) -> FloatArray:
    """The placement (4,) of a position (3,) and an azimuth."""
    angle = np.arctan2(position_m[1], position_m[0])
    return np.array([angle, np.hypot(position_m[0], position_m[1]), position_m[2], azimuth_rad - angle])


def safe_height_m(scene: PourScene) -> float:
    """Height of the tool frame at which the cup, however tilted, is above the object."""
    cone, grip = scene.cone, scene.cell.grip_height_m
    low = np.hypot(grip, cone.low_radius_m)
    high = np.hypot(cone.height_m - grip, cone.high_radius_m)
    box = scene.obstacles[-1]
    return float(box.T_base_box[2, 3] + box.size_m[2] / 2 + _OVER_M + max(low, high))


def find_lattice(scene: PourScene, branch: int) -> Lattice:
    """Check all placements of a branch, at two heights above the object."""
    heights = safe_height_m(scene) + _HIGHER_M
    axes = _ANGLES_RAD, _RADII_M, heights, _AZIMUTHS_RAD
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    shape = places.shape[:-1]
    # what the arm reaches in one direction it reaches in all: only joint 1 differs
    reach = _reached(scene, branch, place_grasps(places[0].reshape(-1, 4)))[0].reshape(shape[1:])
    clear: BoolArray = np.array(np.broadcast_to(reach, shape), dtype=bool)
    ok, joints = _clear(scene, branch, place_grasps(places[clear]))
    clear[clear] = ok
    return Lattice(branch, places[clear], _net(scene, branch, places, clear, joints[ok]))


def clear_paths(scene: PourScene, branch: int, T_base_grasp: FloatArray) -> BoolArray:
    """Which paths (W,) through poses (W, K, 4, 4) are clear at each pose, without jumps of a joint between
    two of them.
    """
    shape = T_base_grasp.shape[:2]
    ok, joints = _clear(scene, branch, T_base_grasp.reshape(-1, 4, 4))
    are_clear: BoolArray = np.asarray(ok.reshape(shape).all(axis=1), dtype=bool)
    return are_clear & _are_continuous(joints.reshape(*shape, 6))


def why_not(scene: PourScene, branch: int, T_base_grasp: FloatArray, segment: Segment) -> str:
    """A sentence on why a segment's path through poses (K, 4, 4) is not clear."""
    limits, arm = scene.cell.limits, scene.cell.arm
    result = inverse_kinematics(arm, scene.flange_poses(T_base_grasp), (branch,))
    joints = result.joints_rad[:, 0]
    if not result.found.all():
        return f"In the move '{segment.label}' the hand would leave the arm's reach."
    hand = scene.hand.clearance(joints)
    k = int(hand.distance_m.argmin())
    if hand.distance_m[k] < limits.min_clearance_m + _SLACK_M:
        return too_close(segment, hand.nearest(k), float(hand.distance_m[k]), limits.min_clearance_m)
    cup = scene.cup_clearance(scene.held_cups(joints), joints)
    k = int(cup.distance_m.argmin())
    if cup.distance_m[k] < limits.cup_clearance_m:
        return too_close(segment, cup.nearest(k), float(cup.distance_m[k]), limits.cup_clearance_m)
    return f"In the move '{segment.label}' the arm would come too close to a singular configuration."


def _are_continuous(joints_rad: FloatArray) -> BoolArray:
    """Along which paths (W,) of configurations (W, K, 6) no joint jumps."""
    steps = wrapped(np.diff(joints_rad, axis=1))
    continuous: BoolArray = np.abs(steps).max(axis=(1, 2), initial=0) <= _LARGEST_STEP_RAD
    return continuous


def _clear(scene: PourScene, branch: int, T_base_grasp: FloatArray) -> tuple[BoolArray, FloatArray]:
    """Which poses (N, 4, 4) are clear, and the configurations (N, 6)."""
    limits = scene.cell.limits
    ok, joints = _reached(scene, branch, T_base_grasp)
    ok[ok] &= scene.hand.clearance(joints[ok]).distance_m >= limits.min_clearance_m + _SLACK_M
    if ok.any():
        cups, required = scene.held_cups(joints[ok]), limits.cup_clearance_m
        ok[ok] &= scene.cup_clearance(cups, joints[ok], exact_below_m=required).distance_m >= required
    return ok, joints


def _reached(scene: PourScene, branch: int, T_base_grasp: FloatArray) -> tuple[BoolArray, FloatArray]:
    """Which poses (N, 4, 4) are within reach and not near singular, and the configurations (N, 6)."""
    result = inverse_kinematics(scene.cell.arm, scene.flange_poses(T_base_grasp), (branch,))
    ok: BoolArray = result.found[:, 0] & ~result.undetermined[:, 0]
    joints = result.joints_rad[:, 0]
    required = _SINGULARITY_SHARE * scene.cell.limits.min_singularity
    ok[ok] &= singularity_measure(scene.cell.arm, joints[ok]) >= required
    return ok, joints


def _net(
    scene: PourScene, branch: int, places: FloatArray, clear: BoolArray, joints: FloatArray
) -> csr_array:
    """Connect neighbours along each axis of a lattice (A, R, H, Z, 4) where it is also clear half-way;
    `joints` (U, 6) are those of the clear placements.
    """
    from scipy.sparse import coo_array

    n = int(clear.sum())
    numbers = np.full(clear.shape, -1)
    numbers[clear] = np.arange(n)
    starts, ends, costs = [], [], []
    for axis in range(4):
        after = np.roll(numbers, -1, axis)
        if axis in (1, 2):  # the two angles wrap around, radius and height do not
            np.moveaxis(after, axis, 0)[-1] = -1
        both = (numbers >= 0) & (after >= 0)
        starts.append(numbers[both])
        ends.append(after[both])
        costs.append(np.full(int(both.sum()), _STEP_COSTS[axis]))
    start, end = np.concatenate(starts), np.concatenate(ends)
    nodes = places[clear]
    steps = _shorter_way_round(nodes[end] - nodes[start])
    half_way, between = _clear(scene, branch, place_grasps(nodes[start] + steps / 2))
    joined = half_way & _are_continuous(np.stack([joints[start], between, joints[end]], axis=1))
    table = np.concatenate(costs)[joined], (start[joined], end[joined])
    return coo_array(table, shape=(n, n)).tocsr()


@dataclass(frozen=True)
class Stretch:
    """A part of a path, from rest to rest, straight in the coordinates of the lattice's placements.

    Attributes:
        start: (4,) placement: angle, radius, height, azimuth relative to the angle.
        goal: (4,) placement.
    """

    start: FloatArray
    goal: FloatArray

    def poses(self, shares: FloatArray) -> FloatArray:
        """`T_base_grasp` (N, 4, 4) at shares (N,) of it."""
        return place_grasps(self.start + shares[:, None] * (self.goal - self.start))

    @property
    def is_long(self) -> bool:
        """Whether its ends differ."""
        return bool(np.abs(self.goal - self.start).max() > _SAME)

    @property
    def length_m(self) -> float:
        """Approximate distance that the tool frame moves."""
        angle, radius, height, _ = np.abs(self.goal - self.start)
        return float(radius + height + angle * max(self.start[1], self.goal[1]))

    @property
    def rotation_rad(self) -> float:
        """Rotation of the hand about the vertical."""
        change = self.goal - self.start
        return float(abs(change[0] + change[3]))

    @property
    def tool_path(self) -> ToolPath:
        """The same as a path that can be timed."""
        return ToolPath.of_length(self.poses, self.length_m, self.rotation_rad)

    @property
    def coarse(self) -> FloatArray:
        """Poses (K, 4, 4) along it, some centimetres and degrees apart, without its start."""
        angle = np.abs(self.goal - self.start)[[0, 3]].max()
        n = int(max(np.ceil(self.length_m / _COARSE_M), np.ceil(angle / _COARSE_RAD), 1))
        return self.poses(np.linspace(0, 1, n + 1)[1:])


Carry = tuple[Stretch, ...]


class Carrying:
    """All paths from one grip to the placements of a lattice; each is searched for once."""

    def __init__(self, scene: PourScene, grip: Grip, lattice: Lattice) -> None:
        """Find the placements that can be reached from above the station, and from there all others."""
        self.grip = grip
        self._scene = scene
        self._lattice = lattice
        self._start = place_of(lifted_m(scene), grip.azimuth_rad)
        self._cost, self._before = lattice.paths_from(self._entries())
        self._found: dict[int, Carry | None] = {}

    @property
    def cost_rad(self) -> FloatArray:
        """Cost (U,) of reaching each placement; inf where there is no path."""
        return self._cost

    def to(self, node: int) -> Carry | None:
        """A path to a placement, clear at coarse steps: straight, up first, or over the lattice."""
        if node not in self._found:
            self._found[node] = self._find(node)
        return self._found[node]

    def _find(self, node: int) -> Carry | None:
        for path in _straight_paths(self._start, self._lattice.places[node]):
            if self._is_clear(path):
                return path
        corners = self._corners(node)
        for k in range(len(corners) - 1):
            if not self._is_clear((Stretch(corners[k], corners[k + 1]),)):
                return None
        return self._shortened(corners)

    def _entries(self) -> IntArray:
        """Placements that can be reached straight from above the station, of the nearest few."""
        places = self._lattice.places
        apart = _shorter_way_round(places - self._start)
        near = np.argsort(np.abs(apart) @ np.array([1.0, 3.0, 3.0, 0.5]), kind="stable")[:_ENTRIES]
        entered = [int(k) for k in near if self._is_clear((Stretch(self._start, self._start + apart[k]),))]
        return np.array(entered, dtype=np.int64)

    def _corners(self, node: int) -> list[FloatArray]:
        """Placements from above the station over the lattice, each within half a turn of the previous one."""
        nodes = [node]
        while (before := int(self._before[nodes[-1]])) >= 0:
            nodes.append(before)
        corners = [self._start]
        for k in nodes[::-1]:
            corners.append(corners[-1] + _shorter_way_round(self._lattice.places[k] - corners[-1]))
        return corners

    def _shortened(self, corners: list[FloatArray]) -> Carry:
        def is_clear(here: int, there: int) -> bool:
            return self._is_clear((Stretch(corners[here], corners[there]),))

        kept = shortcuts(len(corners), is_clear)
        return tuple(Stretch(corners[here], corners[there]) for here, there in pairwise(kept))

    def _is_clear(self, path: Carry) -> bool:
        poses = np.concatenate([stretch.coarse for stretch in path])
        return bool(clear_paths(self._scene, self._lattice.branch, poses[None]).all())


def _straight_paths(start: FloatArray, goal: FloatArray) -> Iterator[Carry]:
    """Paths between two placements (4,): straight, or up first and then straight."""
    end = start + _shorter_way_round(goal - start)
    yield (Stretch(start, end),)
    corner = start.copy()
    corner[2] = end[2]
    yield tuple(part for part in (Stretch(start, corner), Stretch(corner, end)) if part.is_long)


def _shorter_way_round(change: FloatArray) -> FloatArray:
    """Differences (..., 4) of placements with both angles within half a turn."""
    shorter = change.copy()
    shorter[..., [0, 3]] = wrapped(change[..., [0, 3]])
    return shorter
