"""The part of the cell file that holds an arm's own kinematics."""

from __future__ import annotations

from core.motion.arm_models import ArmModel
from core.motion.factory_calibration import MeasuredKinematics, calibrated
from core.parameters.fields import Group, quantity
from hardware.cell.gripper_settings import CELL

Six = tuple[float, float, float, float, float, float]


class LinkSettings(Group):
    """Denavit-Hartenberg parameters of one arm (classic convention), as its controller told them.

    Some may be hundreds of metres that cancel each other; see `core.motion.factory_calibration`.
    """

    theta_rad: Six = quantity(..., "Added to the joints' angles.", unit="rad", source=CELL, low=None)
    a_m: Six = quantity(..., "Link lengths.", unit="m", source=CELL, low=None)
    d_m: Six = quantity(..., "Link offsets.", unit="m", source=CELL, low=None)
    alpha_rad: Six = quantity(..., "Link twists.", unit="rad", source=CELL, low=None)

    def of(self, arm: ArmModel) -> ArmModel:
        """Return the model of this very arm, from the one that is published.

        Raises:
            MotionError: these are the links of no arm of that model.
        """
        known = MeasuredKinematics(self.theta_rad, self.a_m, self.d_m, self.alpha_rad, ())
        return calibrated(arm, known)
