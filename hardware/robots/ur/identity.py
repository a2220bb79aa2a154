"""Is it the arm of the cell file, and does it listen to us? Asked before anything moves."""

from __future__ import annotations

import numpy as np

from core.geometry import AnyArray, FloatArray
from core.motion.arm_models import ArmModel
from core.motion.kinematics import flange_pose
from hardware.errors import NotInRemoteControl, WrongRobot
from hardware.robots.ur.dashboard import Dashboard
from hardware.robots.ur.state import pose_of


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
    """Refuse an arm that names itself another size; some controllers do not tell the series.

    Raises:
        WrongRobot: it does.
    """
    says = dashboard.robot_model()
    if says is not None and says.upper().rstrip("E") != arm.name.upper().rstrip("E"):
        raise WrongRobot(
            f"The cell file names a {arm.name}, but the {name} says it is a {says}; correct the model or the "
            "address in the cell file."
        )


def refuse_other_kinematics(
    raw: AnyArray, arm: ArmModel, T_flange_tool: FloatArray, tolerance_m: float, tolerance_rad: float
) -> None:
    """Refuse an arm whose tool is not where the model's kinematics put it at a state of `FIELDS`.

    A factory calibration shifts a real arm by some millimetres; UR5 and UR5e differ by 73 mm in their height
    alone.

    Raises:
        WrongRobot: it is farther away than the tolerances.
    """
    expected = flange_pose(arm, raw["joints_rad"]) @ T_flange_tool
    reported = pose_of(raw["tool_pose"])
    apart_m = float(np.linalg.norm(reported[:3, 3] - expected[:3, 3]))
    cosine = (np.trace(expected[:3, :3].T @ reported[:3, :3]) - 1) / 2
    apart_rad = float(np.arccos(np.clip(cosine, -1, 1)))
    if apart_m > tolerance_m or apart_rad > tolerance_rad:
        raise WrongRobot(
            f"The arm is not the {arm.name} of the cell file: its controller puts the tool "
            f"{apart_m * 1000:.0f} mm and {np.degrees(apart_rad):.1f} degrees from where a {arm.name} would "
            "have it; correct the model or the address in the cell file."
        )
