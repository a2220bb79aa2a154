"""A program that somebody else starts on the controller: it stands, or turns the base to and fro."""

from __future__ import annotations

import numpy as np

from hardware.robots.joint_motion import JointMotion
from hardware.simulation.ur_controller.arm import STOP_RAD_S2, Arm

_SWING_RAD = 0.6
_SPEED_RAD_S, _ACCELERATION_RAD_S2 = 0.5, 2.0


class ForeignProgram:
    """Runs until it is ended.

    Attributes:
        is_over: never by itself.
        name: as the dashboard calls it.
    """

    is_over = False
    name = "weld.urp"

    def __init__(self, arm: Arm, is_moving: bool) -> None:
        """Take the arm over: it brakes first."""
        self._arm = arm
        self._is_moving = is_moving
        self._sign = 1.0
        arm.brake(STOP_RAD_S2)

    def step(self) -> None:
        """Begin the next swing when the one before is over."""
        if self._is_moving and self._arm.is_idle:
            swing_rad = np.array([self._sign * _SWING_RAD, 0, 0, 0, 0, 0])
            self._sign = -self._sign
            self._arm.run(
                lambda start: JointMotion(
                    np.stack([start, start + swing_rad]), _SPEED_RAD_S, _ACCELERATION_RAD_S2
                )
            )
