"""Which controller is simulated, and how."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from core.motion.factory_calibration import MeasuredKinematics
from hardware.simulation.ur_controller.identity import HOME_RAD, Identity


@dataclass(frozen=True)
class ControllerSettings:
    """What shall be simulated.

    Attributes:
        identity: model and version.
        address: on loopback; none: any 127.x.y.z that is free.
        joints_rad: (6,) where the arm is at first.
        speed_up: how many times faster than the wall clock the controller's clock runs.
        faults: lines for the fault injector, taken at the start.
        robotiq: model of the Robotiq gripper that is served; none: there is none.
        measured: the arm's own kinematics; none: they are as published.
    """

    identity: Identity
    address: str | None = None
    joints_rad: Sequence[float] = HOME_RAD
    speed_up: float = 1.0
    faults: Sequence[str] = ()
    robotiq: str | None = None
    measured: MeasuredKinematics | None = None
