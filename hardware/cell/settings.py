"""The cell file (TOML): devices, calibration and limits, validated; places are in the robot's base frame."""

from __future__ import annotations

from math import pi, radians
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from core.errors import MotionError
from core.geometry import FloatArray
from core.motion.arm_models import UR5, UR5E, ArmModel
from core.motion.pour.cell import MotionSettings
from core.parameters.bodies import CupParameters
from core.parameters.fields import OURS, Group, choice, declaration, quantity
from core.scan.model import CropBox, Intrinsics
from hardware.cell.gripper_settings import (
    CELL,
    Coordinate,
    Edge,
    GripperSettings,
    Joints,
    Point,
    Row,
    refuse_no_pose,
)
from hardware.cell.links import LinkSettings
from hardware.simulation.depth_noise import DepthNoise
from hardware.simulation.set_up import SetUp

ARMS: dict[str, ArmModel] = {"UR5": UR5, "UR5e": UR5E}
"""The models that `robot.model` names."""
SMALLEST_EDGE_M = 0.01


class CameraSettings(Group):
    """Which camera hangs at the flange, and where."""

    kind: Literal["simulated", "realsense", "openni", "replay"] = choice(
        ..., "simulated, realsense, openni (PrimeSense), or replay of a recorded scan.", source=CELL
    )
    serial: str | None = choice(None, "RealSense: its serial number; none: the first one found.", source=CELL)
    recording: Path | None = choice(
        None, "replay: the session or folder to play; RealSense: a .db3 or .bag file instead of a device.",
        source=CELL,
    )  # fmt: skip
    intrinsics: tuple[float, float, float, float] | None = choice(
        None, "openni: fx, fy, cx, cy in pixels at 640 x 480, which the device does not know.", source=CELL
    )
    T_flange_camera: tuple[Row, Row, Row, Row] = choice(
        ..., "Hand-eye calibration: takes camera points (z forward, y down) to the flange.", source=CELL
    )
    size_m: tuple[Edge, Edge, Edge] = quantity(
        (0.18, 0.036, 0.025), "Its housing along its own x, y, z, to be kept clear.", unit="m", source=CELL
    )
    baseline_m: float = quantity(
        0.075, "Where its projector is, along its x.", unit="m", source=CELL, low=0, high=0.3
    )
    min_range_m: float = quantity(
        0.35, "Nearer than this it measures nothing.", unit="m", source=CELL, low=0, high=2
    )

    @model_validator(mode="after")
    def _fits(self) -> CameraSettings:
        refuse_no_pose("T_flange_camera", self.pose)
        if self.kind == "replay" and self.recording is None:
            raise ValueError("a replay camera needs 'recording', the session or folder to play")
        if self.kind == "openni" and self.intrinsics is None:
            raise ValueError("an openni camera needs 'intrinsics': fx, fy, cx, cy")
        return self

    @property
    def pose(self) -> FloatArray:
        """`T_flange_camera` (4, 4)."""
        return np.array(self.T_flange_camera)

    @property
    def replayed(self) -> Path:
        """The session or folder that is played."""
        assert self.recording is not None, "checked by the validator for replay"
        return self.recording

    @property
    def calibrated_intrinsics(self) -> Intrinsics:
        """The intrinsics given in the file."""
        assert self.intrinsics is not None, "checked by the validator for the cameras that need it"
        return Intrinsics(*self.intrinsics)


class RobotSettings(Group):
    """Which arm, and how fast it may move."""

    kind: Literal["simulated", "ur5", "replay"] = choice(
        ...,
        "simulated (in this process), ur5, or replay: it is where the recorded view was taken.",
        source=CELL,
    )
    address: str | None = choice(None, "ur5: the controller's address in the network.", source=CELL)
    model: Literal["UR5", "UR5e"] = choice("UR5", "The arm's model.", source=CELL)
    kinematics_checksum: str | None = choice(
        None, "Of the arm's own kinematics, with which the cell was calibrated; none: not known.",
        source=CELL, is_written=False,
    )  # fmt: skip
    own_kinematics: LinkSettings | None = Field(None, exclude_if=lambda given: given is None)
    home_rad: Joints = choice(..., "Where the arm rests, clear of everything.", source=CELL)
    joint_speed_rad_s: float = quantity(
        0.8, "Speed of the fastest joint while scanning.", unit="rad/s", source=OURS, low=0.01, high=pi
    )
    joint_acceleration_rad_s2: float = quantity(
        1.2, "Acceleration of the fastest joint.", unit="rad/s²", source=OURS, low=0.01, high=40
    )

    @model_validator(mode="after")
    def _fits(self) -> RobotSettings:
        if self.kind == "ur5" and not self.address:
            raise ValueError("a ur5 robot needs 'address', such as \"192.168.0.10\"")
        try:
            _ = self.arm
        except MotionError as error:
            raise ValueError(
                f"own_kinematics is of no {self.model} ({error}); remove it, and calibrate the cell again"
            ) from error
        return self

    @property
    def arm(self) -> ArmModel:
        """By the arm's own kinematics where the file has them, else as published."""
        published = ARMS[self.model]
        return published if self.own_kinematics is None else self.own_kinematics.of(published)

    @property
    def is_real(self) -> bool:
        """Whether a physical arm moves, near which people must take care."""
        return self.kind not in ("simulated", "replay")


class BoxSettings(Group):
    """A box along the base's axes."""

    name: str = choice(..., "What people call it.", source=CELL)
    min_m: Point = quantity(..., "Lower corner.", unit="m", source=CELL)
    max_m: Point = quantity(..., "Upper corner.", unit="m", source=CELL)

    @model_validator(mode="after")
    def _has_volume(self) -> BoxSettings:
        if any(high - low < SMALLEST_EDGE_M for low, high in zip(self.min_m, self.max_m, strict=True)):
            raise ValueError(
                f"max_m of {self.name} must exceed min_m by at least {SMALLEST_EDGE_M} m everywhere"
            )
        return self


class PlaceSettings(Group):
    """Table, platform and where the object may stand."""

    table_height_m: float = quantity(
        ..., "Top of the table that carries robot and platform.", unit="m", source=CELL, low=-2, high=2
    )
    platform_min_m: tuple[Coordinate, Coordinate] = quantity(
        ..., "The transparent platform's lower corner, x and y.", unit="m", source=CELL
    )
    platform_max_m: tuple[Coordinate, Coordinate] = quantity(
        ..., "Its upper corner, x and y.", unit="m", source=CELL
    )
    platform_height_m: float = quantity(
        ..., "The platform's top, which the camera does not see.", unit="m", source=CELL, low=-2, high=2
    )
    crop_min_m: Point = quantity(..., "Lower corner of the box that holds the object.", unit="m", source=CELL)
    crop_max_m: Point = quantity(..., "Upper corner of the box that holds the object.", unit="m", source=CELL)
    cup_station_m: Point = quantity(
        ..., "Middle of the standing cup's foot at its station.", unit="m", source=CELL
    )

    @model_validator(mode="after")
    def _fits(self) -> PlaceSettings:
        if any(b - a < SMALLEST_EDGE_M for a, b in zip(self.crop_min_m, self.crop_max_m, strict=True)):
            raise ValueError(f"crop_max_m must exceed crop_min_m by at least {SMALLEST_EDGE_M} m everywhere")
        if any(
            b - a < SMALLEST_EDGE_M for a, b in zip(self.platform_min_m, self.platform_max_m, strict=True)
        ):
            raise ValueError("platform_max_m must exceed platform_min_m by at least 0.01 m")
        if self.platform_height_m <= self.table_height_m:
            raise ValueError(
                "the platform's top (platform_height_m) must lie above the table (table_height_m)"
            )
        if not self.crop_min_m[2] < self.platform_height_m < self.crop_max_m[2]:
            raise ValueError(
                "platform_height_m must lie between the heights of crop_min_m and crop_max_m: the crop box "
                "begins a little below the platform, where the object stands"
            )
        return self

    @property
    def crop_box(self) -> CropBox:
        """The box that holds the object."""
        return CropBox(self.crop_min_m, self.crop_max_m)

    @property
    def platform_center_m(self) -> FloatArray:
        """Middle (3,) of the platform's top."""
        middle = (np.array(self.platform_min_m) + np.array(self.platform_max_m)) / 2
        return np.array([*middle, self.platform_height_m])


class ScanSettings(Group):
    """How the object is scanned (Sec. IV-A)."""

    views: Literal["planned", "fixed"] = choice(
        "planned", "planned: for the object's box, if views_rad do not suit it; fixed: always views_rad.",
        source=OURS, is_written=False,
    )  # fmt: skip
    views_rad: tuple[Joints, ...] = Field(
        min_length=1,
        max_length=200,
        description="Joint configurations of the views, in their order.",
        json_schema_extra={"unit": "rad", "source": CELL},
    )
    highest_object_m: float = quantity(
        0.42, "Planned views: no object rises higher above the platform.",
        unit="m", source=OURS, low=0.01, high=1, is_written=False,
    )  # fmt: skip
    look_inside: bool = choice(
        True, "A scan ends with up to 4 views into openings of whose inside too much is unseen.",
        source=OURS, is_written=False,
    )  # fmt: skip
    drift_m: float = quantity(
        0.002, "Reference view: a camera that moved farther is warned of.",
        unit="m", source=OURS, low=0.0005, high=0.1, is_written=False,
    )  # fmt: skip
    drift_rad: float = quantity(
        radians(0.3), "Reference view: one that turned by more is warned of.",
        unit="rad", source=OURS, low=radians(0.05), high=0.5, is_written=False,
    )  # fmt: skip
    most_drift_m: float = quantity(
        0.008, "Reference view: with one that moved farther nothing is scanned.",
        unit="m", source=OURS, low=0.0005, high=0.1, is_written=False,
    )  # fmt: skip
    most_drift_rad: float = quantity(
        radians(1.5), "Reference view: with one that turned by more nothing is scanned.",
        unit="rad", source=OURS, low=radians(0.05), high=0.5, is_written=False,
    )  # fmt: skip
    settle_s: float = quantity(
        0.3, "How long the arm must have been at rest before an image.", unit="s", source=OURS, low=0, high=10
    )
    tries: int = quantity(
        3, "How often a view is tried before it is left out.", unit="", source=OURS, low=1, high=20
    )
    min_clearance_m: float = quantity(
        0.02, "Clearance kept around the arm while it moves.", unit="m", source=OURS, low=0, high=0.2
    )


class SimulationSettings(Group):
    """What the simulated cell adds to the real one's file."""

    is_perfect: bool = choice(False, "No noise, no shadow, no pose error: one switch for all.", source=OURS)
    is_instant: bool = choice(
        True, "In a scan, the arm jumps instead of moving as a real one does.", source=OURS
    )
    speed_up: float = quantity(
        1.0,
        "In a pour, how many times faster the simulated controller's clock runs.",
        unit="",
        source=OURS,
        low=1,
        high=20,
    )
    controller_version: Literal["3.15", "5.11"] = choice(
        "3.15", "In a pour, the simulated controller: 3.15 (CB3, 125 Hz) or 5.11 (e-Series, 500 Hz).",
        source=OURS,
    )  # fmt: skip
    noise: DepthNoise = DepthNoise()
    set_up: SetUp | None = Field(None, exclude_if=lambda given: given is None)


class CellSettings(Group):
    """A cell as its file describes it."""

    name: str = choice(..., "What people call it.", source=CELL)
    camera: CameraSettings
    robot: RobotSettings
    gripper: GripperSettings = GripperSettings()
    cup: CupParameters | None = Field(None, exclude_if=lambda given: given is None)
    place: PlaceSettings
    motion: MotionSettings = MotionSettings()
    obstacles: tuple[BoxSettings, ...] = ()
    scan: ScanSettings
    simulation: SimulationSettings = SimulationSettings()
    is_rehearsal: bool = declaration(
        "The arm at the address is driven while a simulated camera sees an object that is not there.",
        source=CELL,
    )

    @property
    def is_simulated(self) -> bool:
        """Whether no real device takes part."""
        return self.has_simulated_object and not self.robot.is_real

    @property
    def has_simulated_object(self) -> bool:
        """Whether the object, and what becomes of the candies, are simulated."""
        return self.camera.kind == "simulated"

    @property
    def true_camera_pose(self) -> FloatArray:
        """`T_flange_camera` (4, 4) as it is: of a simulated set-up perhaps other than the file believes."""
        set_up = self.simulation.set_up
        return self.camera.pose if set_up is None else set_up.camera_pose

    @model_validator(mode="after")
    def _devices_fit(self) -> CellSettings:
        if self.simulation.set_up is not None:
            try:
                self.simulation.set_up.own_arm(ARMS[self.robot.model])
            except MotionError as error:
                raise ValueError(f"lower the link errors of simulation.set_up: {error}") from error
        if (self.camera.kind == "replay") != (self.robot.kind == "replay"):
            raise ValueError("camera and robot must both be of kind 'replay', or neither")
        if self.gripper.kind == "robotiq" and self.robot.kind == "replay":
            raise ValueError('a recorded scan has no gripper; leave out kind = "robotiq"')
        if self.is_rehearsal != (self.has_simulated_object and self.robot.is_real):
            raise ValueError(
                "a simulated camera sees nothing from a real robot; set robot.kind to 'simulated', or "
                "is_rehearsal to true for a robot that goes to an object that is not there"
                if self.has_simulated_object
                else "a rehearsal has a simulated camera and a real robot's driver"
            )
        return self
