"""The kinematics of the arm that is connected: its own, where its controller tells them."""

from __future__ import annotations

from core.errors import MotionError
from core.motion.arm_models import ArmModel
from core.motion.factory_calibration import MeasuredKinematics, calibrated
from hardware.interfaces import Kinematics
from hardware.robots.ur.primary_interface import PRIMARY_PORT, DamagedPackage, receive_kinematics


def read_kinematics(address: str, arm: ArmModel) -> Kinematics:
    """Return the kinematics that a controller has of its arm; those as published where it tells none.

    Args:
        address: the controller's.
        arm: as published.
    """
    try:
        return as_measured(arm, receive_kinematics(address))
    except (OSError, DamagedPackage, MotionError) as error:
        return Kinematics(
            arm,
            caution=f"The arm's own kinematics could not be read from the controller at {address} ({error}), "
            f"so those published for a {arm.name} are used, which may put the tool 1 to 3 mm off its place; "
            f"allow the primary interface (port {PRIMARY_PORT}) on the controller, then connect again.",
        )


def as_measured(arm: ArmModel, measured: MeasuredKinematics) -> Kinematics:
    """Return the kinematics of an arm that its maker measured.

    Args:
        arm: as published.
        measured: that calibration.

    Raises:
        MotionError: it is of no arm of that model.
    """
    checksum = "-".join(f"{number:08x}" for number in measured.checksum)
    return Kinematics(calibrated(arm, measured), checksum, measured)
