"""The arms we know: their kinematics and limits as the maker publishes them."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

JointValues = tuple[float, float, float, float, float, float]


@dataclass(frozen=True)
class ArmModel:
    """A six-jointed arm of the UR family, by its Denavit-Hartenberg parameters (classic convention).

    The base frame is the UR controller's base frame, the flange frame its tool flange with z out of the
    flange. A real arm differs by its factory calibration, up to some millimetres.

    Attributes:
        name: what people call it.
        a_m: (6,) link lengths.
        d_m: (6,) link offsets.
        alpha_rad: (6,) link twists.
        lower_rad: (6,) lowest joint angles.
        upper_rad: (6,) highest joint angles.
        speed_limits_rad_s: (6,) highest joint speeds.
    """

    name: str
    a_m: JointValues
    d_m: JointValues
    alpha_rad: JointValues
    lower_rad: JointValues
    upper_rad: JointValues
    speed_limits_rad_s: JointValues


def _ur_arm(name: str, a_m: JointValues, d_m: JointValues) -> ArmModel:
    """What UR5 and UR5e have in common: twists, +-360 degrees and 180 degrees per second on every joint."""
    turn, half_turn = 2 * pi, pi
    return ArmModel(
        name,
        a_m,
        d_m,
        alpha_rad=(pi / 2, 0.0, 0.0, pi / 2, -pi / 2, 0.0),
        lower_rad=(-turn, -turn, -turn, -turn, -turn, -turn),
        upper_rad=(turn, turn, turn, turn, turn, turn),
        speed_limits_rad_s=(half_turn, half_turn, half_turn, half_turn, half_turn, half_turn),
    )


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
