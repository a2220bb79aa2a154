"""What a pour's motion must know of the cell."""

from __future__ import annotations

from dataclasses import dataclass

from core.geometry import FloatArray
from core.motion.arm_models import ArmModel
from core.motion.arm_shape import Capsule
from core.motion.clearance import Obstacle
from core.motion.pour.settings import MotionSettings

GRIPPER = "gripper"
"""Name of the tool that holds the cup: the only part that may touch it."""


@dataclass(frozen=True)
class PourCell:
    """The arm, what it carries, what stands around it and where the cup waits; in the arm's base frame.

    Attributes:
        arm: its model.
        tools: capsules on the flange; the one named "gripper" holds the cup.
        obstacles: what stands around, without the object.
        home_rad: (6,) where the arm rests.
        cup_station_m: (3,) middle of the standing cup's base at its station.
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
