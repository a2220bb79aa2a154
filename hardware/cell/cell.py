"""The cell itself: its devices, opened and closed together."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass, field

from core.errors import InputError
from core.motion.clearance import MotionScene
from hardware.cameras.openni import OpenNICamera
from hardware.cameras.realsense import RealSenseCamera
from hardware.cameras.replay import ReplayCamera
from hardware.cameras.simulated import SimulatedCamera
from hardware.cell.arm import real_gripper, real_robot
from hardware.cell.scene import ARMS, motion_scene
from hardware.cell.settings import CellSettings, Joints
from hardware.interfaces import Camera, Gripper, Robot
from hardware.robots.kinematic import KinematicRobot
from hardware.robots.replay import ReplayRobot
from hardware.robots.simulated_gripper import SimulatedGripper
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


def open_cell(settings: CellSettings, world: World | None = None, seed: int = 0) -> Cell:
    """Build a cell's devices; nothing is connected before it is entered.

    Args:
        settings: what its file says.
        world: what a simulated camera looks at.
        seed: of a simulated camera's noise.

    Raises:
        InputError: a simulated cell without a world, or a real one with it.
    """
    if settings.is_simulated != (world is not None):
        raise InputError(
            f"The {settings.name} is simulated: name the object that stands in it, such as --object mug; "
            "for a real cell give --cell FILE."
            if settings.is_simulated
            else f"The {settings.name} is real: put the object on its platform and leave out --object."
        )
    camera, robot, gripper = _devices(settings, world, seed)
    return Cell(settings, camera, robot, gripper, motion_scene(settings))


def _devices(settings: CellSettings, world: World | None, seed: int) -> tuple[Camera, Robot, Gripper]:
    if world is not None:
        robot = _twin(settings)
        noise = None if settings.simulation.is_perfect else settings.simulation.noise
        simulated = SimulatedCamera(world, robot, settings.camera.pose, noise, seed)
        return simulated, robot, SimulatedGripper()
    camera = real_camera(settings)
    if isinstance(camera, ReplayCamera):
        return camera, ReplayRobot(camera, settings.camera.pose), SimulatedGripper()
    if settings.robot.kind == "ur5":
        arm = real_robot(settings)
        return camera, arm, real_gripper(settings, arm)
    return camera, _twin(settings), SimulatedGripper()


def real_camera(settings: CellSettings) -> Camera:
    """Build the cell's camera, which is not simulated; nothing is connected before it is entered."""
    camera = settings.camera
    if camera.kind == "openni":
        return OpenNICamera(camera.calibrated_intrinsics)
    if camera.kind == "replay":
        return ReplayCamera(camera.replayed)
    return RealSenseCamera(camera.serial, camera.recording)


def _twin(settings: CellSettings) -> KinematicRobot:
    robot = settings.robot
    return KinematicRobot(
        ARMS[robot.model], robot.home_rad, settings.simulation.is_instant, settings.gripper.grasp_pose
    )
