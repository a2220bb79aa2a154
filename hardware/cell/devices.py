"""A cell's devices by the kinds that its file names.

A new camera, arm or gripper is a driver of its own, a kind in `settings`, and a row here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TypeVar

from core.errors import InputError
from core.formats import excerpt
from hardware.cameras.openni import OpenNICamera
from hardware.cameras.realsense import RealSenseCamera
from hardware.cameras.replay import ReplayCamera
from hardware.cameras.simulated import SimulatedCamera
from hardware.cell.gripper_settings import GripperSettings
from hardware.cell.own_arm import own_kinematics
from hardware.cell.settings import ARMS, CameraSettings, CellSettings
from hardware.grippers.robotiq import RobotiqGripper
from hardware.grippers.robotiq_line import RobotiqAddress
from hardware.grippers.simulated import SimulatedGripper
from hardware.grippers.tool_output import ToolOutputGripper
from hardware.interfaces import Camera, Gripper, Robot
from hardware.robots.kinematic import KinematicRobot
from hardware.robots.replay import ReplayRobot
from hardware.robots.ur.robot import UR5Robot
from hardware.simulation.world import World

Builder = TypeVar("Builder")


def ur_robot(settings: CellSettings, address: str | None = None, name: str | None = None) -> UR5Robot:
    """Build the driver of a cell's UR arm; nothing is connected before it is entered.

    Args:
        settings: what the cell's file says.
        address: the controller's; the one in the file if left out.
        name: what people call it; model and address without one.
    """
    gripper = settings.gripper
    address = address or settings.robot.address
    assert address is not None, "checked by the validator for ur5"
    return UR5Robot(
        ARMS[settings.robot.model],
        address,
        gripper.grasp_pose,
        gripper.payload_kg,
        gripper.payload_center_m,
        gripper.voltage_v if gripper.kind == "ur5" else None,
        name=name,
        cup_kg=gripper.cup_kg,
        robotiq=robotiq_address(gripper, address),
    )


def robotiq_address(settings: GripperSettings, controller: str) -> RobotiqAddress | None:
    """Where a cell's Robotiq gripper is served; none if it has another one."""
    if settings.kind != "robotiq":
        return None
    return RobotiqAddress(settings.address or controller, settings.port)


def real_arm(settings: CellSettings) -> UR5Robot:
    """Build the driver of a cell's real arm; nothing is connected before it is entered.

    Raises:
        InputError: there is no driver for its kind.
    """
    if settings.robot.kind not in _REAL_ARMS:
        raise _unknown_kind("robot", settings.robot.kind, _ROBOTS)
    return _REAL_ARMS[settings.robot.kind](settings)


def real_camera(settings: CellSettings) -> Camera:
    """Build the cell's camera, which is not simulated; nothing is connected before it is entered.

    Raises:
        InputError: there is no driver for its kind.
    """
    return _of_kind(_CAMERAS, "camera", settings.camera.kind)(settings.camera)


def real_gripper(settings: CellSettings, robot: UR5Robot) -> Gripper:
    """Build the gripper in a real arm's hand; one of kind 'simulated' holds nothing.

    Raises:
        InputError: there is no driver for its kind.
    """
    return _of_kind(_GRIPPERS, "gripper", settings.gripper.kind)(settings.gripper, robot)


def simulated_gripper(settings: GripperSettings, robot: UR5Robot, speed_up: float) -> Gripper:
    """Build the driver of the gripper in a simulated arm's hand: the controller's clock runs faster."""
    if settings.kind == "robotiq":
        return _robotiq(settings, robot)
    return ToolOutputGripper(robot, settings.output, settings.action_s / speed_up)


def scan_devices(settings: CellSettings, world: World | None, seed: int) -> tuple[Camera, Robot, Gripper]:
    """Build what takes part in a scan; nothing is connected before it is entered.

    Args:
        settings: what the cell's file says.
        world: what a simulated camera looks at; none for another camera.
        seed: of a simulated camera's noise.

    Raises:
        InputError: there is no driver for a device's kind.
    """
    if settings.robot.kind == "replay":
        recorded = ReplayCamera(settings.camera.replayed)
        replayed = ReplayRobot(recorded, settings.camera.pose, ARMS[settings.robot.model])
        return recorded, replayed, SimulatedGripper()
    robot = _of_kind(_ROBOTS, "robot", settings.robot.kind)(settings)
    gripper = real_gripper(settings, robot) if isinstance(robot, UR5Robot) else SimulatedGripper()
    if world is None:
        return real_camera(settings), robot, gripper
    noise = None if settings.simulation.is_perfect else settings.simulation.noise
    return SimulatedCamera(world, robot, settings.true_camera_pose, noise, seed), robot, gripper


def _unknown_kind(device: str, kind: str, known: Iterable[str]) -> InputError:
    return InputError(
        f"There is no driver for a {device} of kind '{excerpt(kind)}' here; choose one of {', '.join(known)} "
        "in the cell file."
    )


def _of_kind(builders: Mapping[str, Builder], device: str, kind: str) -> Builder:
    if kind not in builders:
        raise _unknown_kind(device, kind, builders)
    return builders[kind]


def _kinematic(settings: CellSettings) -> KinematicRobot:
    robot = settings.robot
    return KinematicRobot(
        own_kinematics(settings), robot.home_rad, settings.simulation.is_instant, settings.gripper.grasp_pose
    )


_CAMERAS: dict[str, Callable[[CameraSettings], Camera]] = {
    "realsense": lambda camera: RealSenseCamera(camera.serial, camera.recording),
    "openni": lambda camera: OpenNICamera(camera.calibrated_intrinsics),
    "replay": lambda camera: ReplayCamera(camera.replayed),
}
"""All but the simulated one, which sees a world from a simulated arm."""

_REAL_ARMS: dict[str, Callable[[CellSettings], UR5Robot]] = {"ur5": ur_robot}
_ROBOTS: dict[str, Callable[[CellSettings], Robot]] = {"simulated": _kinematic, **_REAL_ARMS}
"""All but the arm of a recorded scan, which follows its camera."""


def _robotiq(settings: GripperSettings, robot: UR5Robot) -> Gripper:
    assert settings.model is not None and robot.robotiq is not None, "checked by the validator for robotiq"
    return RobotiqGripper(robot, robot.robotiq, settings.model, settings.grip)


_GRIPPERS: dict[str, Callable[[GripperSettings, UR5Robot], Gripper]] = {
    "simulated": lambda _settings, _robot: SimulatedGripper(),
    "ur5": lambda settings, robot: ToolOutputGripper(robot, settings.output, settings.action_s),
    "robotiq": _robotiq,
}
