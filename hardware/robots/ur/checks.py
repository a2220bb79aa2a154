"""Whether it is the right arm, may be moved, and does what it should."""

from __future__ import annotations

import numpy as np

from core.geometry import AnyArray, FloatArray
from core.motion.arm_models import JOINT_NAMES, ArmModel
from core.motion.kinematics import flange_pose
from core.motion.margin import PathMargin
from hardware.errors import (
    NotInRemoteControl,
    OutputChanged,
    ProgramStopped,
    RobotError,
    TrackingLost,
    WrongRobot,
)
from hardware.modes import unreadiness
from hardware.robots.ur.dashboard import Dashboard
from hardware.robots.ur.messages import RUNTIME_PLAYING, robot_mode, safety_mode
from hardware.robots.ur.pose_vectors import pose_from_vector


def refuse_local_control(dashboard: Dashboard, name: str) -> None:
    """Refuse a controller that only its own panel moves.

    Raises:
        NotInRemoteControl: it is in local control.
    """
    if dashboard.is_in_local_control():
        raise NotInRemoteControl(
            f"The {name} is in local control; choose remote control at the top right of its panel, then "
            "recover the robot."
        )


def refuse_other_model(dashboard: Dashboard, arm: ArmModel, name: str) -> None:
    """Refuse an arm that names itself another size; some controllers do not report the series.

    Raises:
        WrongRobot: it does.
    """
    reported = dashboard.robot_model()
    if reported is not None and reported.upper().rstrip("E") != arm.name.upper().rstrip("E"):
        raise WrongRobot(
            f"The cell file names a {arm.name}, but the {name} reports itself as a {reported}; correct the "
            "model or the address in the cell file."
        )


def refuse_other_kinematics(
    joints_rad: FloatArray,
    tool_pose: FloatArray,
    arm: ArmModel,
    T_flange_tool: FloatArray,
    tolerances: tuple[float, float],
) -> None:
    """Refuse an arm whose tool, reported at a pose (6,), is not where the model's kinematics put it.

    A factory calibration shifts a real arm by some millimetres; UR5 and UR5e differ by 73 mm in their height
    alone.

    Raises:
        WrongRobot: it is farther away than the tolerances, in metres and radians.
    """
    expected = flange_pose(arm, joints_rad) @ T_flange_tool
    reported = pose_from_vector(tool_pose)
    apart_m = float(np.linalg.norm(reported[:3, 3] - expected[:3, 3]))
    cosine = (np.trace(expected[:3, :3].T @ reported[:3, :3]) - 1) / 2
    apart_rad = float(np.arccos(np.clip(cosine, -1, 1)))
    if apart_m > tolerances[0] or apart_rad > tolerances[1]:
        raise WrongRobot(
            f"The arm is not the {arm.name} of the cell file: its controller puts the tool "
            f"{apart_m * 1000:.0f} mm and {np.degrees(apart_rad):.1f} degrees from where a {arm.name} would "
            "have it; correct the model or the address in the cell file."
        )


TRACKING_RAD = 0.05
"""How far a joint may be from where the controller wants it, and from its commanded path."""


def unsafe(raw: AnyArray) -> RobotError | None:
    """What prevents motion, for a state of `FIELDS`."""
    return unreadiness(safety_mode(raw), robot_mode(raw))


def deviation(raw: AnyArray) -> RobotError | None:
    """What is wrong with a state of a moving arm, the gravest first."""
    grave = unsafe(raw)
    if grave is not None:
        return grave
    if int(raw["runtime_state"]) != RUNTIME_PLAYING:
        return ProgramStopped(
            "The control program on the robot was stopped or paused, at its panel or by another program; "
            "see why, then recover the robot and plan anew."
        )
    return tracking_lost(raw["joints_rad"], raw["target_joints_rad"][None], "where the controller wants it")


def tracking_lost(
    joints_rad: FloatArray, asked_rad: FloatArray, what: str, most_rad: float = TRACKING_RAD
) -> TrackingLost | None:
    """Say so when joints (6,) are farther than a limit from every one of the places (N, 6)."""
    apart = np.abs(asked_rad - joints_rad)
    nearest = apart[apart.max(axis=1).argmin()]
    if nearest.max() <= most_rad:
        return None
    return TrackingLost(
        f"The {JOINT_NAMES[int(nearest.argmax())]} joint was {np.degrees(nearest.max()):.1f} degrees from "
        f"{what} and the arm was stopped; see what holds or pushes it, then recover the robot and plan anew."
    )


def beside_path(joints_rad: FloatArray, asked_rad: FloatArray, margin: PathMargin) -> TrackingLost | None:
    """Say so when an arm at (6,) is farther from the last part (N, 6) of its path than the margin."""
    off_m = margin.beside_m(joints_rad, asked_rad)
    if off_m <= margin.allowed_m:
        return None
    return TrackingLost(
        f"The arm was up to {off_m * 1000:.1f} mm beside its path, where its clearance leaves "
        f"{margin.allowed_m * 1000:.1f} mm, and was stopped; see what holds or pushes it, then recover the "
        "robot and plan anew."
    )


_REST_RAD = 5e-3
"""So far a resting arm gives way to somebody who leans on it; brakes and gears give less."""


def moved_at_rest(joints_rad: FloatArray, rest_rad: FloatArray) -> TrackingLost | None:
    """Say so when an arm that nobody moves is elsewhere than it came to rest."""
    if np.abs(joints_rad - rest_rad).max() <= _REST_RAD:
        return None
    return TrackingLost(
        "The arm moved although nothing was asked of it, as if another program had taken it over, and was "
        "stopped; see what runs on the controller and what pushes the arm, then recover the robot and plan "
        "anew."
    )


def output_changed(before: tuple[bool, bool], now: tuple[bool, bool]) -> OutputChanged | None:
    """Say so when an output of the tool is not as it should be while the arm moves."""
    changed = [number for number in (0, 1) if before[number] != now[number]]
    if not changed:
        return None
    return OutputChanged(
        f"Tool output {changed[0]} went {'on' if now[changed[0]] else 'off'} while the arm moved: the "
        "gripper may have let go, and the arm was stopped; see to the cup, the cable and the 24 V supply, "
        "then recover the robot."
    )


def raise_if(error: RobotError | None) -> None:
    """Raise what a check found."""
    if error is not None:
        raise error
