"""What a controller allows each joint of its arm, and whether a motion stays within it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray
from core.motion.arm_models import JOINT_NAMES
from core.motion.trajectory import JointTrajectory
from hardware.errors import MoveRefused
from hardware.robots.ur.primary_interface import DamagedPackage, receive_configuration

_ROUNDING_RAD = 1e-4


@dataclass(frozen=True)
class JointLimits:
    """Of all joints, as the configuration data of the primary interface has them.

    Attributes:
        lower_rad, upper_rad: (6,) the range of each.
        speeds_rad_s: (6,) the highest speed of each.
    """

    lower_rad: FloatArray
    upper_rad: FloatArray
    speeds_rad_s: FloatArray

    def refuse_beyond(self, trajectory: JointTrajectory, label: str, name: str) -> None:
        """Refuse a motion that leaves a range or is too fast.

        Args:
            trajectory: of the joints.
            label: names it in the sentence.
            name: of the arm.

        Raises:
            MoveRefused: it is.
        """
        joints_rad = trajectory.joints_rad
        beyond_rad = np.maximum(self.lower_rad - joints_rad, joints_rad - self.upper_rad)
        sample, joint = np.unravel_index(beyond_rad.argmax(), beyond_rad.shape)
        if beyond_rad[sample, joint] > _ROUNDING_RAD:
            at, low, high = np.degrees(
                [joints_rad[sample, joint], self.lower_rad[joint], self.upper_rad[joint]]
            )
            raise MoveRefused(
                f"In the move '{label}' the {JOINT_NAMES[joint]} joint would be at {at:.0f} degrees, where "
                f"the {name} allows {low:.0f} to {high:.0f}; see the joint limits under Installation, "
                "Safety, on its panel, or place the object elsewhere."
            )
        steps_rad = np.abs(np.diff(joints_rad, axis=0))
        speeds_rad_s = (steps_rad / np.diff(trajectory.times_s)[:, None]).max(axis=0, initial=0.0)
        fast = int((speeds_rad_s / self.speeds_rad_s).argmax())
        if speeds_rad_s[fast] > self.speeds_rad_s[fast]:
            raise MoveRefused(
                f"In the move '{label}' the {JOINT_NAMES[fast]} joint would turn at "
                f"{speeds_rad_s[fast]:.2f} rad/s, where the {name} allows {self.speeds_rad_s[fast]:.2f}; "
                "lower the joint speeds in the cell file, or see the joint limits under Installation, "
                "Safety, on its panel."
            )


def read_joint_limits(address: str) -> JointLimits | None:
    """Return what the controller at an address allows; none where it does not tell, or nothing plausible."""
    try:
        numbers = receive_configuration(address)
    except (OSError, DamagedPackage):
        return None
    lower_rad, upper_rad = np.array(numbers[:12]).reshape(6, 2).T
    speeds_rad_s = np.array(numbers[12:24:2])
    is_plausible = np.isfinite(numbers[:24]).all() and (lower_rad < upper_rad).all()
    return (
        JointLimits(lower_rad, upper_rad, speeds_rad_s) if is_plausible and speeds_rad_s.min() > 0 else None
    )
