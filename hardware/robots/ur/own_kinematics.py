"""The kinematics of the arm that is connected: its own, where its controller tells them."""

from __future__ import annotations

from core.errors import MotionError
from core.motion.arm_models import ArmModel
from core.motion.factory_calibration import calibrated
from hardware.interfaces import Kinematics
from hardware.robots.ur.primary_interface import PRIMARY_PORT, DamagedPackage, receive_kinematics


def read_kinematics(address: str, arm: ArmModel) -> Kinematics:
    """Return the kinematics that a controller has of its arm; those as published where it tells none.

    Args:
        address: the controller's.
        arm: as published.
    """
    try:
        measured = receive_kinematics(address)
        model = calibrated(arm, measured)
    except (OSError, DamagedPackage, MotionError) as error:
        return Kinematics(
            arm,
            caution=f"The arm's own kinematics could not be read from the controller at {address} ({error}), "
            f"so those published for a {arm.name} are used, which may put the tool 1 to 3 mm off its place; "
            f"allow the primary interface (port {PRIMARY_PORT}) on the controller, then connect again.",
        )
    return Kinematics(model, "-".join(f"{number:08x}" for number in measured.checksum), measured)
