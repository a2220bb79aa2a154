"""One interface a capability; real devices and their simulated twins implement the same.

All of them are context managers: entering connects, leaving disconnects, and each may be entered again.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from enum import Enum
from typing import Protocol

import numpy.typing as npt

from core.geometry import FloatArray
from core.motion.arm_models import ArmModel
from core.motion.factory_calibration import MeasuredKinematics
from core.motion.margin import PathMargin
from core.motion.trajectory import JointTrajectory
from core.scan.model import ColorImage, DepthImage, Intrinsics
from hardware.errors import RobotError
from hardware.modes import RobotMode, SafetyMode


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
    """What the robot reports of itself.

    Attributes:
        joints_rad: (6,) where the joints are.
        target_joints_rad: (6,) where the controller wants them to be at this moment.
        joint_speeds_rad_s: (6,) how fast they rotate.
        T_base_flange: (4, 4) where that puts the flange.
        T_base_tool: (4, 4) the tool's pose, as the controller reports it.
        robot_mode: how far the arm is switched on.
        safety_mode: whether the safety system lets it move.
        is_program_running: whether it would take a command.
        tool_outputs: the two digital outputs of the tool, as read back.
        speed_scaling: what the speed slider makes of all speeds, 0 to 1.
        controller_s: the controller's own time stamp, which rises as long as it sends.
        time_s: when this state came, in seconds of `time.monotonic`.
        tool_force_n: how hard something pushes at the tool, as far as the controller can tell.
    """

    joints_rad: FloatArray
    target_joints_rad: FloatArray
    joint_speeds_rad_s: FloatArray
    T_base_flange: FloatArray
    T_base_tool: FloatArray
    robot_mode: RobotMode
    safety_mode: SafetyMode
    is_program_running: bool
    tool_outputs: tuple[bool, bool]
    speed_scaling: float
    controller_s: float
    time_s: float
    tool_force_n: float = 0.0

    @property
    def age_s(self) -> float:
        """How long ago it came."""
        return time.monotonic() - self.time_s


@dataclass(frozen=True)
class Kinematics:
    """Where an arm's joints put its flange.

    Attributes:
        model: by the arm's own calibration where that is known, else as published.
        checksum: of that calibration, as its controller has it; empty if it is not known.
        measured: that calibration; none if it is not known.
        caution: what it costs that it is not known, and what to do; empty where it costs nothing.
    """

    model: ArmModel
    checksum: str = ""
    measured: MeasuredKinematics | None = None
    caution: str = ""


class Move(Protocol):
    """A motion under way."""

    @property
    def is_done(self) -> bool:
        """Whether it has ended, at its target or not."""
        ...

    @property
    def progress(self) -> float:
        """Share of the path that is done, 0 to 1."""
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


class ReadyStep(Enum):
    """What a person lets the program do before an arm can be connected; the values say what it does."""

    END_PROGRAM = "end the program"
    RESTART_SAFETY = "restart the safety system"
    UNLOCK = "unlock the protective stop"
    POWER_ON = "switch the power on"
    RELEASE_BRAKES = "release the brakes"
    ACTIVATE_GRIPPER = "activate the gripper"


class Robot(_Device, Protocol):
    """A six-jointed arm. Every method is safe from any thread.

    Entering it connects and checks that it is the arm of the cell file; leaving stops what moves.

    Attributes:
        name: what people call it.
    """

    name: str

    @property
    def kinematics(self) -> Kinematics:
        """Of the arm that is connected; before that, as published."""
        ...

    def state(self) -> RobotState:
        """Return the newest state.

        Raises:
            RobotLost: no state came for some time.
        """
        ...

    def move_joints(self, path_rad: npt.ArrayLike, speed_rad_s: float, acceleration_rad_s2: float) -> Move:
        """Start to move through joint configurations (N, 6), straight in joint space; return at once.

        The arm stops at each of them. The path must have been checked: the robot itself knows no obstacles.

        Raises:
            RobotError: the robot is elsewhere, moving, not ready, refuses, or cannot be reached.
        """
        ...

    def follow(self, trajectory: JointTrajectory, margin: PathMargin | None = None) -> Move:
        """Start to follow a checked tool path, given as a timed motion of the joints; return at once.

        An arm that leaves its path by more than the margin, or a usual one, is stopped. Where the speed
        slider or a slow link hold it up, it takes longer; it never hurries to catch up.

        Raises:
            RobotError: as with `move_joints`.
        """
        ...

    def refuse_unsafe(self, trajectory: JointTrajectory, label: str) -> None:
        """Refuse a motion that the arm's configuration or its safety system does not allow.

        Raises:
            MoveRefused: one does not; `label` names the motion in the sentence.
            RobotError: it does not answer.
        """
        ...

    def stop(self) -> None:
        """Stop whatever moves; works while another call waits."""
        ...

    def stopped_by(self) -> RobotError | None:
        """What stopped it for good, moving or at rest, until it is recovered; none if nothing did."""
        ...

    def pending_step(self) -> tuple[ReadyStep, str] | None:
        """What has to be done before the arm can be connected, and why; none if that is nothing or not known.

        Nothing is written to the controller.
        """
        ...

    def take_step(self, step: ReadyStep) -> None:
        """Do that; the arm follows no path.

        Raises:
            RobotError: it could not be done; the sentence says what a person has to do.
        """
        ...

    def recover(self) -> None:
        """After a stop, bring the robot to where it takes moves again; nothing goes on that was stopped.

        Unlocks a protective stop, switches on power and brakes, starts the control program anew; connects
        again when the link was lost.

        Raises:
            RobotError: a person has to do something first, such as releasing the emergency stop; the
                sentence says what.
        """
        ...


class Gripper(_Device, Protocol):
    """Something that holds the cup.

    Attributes:
        name: what people call it.
    """

    name: str

    @property
    def is_closed(self) -> bool:
        """Whether it was last commanded to close, as read back from the device."""
        ...

    @property
    def is_holding(self) -> bool | None:
        """Whether it holds something; none where it does not report that."""
        ...

    @property
    def width_m(self) -> float | None:
        """Width between its fingers; none where it does not report that."""
        ...

    def close(self) -> None:
        """Close it and return when it had the time to."""
        ...

    def open(self) -> None:
        """Open it and return when it had the time to."""
        ...
