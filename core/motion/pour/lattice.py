"""Where the upright cup may be held, and how it gets from one such place to another.

Places are a lattice in what is natural to the arm: angle about the base's axis, radius, height, and the
hand's azimuth against that angle. What is clear is looked at once for all pours onto an object.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from core.geometry import BoolArray, FloatArray, IntArray
from core.motion.inverse_kinematics import inverse_kinematics
from core.motion.kinematics import TURN_RAD, singularity_measure
from core.motion.pour.geometry import upright_grasps
from core.motion.pour.scene import PourScene, too_near

_N_ANGLES, _N_AZIMUTHS = 16, 12
"""24 and 24 take longer and find fewer pours: the places that are tried first then lie too near together."""
_ANGLES_RAD = np.arange(_N_ANGLES) * TURN_RAD / _N_ANGLES
_AZIMUTHS_RAD = np.arange(_N_AZIMUTHS) * TURN_RAD / _N_AZIMUTHS
_RADII_M = np.arange(0.2, 0.86, 0.08)
_OVER_M = 0.02
"""Between the object's top and the lowest point of the cup however it tilts."""
_HIGHER_M = np.array([0.0, 0.1])
METRE_COST_RAD = 6.0
"""A way of a metre costs as much as turning the hand by this."""

_SLACK_M, _SINGULARITY_SHARE = 0.001, 1.2
"""More than what must stay, for what lies between the few places that are looked at first."""
_MOST_STEP_RAD = 1.0


@dataclass(frozen=True)
class Lattice:
    """Places at which a branch of the arm holds the cup upright, clear of everything.

    Attributes:
        branch: of the inverse kinematics.
        places: (U, 4) angle about the base's axis in [0, 2 pi), radius, height of the tool frame's origin,
            and the azimuth of its x-axis against that angle.
        net: (U, U) costs of the ways between neighbours, which are clear at both ends.
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

    def ways_from(self, nodes: IntArray) -> tuple[FloatArray, IntArray]:
        """Cost (U,) of the best way from one of some nodes to each, inf where there is none, and the node
        before each on it.
        """
        if not len(nodes):
            n = len(self.places)
            return np.full(n, np.inf), np.full(n, -1)
        cost, before, _ = dijkstra(self.net, False, nodes, True, min_only=True)
        return cost, before.astype(np.int64)


def place_grasps(places: FloatArray) -> FloatArray:
    """`T_base_grasp` (N, 4, 4) at places (N, 4)."""
    angle, radius, height, azimuth = places.T
    positions = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=1)
    return upright_grasps(positions, angle + azimuth)


def place_of(position_m: FloatArray, azimuth_rad: float) -> FloatArray:
    """The place (4,) of a position (3,) and an azimuth."""
    angle = np.arctan2(position_m[1], position_m[0])
    return np.array([angle, np.hypot(position_m[0], position_m[1]), position_m[2], azimuth_rad - angle])


def safe_height_m(scene: PourScene) -> float:
    """How high the tool frame must be for the cup, however tilted, to be over the object."""
    cone, grip = scene.cone, scene.cell.grip_height_m
    low = np.hypot(grip, cone.low_radius_m)
    high = np.hypot(cone.height_m - grip, cone.high_radius_m)
    box = scene.obstacles[-1]
    return float(box.T_base_box[2, 3] + box.size_m[2] / 2 + _OVER_M + max(low, high))


def find_lattice(scene: PourScene, branch: int) -> Lattice:
    """Look at all places of a branch, at two heights over the object."""
    heights = safe_height_m(scene) + _HIGHER_M
    axes = _ANGLES_RAD, _RADII_M, heights, _AZIMUTHS_RAD
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    shape = places.shape[:-1]
    # whatever the arm can reach in one direction it can in all: only joint 1 differs
    reach = _is_reached(scene, branch, places[0].reshape(-1, 4)).reshape(shape[1:])
    clear: BoolArray = np.array(np.broadcast_to(reach, shape), dtype=bool)
    ok, joints = _clear(scene, branch, place_grasps(places[clear]))
    clear[clear] = ok
    return Lattice(branch, places[clear], _net(scene, branch, places, clear, joints[ok]))


def clear_ways(scene: PourScene, branch: int, T_base_grasp: FloatArray) -> BoolArray:
    """Which ways (W,) through poses (W, K, 4, 4) are clear at each pose, no joint flinging round between
    two of them.
    """
    shape = T_base_grasp.shape[:2]
    ok, joints = _clear(scene, branch, T_base_grasp.reshape(-1, 4, 4))
    are_clear: BoolArray = np.asarray(ok.reshape(shape).all(axis=1), dtype=bool)
    return are_clear & _are_even(joints.reshape(*shape, 6))


def why_not(scene: PourScene, branch: int, T_base_grasp: FloatArray, name: str) -> str:
    """Say in a sentence why a way through poses (K, 4, 4) is not clear, for a move of this name."""
    limits, arm = scene.cell.limits, scene.cell.arm
    result = inverse_kinematics(arm, scene.flange_poses(T_base_grasp), (branch,))
    joints = result.joints_rad[:, 0]
    if not result.found.all():
        return f"In the move '{name}' the hand would leave the arm's reach."
    room = scene.hand.clearance(joints)
    k = int(room.distance_m.argmin())
    if room.distance_m[k] < limits.min_clearance_m + _SLACK_M:
        return too_near(name, room.nearest(k), float(room.distance_m[k]), limits.min_clearance_m)
    around = scene.cup_clearance(scene.held_cups(joints), joints)
    k = int(around.distance_m.argmin())
    if around.distance_m[k] < limits.cup_clearance_m:
        return too_near(name, around.nearest(k), float(around.distance_m[k]), limits.cup_clearance_m)
    return f"In the move '{name}' the arm would come too near to a singular configuration."


def _are_even(joints_rad: FloatArray) -> BoolArray:
    """Along which ways (W,) of configurations (W, K, 6) no joint flings round."""
    steps = np.diff(joints_rad, axis=1)
    steps -= TURN_RAD * np.round(steps / TURN_RAD)
    even: BoolArray = np.abs(steps).max(axis=(1, 2), initial=0) <= _MOST_STEP_RAD
    return even


def _clear(scene: PourScene, branch: int, T_base_grasp: FloatArray) -> tuple[BoolArray, FloatArray]:
    """Which poses (N, 4, 4) are clear, and the configurations (N, 6)."""
    limits, arm = scene.cell.limits, scene.cell.arm
    result = inverse_kinematics(arm, scene.flange_poses(T_base_grasp), (branch,))
    ok: BoolArray = result.found[:, 0] & ~result.undetermined[:, 0]
    joints = result.joints_rad[:, 0]
    ok[ok] &= singularity_measure(arm, joints[ok]) >= _SINGULARITY_SHARE * limits.min_singularity
    ok[ok] &= scene.hand.clearance(joints[ok]).distance_m >= limits.min_clearance_m + _SLACK_M
    if ok.any():
        cups, wanted = scene.held_cups(joints[ok]), limits.cup_clearance_m
        ok[ok] &= scene.cup_clearance(cups, joints[ok], exact_below_m=wanted).distance_m >= wanted
    return ok, joints


def _is_reached(scene: PourScene, branch: int, places: FloatArray) -> BoolArray:
    poses = scene.flange_poses(place_grasps(places))
    result = inverse_kinematics(scene.cell.arm, poses, (branch,))
    reached: BoolArray = result.found[:, 0] & ~result.undetermined[:, 0]
    wanted = _SINGULARITY_SHARE * scene.cell.limits.min_singularity
    return reached & (singularity_measure(scene.cell.arm, result.joints_rad[:, 0]) >= wanted)


def _net(
    scene: PourScene, branch: int, places: FloatArray, clear: BoolArray, joints: FloatArray
) -> csr_array:
    """Join neighbours along each axis of a lattice (A, R, H, Z, 4) where it is clear half-way, too; `joints`
    (U, 6) are those of the clear places.
    """
    n = int(clear.sum())
    numbers = np.full(clear.shape, -1)
    numbers[clear] = np.arange(n)
    starts, ends, costs = [], [], []
    for axis in range(4):
        after = np.roll(numbers, -1, axis)
        if axis in (1, 2):  # the two angles go round, radius and height do not
            np.moveaxis(after, axis, 0)[-1] = -1
        both = (numbers >= 0) & (after >= 0)
        starts.append(numbers[both])
        ends.append(after[both])
        costs.append(np.full(int(both.sum()), _STEP_COSTS[axis]))
    start, end = np.concatenate(starts), np.concatenate(ends)
    nodes = places[clear]
    steps = nodes[end] - nodes[start]
    steps[:, [0, 3]] -= TURN_RAD * np.round(steps[:, [0, 3]] / TURN_RAD)
    half_way, between = _clear(scene, branch, place_grasps(nodes[start] + steps / 2))
    joined = half_way & _are_even(np.stack([joints[start], between, joints[end]], axis=1))
    table = np.concatenate(costs)[joined], (start[joined], end[joined])
    return coo_array(table, shape=(n, n)).tocsr()


_STEP_COSTS = (
    METRE_COST_RAD * 0.5 * TURN_RAD / _N_ANGLES,
    METRE_COST_RAD * 0.08,
    METRE_COST_RAD * 0.1,
    TURN_RAD / _N_AZIMUTHS,
)
"""Of a step in angle (at half a metre), radius, height and azimuth."""
