"""What planning a pour needs to know of the cell, with the limits of its motion: the cell file's [motion]."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, radians

from pydantic import model_validator

from core.geometry import FloatArray
from core.motion.arm_models import ArmModel, Capsule
from core.motion.clearance import Obstacle
from core.parameters.fields import OURS, Group, quantity

GRIPPER = "gripper"
"""Name of the tool that holds the cup: the only part that may touch it."""


class MotionSettings(Group):
    """Limits of a pour's motion; every plan is checked against them, sample by sample."""

    min_clearance_m: float = quantity(
        0.02,
        "Clearance of arm, gripper and camera: margin for cables and calibration errors.",
        unit="m", source=OURS, low=0, high=0.2,
    )  # fmt: skip
    cup_clearance_m: float = quantity(
        0.004, "Clearance of the cup in the hand.", unit="m", source=OURS, low=0, high=0.1
    )
    max_tilt_rad: float = quantity(
        radians(10), "How far the full cup may tilt while it is carried.", unit="rad", source=OURS, low=0.01,
        high=radians(45),
    )  # fmt: skip
    lift_m: float = quantity(
        0.12,
        "How far the cup is lifted straight up from its station.",
        unit="m",
        source=OURS,
        low=0.02,
        high=0.4,
    )
    joint_speed_rad_s: float = quantity(
        1.0, "Joint speed outside the pour rotation.", unit="rad/s", source=OURS, low=0.05, high=pi
    )
    joint_acceleration_rad_s2: float = quantity(
        2.0, "Joint acceleration outside the pour rotation.", unit="rad/s²", source=OURS, low=0.1, high=20
    )
    tool_speed_m_s: float = quantity(
        0.25,
        "Speed of the cup outside the pour rotation, and of every part of a real arm in a scan.",
        unit="m/s",
        source="ISO 10218-1, reduced speed",
        low=0.01,
        high=1,
    )
    pour_joint_speed_rad_s: float = quantity(
        2.0, "Joint speed during the pour rotation.", unit="rad/s", source=OURS, low=0.05, high=pi
    )
    pour_acceleration_rad_s2: float = quantity(
        8.0, "Joint acceleration during the pour rotation.", unit="rad/s²", source=OURS, low=0.1,
        high=40,
    )  # fmt: skip
    min_singularity: float = quantity(
        0.02,
        "Smallest singular value of the Jacobian that is allowed.",
        unit="",
        source=OURS,
        low=0.001,
        high=0.2,
    )
    pivot_tolerance_m: float = quantity(
        0.0005,
        "How far the pivot may move during the pour rotation.",
        unit="m",
        source=OURS,
        low=0.00001,
        high=0.01,
    )
    max_force_n: float = quantity(
        50.0,
        "How much harder something may push at the hand with the cup than when a move began.",
        unit="N", source=OURS, low=5, high=250, is_written=False,
    )  # fmt: skip
    first_pour_speed: float = quantity(
        0.4,
        "Share of the speeds outside the pour rotation at which a real arm makes a session's first pour.",
        unit="", source=OURS, low=0.1, high=1, is_written=False,
    )  # fmt: skip
    expires_s: float = quantity(
        600.0, "How long after planning a plan may be executed.", unit="s", source=OURS, low=10, high=86400
    )

    @model_validator(mode="after")
    def _agree(self) -> MotionSettings:
        if self.cup_clearance_m > self.min_clearance_m:
            raise ValueError(
                "cup_clearance_m must not exceed min_clearance_m, which holds for the hand around it"
            )
        return self


@dataclass(frozen=True)
class PourCell:
    """The arm, its tools, the obstacles around it and the cup's station, in the arm's base frame.

    Attributes:
        arm: its kinematics.
        tools: capsules on the flange; the one named "gripper" holds the cup.
        obstacles: without the object.
        home_rad: (6,) the arm's home configuration.
        cup_station_m: (3,) center of the base of the cup that stands at its station.
        T_flange_grasp: (4, 4) the tool frame: origin on the axis of the held cup, z along it to the mouth.
        grip_height_m: the tool frame's origin above the cup's outer base.
        limits: of the motion.
    """

    arm: ArmModel
    tools: tuple[Capsule, ...]
    obstacles: tuple[Obstacle, ...]
    home_rad: FloatArray
    cup_station_m: FloatArray
    T_flange_grasp: FloatArray
    grip_height_m: float
    limits: MotionSettings
