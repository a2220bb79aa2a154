"""One interface a capability; real devices and their simulated twins implement the same.

All of them are context managers: entering connects, leaving disconnects, and each may be entered again.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy.typing as npt

from core.geometry import FloatArray
from core.scan.model import ColorImage, DepthImage, Intrinsics


@dataclass(frozen=True)
class CameraImage:
    """One shot of an RGB-D camera.

    Attributes:
        color: (H, W, 3) uint8, RGB.
        depth_m: (H, W) float32, along the optical axis, registered to the colour; 0 = not measured.
        intrinsics: of both, for this resolution.
        time_s: when it was taken, in seconds of a clock that only goes forwards; not the time of day.
    """

    color: ColorImage
    depth_m: DepthImage
    intrinsics: Intrinsics
    time_s: float


class _Device(Protocol):
    def __enter__(self) -> object: ...

    def __exit__(self, *exception: object) -> None: ...


class Camera(_Device, Protocol):
    """An RGB-D camera.

    Attributes:
        name: what people call it, with its serial number where it has one.
    """

    name: str

    def capture(self) -> CameraImage:
        """Take an image now: nothing that was exposed before the call is returned.

        Raises:
            CameraError: no usable image came; another try may succeed.
            CameraLost: the camera is not there; it has to be connected again.
        """
        ...


@dataclass(frozen=True)
class RobotState:
    """What the robot says of itself.

    Attributes:
        joints_rad: (6,) where the joints are.
        joint_speeds_rad_s: (6,) how fast they turn.
        T_base_flange: (4, 4) where that puts the flange.
        time_s: when it was so, in seconds of a clock that only goes forwards.
    """

    joints_rad: FloatArray
    joint_speeds_rad_s: FloatArray
    T_base_flange: FloatArray
    time_s: float


class Move(Protocol):
    """A motion on its way."""

    @property
    def is_done(self) -> bool:
        """Whether it has ended, at its target or not."""
        ...

    @property
    def progress(self) -> float:
        """Share of the way that is done, 0 to 1."""
        ...

    def wait(self, timeout_s: float) -> None:
        """Wait until the target is reached.

        Raises:
            RobotStopped: the motion ended elsewhere.
            RobotError: it did not end in time, or the robot cannot be reached.
        """
        ...

    def stop(self) -> None:
        """Stop where the arm is now, with the usual deceleration."""
        ...


class Robot(_Device, Protocol):
    """A six-jointed arm.

    Attributes:
        name: what people call it.
    """

    name: str

    def state(self) -> RobotState:
        """Return the newest state.

        Raises:
            RobotError: the robot cannot be reached.
        """
        ...

    def move_joints(self, path_rad: npt.ArrayLike, speed_rad_s: float, acceleration_rad_s2: float) -> Move:
        """Start to move through joint configurations (N, 6), straight in joint space; return at once.

        The path must have been checked: the robot itself knows no obstacles.

        Raises:
            RobotError: the robot refuses or cannot be reached.
        """
        ...

    def stop(self) -> None:
        """Stop whatever moves; safe from any thread."""
        ...


class Gripper(_Device, Protocol):
    """Something that holds the cup.

    Attributes:
        name: what people call it.
    """

    name: str

    @property
    def is_closed(self) -> bool:
        """Whether it was last told to close, as read back from the device."""
        ...

    def close(self) -> None:
        """Close it and return when it had the time to."""
        ...

    def open(self) -> None:
        """Open it and return when it had the time to."""
        ...
