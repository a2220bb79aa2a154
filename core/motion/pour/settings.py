"""How the arm may move with the cup in its hand: the cell file's section [motion]."""

from __future__ import annotations

from math import pi, radians

from pydantic import model_validator

from core.parameters.fields import OURS, Group, quantity


class MotionSettings(Group):
    """Limits of the pour's motion; every plan is checked against them, sample by sample."""

    min_clearance_m: float = quantity(
        0.02,
        "What stays free around arm, gripper and camera: room for cables and calibration errors.",
        unit="m", source=OURS, low=0, high=0.2,
    )  # fmt: skip
    cup_clearance_m: float = quantity(
        0.004, "What stays free around the cup in the hand.", unit="m", source=OURS, low=0, high=0.1
    )
    max_tilt_rad: float = quantity(
        radians(10), "How far the cup may lean while it is carried full.", unit="rad", source=OURS, low=0.01,
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
        1.0, "Fastest joint on the way.", unit="rad/s", source=OURS, low=0.05, high=pi
    )
    joint_acceleration_rad_s2: float = quantity(
        2.0, "Acceleration of the fastest joint on the way.", unit="rad/s²", source=OURS, low=0.1, high=20
    )
    tool_speed_m_s: float = quantity(
        0.25,
        "Fastest the cup moves on the way.",
        unit="m/s",
        source="ISO 10218-1, reduced speed",
        low=0.01,
        high=1,
    )
    pour_joint_speed_rad_s: float = quantity(
        2.0, "Fastest joint in the turn that pours.", unit="rad/s", source=OURS, low=0.05, high=pi
    )
    pour_acceleration_rad_s2: float = quantity(
        8.0, "Acceleration of the fastest joint in the turn that pours.", unit="rad/s²", source=OURS, low=0.1,
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
        0.0005, "How far the pivot may wander during the turn.", unit="m", source=OURS, low=0.00001, high=0.01
    )
    expires_s: float = quantity(
        600.0, "How long after planning a plan may be carried out.", unit="s", source=OURS, low=10, high=86400
    )

    @model_validator(mode="after")
    def _agree(self) -> MotionSettings:
        if self.cup_clearance_m > self.min_clearance_m:
            raise ValueError(
                "cup_clearance_m must not exceed min_clearance_m, which holds for the hand around it"
            )
        return self
