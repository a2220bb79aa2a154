"""The arm, and what its flange carries, as capsules: quick to check, and a little larger than the arm is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray, transform_points
from core.motion.arm_models import ArmModel

Point = tuple[float, float, float]
FLANGE_LINK = 6

_BASE_RADIUS_M = 0.080
_SHOULDER_RADIUS_M = 0.080
_UPPER_ARM_RADIUS_M = 0.083
_ELBOW_RADIUS_M = 0.068
_FOREARM_RADIUS_M = 0.047
_WRIST_RADIUS_M = 0.048
_FLANGE_RADIUS_M = 0.045
"""The collision meshes of UR5 in ros-industrial/universal_robot (ur_description) measure 60 mm around the
shoulder, the upper arm's ends and the elbow, 50 mm around the upper arm, 38 mm around forearm and wrists,
with lids that stand 8 mm out. Each radius takes these in with some millimetres left; UR5e is built alike."""

_UPPER_ARM_ASIDE_M = 0.136
_FOREARM_ASIDE_M = 0.017
"""How far the two links lie beside the base's axis, along joint 2's axis. The published parameters collect
both in d4, the collision model cannot."""


@dataclass(frozen=True)
class Capsule:
    """All points within a radius of a segment, fixed to a link.

    Attributes:
        name: of the part, as a person would call it.
        link: frame that carries it, 0 (base) to 6 (flange).
        start_m: (3,) the segment's one end in that frame.
        end_m: (3,) its other end.
        radius_m: around the segment.
    """

    name: str
    link: int
    start_m: Point
    end_m: Point
    radius_m: float


@dataclass(frozen=True)
class ArmShape:
    """Capsules of the arm and of its tools.

    Attributes:
        capsules: all of them; parts of one name belong together.
        pairs: indices of two capsules that could touch each other.
    """

    capsules: tuple[Capsule, ...]
    pairs: tuple[tuple[int, int], ...]


def arm_shape(arm: ArmModel, tools: Sequence[Capsule] = ()) -> ArmShape:
    """Build the shape of an arm with tools (capsules on link 6, the flange)."""
    capsules = (*_arm_capsules(arm), *tools)
    pairs = [
        (i, j)
        for i, first in enumerate(capsules)
        for j, second in enumerate(capsules)
        if (first.name, second.name) in _SELF_PAIRS
        or (second.link == FLANGE_LINK and first.name in _NEAR_TOOLS)
    ]
    return ArmShape(capsules, tuple(pairs))


def capsule_around_box(name: str, T_flange_box: FloatArray, size_m: Point) -> Capsule:
    """The slimmest capsule along the longest side that takes in a box on the flange, such as a camera's
    housing.

    Args:
        name: of the part.
        T_flange_box: (4, 4) pose of the box's middle.
        size_m: (3,) its sides.
    """
    half = np.array(size_m) / 2
    along = int(half.argmax())
    cross_section = float(np.linalg.norm(np.delete(half, along)))
    radius = 1.15 * cross_section
    reach = max(half[along] - np.sqrt(radius**2 - cross_section**2), 0.0)
    ends = np.zeros((2, 3))
    ends[:, along] = -reach, reach
    start, end = transform_points(T_flange_box, ends)
    return Capsule(name, FLANGE_LINK, _point(start), _point(end), radius)


def _point(values: FloatArray) -> Point:
    return float(values[0]), float(values[1]), float(values[2])


_SELF_PAIRS = {
    ("base", "forearm"),
    ("base", "elbow"),
    ("base", "wrist 1"),
    ("base", "wrist 2"),
    ("base", "wrist 3"),
    ("shoulder", "forearm"),
    ("shoulder", "wrist 1"),
    ("shoulder", "wrist 2"),
    ("shoulder", "wrist 3"),
    ("upper arm", "wrist 1"),
    ("upper arm", "wrist 2"),
    ("upper arm", "wrist 3"),
    ("elbow", "wrist 2"),
    ("elbow", "wrist 3"),
    ("forearm", "wrist 3"),
}
"""Links with at least two joints between them. The others are held apart by the arm's build."""
_NEAR_TOOLS = {"base", "shoulder", "upper arm", "elbow", "forearm", "wrist 1"}


def _arm_capsules(arm: ArmModel) -> tuple[Capsule, ...]:
    d1, d4, d5, d6 = arm.d_m[0], arm.d_m[3], arm.d_m[4], arm.d_m[5]
    a2, a3 = -arm.a_m[1], -arm.a_m[2]
    high, low = _UPPER_ARM_ASIDE_M, _FOREARM_ASIDE_M
    stub = 0.027  # the housings reach through their joints to the far side
    return (
        Capsule("base", 0, (0, 0, 0), (0, 0, d1), _BASE_RADIUS_M),
        Capsule("shoulder", 1, (0, 0, 0), (0, 0, high), _SHOULDER_RADIUS_M),
        Capsule("upper arm", 2, (a2, 0, high), (0, 0, high), _UPPER_ARM_RADIUS_M),
        Capsule("elbow", 3, (a3, 0, low - 0.01), (a3, 0, low + 0.02), _ELBOW_RADIUS_M),
        Capsule("forearm", 3, (a3, 0, low), (0, 0, low), _FOREARM_RADIUS_M),
        Capsule("wrist 1", 3, (0, 0, -stub), (0, 0, d4 + 0.01), _WRIST_RADIUS_M),
        Capsule("wrist 2", 4, (0, 0, -stub), (0, 0, d5), _WRIST_RADIUS_M),
        Capsule("wrist 3", 5, (0, 0, -stub), (0, 0, d6 - 0.03), _FLANGE_RADIUS_M),
    )
