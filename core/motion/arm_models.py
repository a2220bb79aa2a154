"""The arms we know: kinematics and limits as published, and their shape as capsules.

Capsules are quick to check, and a little larger than the arm is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import numpy as np

from core.geometry import FloatArray, transform_points

JointValues = tuple[float, float, float, float, float, float]
Point = tuple[float, float, float]
Row = tuple[float, float, float, float]
JOINT_NAMES = ("base", "shoulder", "elbow", "wrist 1", "wrist 2", "wrist 3")
FLANGE_LINK = 6


@dataclass(frozen=True)
class ArmModel:
    """A six-jointed arm of the UR family, by its Denavit-Hartenberg parameters (classic convention).

    The base frame is the UR controller's base frame, the flange frame its tool flange with z out of the
    flange. A real arm differs by its factory calibration, up to some millimetres: `factory_calibration` adds
    it.

    Attributes:
        name: as shown to the user.
        a_m: (6,) link lengths.
        d_m: (6,) link offsets.
        alpha_rad: (6,) link twists.
        lower_rad: (6,) lowest joint angles.
        upper_rad: (6,) highest joint angles.
        speed_limits_rad_s: (6,) highest joint speeds.
        corrections: six small poses (4, 4), the first three rows each, that an arm's own calibration adds
            behind each link; empty: as published.
    """

    name: str
    a_m: JointValues
    d_m: JointValues
    alpha_rad: JointValues
    lower_rad: JointValues
    upper_rad: JointValues
    speed_limits_rad_s: JointValues
    corrections: tuple[tuple[Row, Row, Row], ...] = ()


def _ur_arm(name: str, a_m: JointValues, d_m: JointValues) -> ArmModel:
    """What UR5 and UR5e have in common: twists, +-360 degrees and 180 degrees per second on every joint."""
    return ArmModel(
        name,
        a_m,
        d_m,
        alpha_rad=(pi / 2, 0.0, 0.0, pi / 2, -pi / 2, 0.0),
        lower_rad=_every_joint(-2 * pi),
        upper_rad=_every_joint(2 * pi),
        speed_limits_rad_s=_every_joint(pi),
    )


def _every_joint(value: float) -> JointValues:
    return value, value, value, value, value, value


UR5 = _ur_arm(
    "UR5",
    a_m=(0.0, -0.425, -0.39225, 0.0, 0.0, 0.0),
    d_m=(0.089159, 0.0, 0.0, 0.10915, 0.09465, 0.0823),
)
"""Universal Robots, article 45257 "Parameters for calculations of kinematics and dynamics"; CB3 manual,
table B.4 (the arm's third series)."""

UR5E = _ur_arm(
    "UR5e",
    a_m=(0.0, -0.425, -0.3922, 0.0, 0.0, 0.0),
    d_m=(0.1625, 0.0, 0.0, 0.1333, 0.0997, 0.0996),
)
"""Universal Robots, article 45257 "Parameters for calculations of kinematics and dynamics"."""


_BASE_RADIUS_M = 0.080
_SHOULDER_RADIUS_M = 0.080
_UPPER_ARM_RADIUS_M = 0.083
_ELBOW_RADIUS_M = 0.068
_FOREARM_RADIUS_M = 0.047
_WRIST_RADIUS_M = 0.048
_FLANGE_RADIUS_M = 0.045
"""The UR5's collision meshes in ros-industrial/universal_robot (ur_description) have radii of 60 mm at the
shoulder, the upper arm's ends and the elbow, 50 mm along the upper arm, 38 mm at forearm and wrists, with
lids that protrude by 8 mm. Each radius encloses these with some millimetres to spare; UR5e is built alike."""

_UPPER_ARM_ASIDE_M = 0.136
_FOREARM_ASIDE_M = 0.017
"""Offsets of the two links from the base's axis, along joint 2's axis. The published parameters combine
both in d4; the collision model cannot."""


@dataclass(frozen=True)
class Capsule:
    """All points within a radius of a segment, fixed to a link.

    Attributes:
        name: of the part, as shown to the user.
        link: frame that carries it, 0 (base) to 6 (flange).
        start_m: (3,) one end of the segment in that frame.
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
        capsules: all of them; those of one name are one part.
        pairs: indices of capsules that could touch each other.
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
    """The slimmest capsule along the longest side that encloses a box on the flange, such as a camera's
    housing.

    Args:
        name: of the part.
        T_flange_box: (4, 4) pose of the box's center.
        size_m: (3,) its sides.
    """
    half = np.array(size_m) / 2
    along = int(half.argmax())
    cross_section = float(np.linalg.norm(np.delete(half, along)))
    radius = 1.15 * cross_section
    reach = max(half[along] - np.sqrt(radius**2 - cross_section**2), 0.0)
    ends = np.zeros((2, 3))
    ends[:, along] = -reach, reach
    (x0, y0, z0), (x1, y1, z1) = transform_points(T_flange_box, ends).tolist()
    return Capsule(name, FLANGE_LINK, (x0, y0, z0), (x1, y1, z1), radius)


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
"""Links with at least two joints between them. The others cannot touch, by the arm's build."""
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
