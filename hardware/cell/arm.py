"""The arm with its gripper, without a camera: what a pour needs. The simulated one runs the real driver."""

from __future__ import annotations

import random
from contextlib import AbstractContextManager, ExitStack, nullcontext
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from core.errors import InputError
from core.motion.clearance import MotionScene
from hardware.cell.scene import ARMS, motion_scene
from hardware.cell.settings import CellSettings
from hardware.interfaces import Gripper, Robot
from hardware.robots.simulated_gripper import SimulatedGripper
from hardware.robots.ur.gripper import ToolOutputGripper
from hardware.robots.ur.robot import UR5Robot
from hardware.simulation.ur_controller.process import ControllerProcess


@dataclass
class Arm:
    """An arm and its gripper; entering it connects both, after what they need.

    Attributes:
        settings: what the cell's file says.
        robot: the arm.
        gripper: in its hand.
        scene: what the arm must not touch.
        controller: of a simulated arm: runs while the arm is connected; none: a real one.
    """

    settings: CellSettings
    robot: Robot
    gripper: Gripper
    scene: MotionScene
    controller: ControllerProcess | None = None
    _open: ExitStack = field(default_factory=ExitStack, repr=False)

    def __enter__(self) -> Arm:
        """Connect robot and gripper.

        Raises:
            DeviceError: one of them is not there or not ready; what was connected before is let go again.
        """
        first: AbstractContextManager[object] = self.controller or nullcontext()
        with ExitStack() as devices:
            for device in (first, self.robot, self.gripper):
                devices.enter_context(device)
            self._open = devices.pop_all()
        return self

    def __exit__(self, *exception: object) -> None:
        self._open.close()


def open_arm(settings: CellSettings, joints_rad: npt.ArrayLike | None = None) -> Arm:
    """Build a cell's arm and gripper; nothing is connected before it is entered.

    Args:
        settings: what the cell's file says.
        joints_rad: (6,) where a simulated arm stands at first; at its home without them.

    Raises:
        InputError: the cell plays a recorded scan, which has no arm.
    """
    robot, simulation = settings.robot, settings.simulation
    if robot.kind == "replay":
        raise InputError(
            f"The {settings.name} plays a recorded scan and has no arm; name another cell file with --cell."
        )
    if robot.kind == "ur5":
        arm = real_robot(settings)
        return Arm(settings, arm, real_gripper(settings, arm), motion_scene(settings))
    controller = ControllerProcess(
        robot.model,
        simulation.controller_version,
        _loopback_address(),
        np.asarray(robot.home_rad if joints_rad is None else joints_rad, dtype=float).tolist(),
        simulation.speed_up,
    )
    arm = _ur_robot(settings, controller.address, f"simulated {robot.model}")
    gripper = ToolOutputGripper(arm, settings.gripper.output, settings.gripper.action_s / simulation.speed_up)
    return Arm(settings, arm, gripper, motion_scene(settings), controller)


def real_robot(settings: CellSettings) -> UR5Robot:
    """Build the driver of a cell's real arm; nothing is connected before it is entered."""
    assert settings.robot.address is not None, "checked by the validator for ur5"
    return _ur_robot(settings, settings.robot.address, None)


def real_gripper(settings: CellSettings, robot: UR5Robot) -> Gripper:
    """Build the gripper in a real arm's hand; one of kind 'simulated' holds nothing."""
    if settings.gripper.kind == "simulated":
        return SimulatedGripper()
    return ToolOutputGripper(robot, settings.gripper.output, settings.gripper.action_s)


def _ur_robot(settings: CellSettings, address: str, name: str | None) -> UR5Robot:
    gripper = settings.gripper
    return UR5Robot(
        ARMS[settings.robot.model],
        address,
        gripper.grasp_pose,
        gripper.payload_kg,
        gripper.payload_center_m,
        gripper.voltage_v if gripper.kind == "ur5" else None,
        name=name,
    )


def _loopback_address() -> str:
    """One of 16 million; the controller says so if somebody listens there."""
    pick = random.SystemRandom()
    return ".".join(["127", *(str(pick.randint(1, 254)) for _ in range(3))])
