"""The cell file's section `[gripper]`, and the values of which the sections are made."""

from __future__ import annotations

from math import pi
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from core.geometry import FloatArray, rotation_error
from core.parameters.fields import Group, choice, quantity
from hardware.grippers.robotiq import MODELS, Grip
from hardware.grippers.robotiq_line import ROBOTIQ_PORT

CELL = "the cell's calibration"
ROTATION_TOLERANCE = 1e-3

Coordinate = Annotated[float, Field(ge=-10, le=10)]
Point = tuple[Coordinate, Coordinate, Coordinate]
Edge = Annotated[float, Field(gt=0, le=1)]
Angle = Annotated[float, Field(ge=-2 * pi, le=2 * pi)]
Joints = tuple[Angle, Angle, Angle, Angle, Angle, Angle]
Row = tuple[Coordinate, Coordinate, Coordinate, Coordinate]


_GRASP: tuple[Row, Row, Row, Row] = (
    (1.0, 0.0, 0.0, 0.0),
    (0.0, 0.0, -1.0, 0.0),
    (0.0, 1.0, 0.0, 0.15),
    (0.0, 0.0, 0.0, 1.0),
)
"""The cup's axis 0.15 m before the flange, its mouth towards -y, where the camera is."""


def refuse_no_pose(name: str, pose: FloatArray) -> None:
    """Refuse a matrix (4, 4) that is no pose.

    Raises:
        ValueError: it is none; `name` is its name in the file.
    """
    if np.abs(pose[3] - [0, 0, 0, 1]).max() > 0 or rotation_error(pose[:3, :3]) > ROTATION_TOLERANCE:
        raise ValueError(f"{name} is not a pose: its 3x3 part must be a rotation, its last row 0 0 0 1")


class GripperSettings(Group):
    """What holds the cup."""

    kind: Literal["simulated", "ur5", "robotiq"] = choice(
        "simulated",
        "simulated; ur5: by a digital output of the arm's tool; or robotiq: by its own socket protocol.",
        source=CELL,
    )
    model: Literal["2F-85", "2F-140", "Hand-E"] | None = choice(
        None, "robotiq: which one.", source=CELL, is_written=False
    )
    address: str | None = choice(
        None, "robotiq: where it is served; none: at the arm's controller.", source=CELL, is_written=False
    )
    port: int = quantity(
        ROBOTIQ_PORT, "robotiq: the port of its URCap.", unit="", source=CELL, low=1, high=65535,
        is_written=False,
    )  # fmt: skip
    open_width_m: float | None = quantity(
        None, "robotiq: between the open fingers; none: as wide as they go.", unit="m", source=CELL,
        low=0, high=0.14, is_written=False,
    )  # fmt: skip
    closed_width_m: float = quantity(
        0.0, "robotiq: where the fingers go when they close; less than the cup is wide there.", unit="m",
        source=CELL, low=0, high=0.14, is_written=False,
    )  # fmt: skip
    force: float = quantity(
        0.2, "robotiq: share of its force with which it closes.", unit="", source=CELL, low=0, high=1,
        is_written=False,
    )  # fmt: skip
    speed: float = quantity(
        0.5, "robotiq: share of its speed.", unit="", source=CELL, low=0, high=1, is_written=False
    )
    output: int = quantity(
        0,
        "Tool digital output that closes it (afag EU-20 in the paper).",
        unit="",
        source="paper",
        low=0,
        high=1,
    )
    voltage_v: Literal[12, 24] = choice(
        24, "ur5: supply of the tool connector, which is set on connecting (afag EU-20: 24 V).", source=CELL
    )
    radius_m: float = quantity(
        0.04, "Radius of the capsule it fills.", unit="m", source=CELL, low=0.005, high=0.3
    )
    length_m: float = quantity(
        0.12, "How far it reaches beyond the flange.", unit="m", source=CELL, low=0, high=0.5
    )
    T_flange_grasp: tuple[Row, Row, Row, Row] = choice(
        _GRASP,
        "The robot's tool frame: origin on the axis of the cup in the hand, z along it to the cup's mouth.",
        source=CELL,
    )
    grip_height_m: float = quantity(
        0.07, "How far above the cup's base it grips.", unit="m", source=CELL, low=0.005, high=0.5
    )
    payload_kg: float = quantity(
        1.2, "Mass at the flange: gripper, camera and full cup.", unit="kg", source=CELL, low=0, high=5
    )
    payload_center_m: Point = quantity(
        (0.0, -0.02, 0.07), "Their centre of mass, in the flange's frame.", unit="m", source=CELL
    )
    cup_kg: float = quantity(
        0.0, "Of that the full cup: the controller is told when the hand takes and leaves it; 0: it is not.",
        unit="kg", source=CELL, low=0, high=5, is_written=False,
    )  # fmt: skip
    action_s: float = quantity(0.5, "Time it takes to open or close.", unit="s", source=CELL, low=0, high=10)

    @model_validator(mode="after")
    def _grasps(self) -> GripperSettings:
        refuse_no_pose("T_flange_grasp", self.grasp_pose)
        if self.cup_kg > self.payload_kg:
            raise ValueError("cup_kg is a part of payload_kg and must not exceed it")
        if self.kind == "robotiq":
            self._refuse_other_widths()
        elif self.model is not None:
            raise ValueError(f"model is said of a robotiq gripper, and kind is '{self.kind}'")
        return self

    def _refuse_other_widths(self) -> None:
        if self.model is None:
            raise ValueError(f"a robotiq gripper needs 'model': one of {', '.join(MODELS)}")
        stroke_m = MODELS[self.model].stroke_m
        if self.grip.open_m > stroke_m:
            raise ValueError(f"a {self.model} opens to {stroke_m:g} m and no wider (open_width_m)")
        if self.closed_width_m >= self.grip.open_m:
            raise ValueError("closed_width_m must be less than open_width_m")

    @property
    def grip(self) -> Grip:
        """How a robotiq gripper opens and closes."""
        assert self.model is not None, "checked by the validator for robotiq"
        open_m = MODELS[self.model].stroke_m if self.open_width_m is None else self.open_width_m
        return Grip(open_m, self.closed_width_m, self.force, self.speed)

    @property
    def grasp_pose(self) -> FloatArray:
        """`T_flange_grasp` (4, 4), which is the robot's tool frame."""
        return np.array(self.T_flange_grasp)
