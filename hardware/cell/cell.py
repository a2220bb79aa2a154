"""The cell itself: its devices, opened and closed together, with a camera to scan, without to pour."""

from __future__ import annotations

import random
from contextlib import AbstractContextManager, ExitStack, nullcontext
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from core.errors import InputError, Remedy
from core.motion.clearance import MotionScene
from hardware.cameras.replay import ReplayCamera
from hardware.cell.devices import real_arm, real_gripper, scan_devices, simulated_gripper, ur_robot
from hardware.cell.gripper_settings import Joints
from hardware.cell.own_arm import measured_in_simulation
from hardware.cell.scene import motion_scene
from hardware.cell.settings import CellSettings
from hardware.interfaces import Camera, Gripper, Robot
from hardware.simulation.ur_controller.process import ControllerProcess
from hardware.simulation.world import World


@dataclass
class Cell:
    """One camera, one robot, one gripper and their calibration; entering it connects all of them.

    Attributes:
        settings: what its file says.
        camera: at the robot's flange.
        robot: the arm.
        gripper: at the flange, too.
        scene: what the arm must not touch.
    """

    settings: CellSettings
    camera: Camera
    robot: Robot
    gripper: Gripper
    scene: MotionScene
    _open: ExitStack = field(default_factory=ExitStack, repr=False)

    def __enter__(self) -> Cell:
        """Connect robot, gripper and camera.

        Raises:
            DeviceError: one of them is not there; what was connected before is let go again.
        """
        with ExitStack() as devices:
            for device in (self.robot, self.gripper, self.camera):
                devices.enter_context(device)
            self._open = devices.pop_all()
        return self

    def __exit__(self, *exception: object) -> None:
        self._open.close()

    @property
    def views_rad(self) -> tuple[Joints, ...]:
        """The scan views' joints; of a recorded scan, whose joints nobody knows, one row of zeros a view."""
        if isinstance(self.camera, ReplayCamera):
            return ((0.0, 0.0, 0.0, 0.0, 0.0, 0.0),) * self.camera.n_views
        return self.settings.scan.views_rad


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


def open_cell(settings: CellSettings, world: World | None = None, seed: int = 0) -> Cell:
    """Build a cell's devices; nothing is connected before it is entered.

    Args:
        settings: what its file says.
        world: what a simulated camera looks at.
        seed: of a simulated camera's noise.

    Raises:
        InputError: a simulated cell without a world, a real one with it, or a device of an unknown kind.
    """
    if settings.has_simulated_object != (world is not None):
        if settings.has_simulated_object:
            raise InputError(
                f"The camera of the {settings.name} is simulated, and no object was chosen for it.",
                Remedy.CHOOSE_OBJECT,
            )
        raise InputError(
            f"The {settings.name} is real: it scans the object on its platform, not a chosen one.",
            Remedy.NO_OBJECT,
        )
    camera, robot, gripper = scan_devices(settings, world, seed)
    return Cell(settings, camera, robot, gripper, motion_scene(settings))


def open_arm(settings: CellSettings, joints_rad: npt.ArrayLike | None = None) -> Arm:
    """Build a cell's arm and gripper, without a camera; nothing is connected before it is entered.

    A simulated arm is driven as a real one is, through a simulated controller.

    Args:
        settings: what the cell's file says.
        joints_rad: (6,) where a simulated arm is at first; at its home without them.

    Raises:
        InputError: the cell plays a recorded scan, which has no arm, or a device is of an unknown kind.
    """
    if settings.robot.kind == "replay":
        raise InputError(f"The {settings.name} plays back a recorded scan and has no arm.", Remedy.OTHER_CELL)
    if settings.robot.kind == "simulated":
        return _open_simulated(settings, joints_rad)
    arm = real_arm(settings)
    return Arm(settings, arm, real_gripper(settings, arm), motion_scene(settings))


def _open_simulated(settings: CellSettings, joints_rad: npt.ArrayLike | None) -> Arm:
    robot, simulation = settings.robot, settings.simulation
    controller = ControllerProcess(
        robot.model,
        simulation.controller_version,
        _loopback_address(),
        np.asarray(robot.home_rad if joints_rad is None else joints_rad, dtype=float).tolist(),
        simulation.speed_up,
        robotiq=settings.gripper.model,
        measured=measured_in_simulation(settings),
    )
    arm = ur_robot(settings, controller.address, f"simulated {robot.model}")
    gripper = simulated_gripper(settings.gripper, arm, simulation.speed_up)
    return Arm(settings, arm, gripper, motion_scene(settings), controller)


def _loopback_address() -> str:
    """One of 16 million; the controller says so if somebody listens there."""
    pick = random.SystemRandom()
    return ".".join(["127", *(str(pick.randint(1, 254)) for _ in range(3))])
