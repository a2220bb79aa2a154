"""Trying each device of a cell, and its scan views, without moving anything."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from core.calibration.depth_plane import MOST_RMS_SHARE, DepthPlane, find_plane
from core.errors import PoursightError
from core.geometry import FloatArray
from core.motion.joint_path import check_path
from core.motion.kinematics import flange_pose
from core.scan.model import Intrinsics
from hardware.cell.cell import open_cell
from hardware.cell.devices import real_arm, real_camera, robotiq_address
from hardware.cell.own_arm import why_other_arm
from hardware.cell.scene import motion_scene
from hardware.cell.settings import CellSettings
from hardware.grippers.robotiq import MODELS
from hardware.grippers.robotiq_line import Contact, RobotiqLine, refuse_faulty
from hardware.interfaces import Camera, Kinematics
from hardware.modes import unreadiness
from hardware.robots.ur.dashboard import Dashboard
from hardware.simulation.world import World

SAME_VIEW_M, SAME_VIEW_RAD = 0.03, np.radians(5.0)


@dataclass(frozen=True)
class Finding:
    """One line of an examination; `problem` says what to do when something is wrong."""

    subject: str
    value: str
    problem: str | None = None


def examine_cell(settings: CellSettings) -> Iterator[Finding]:
    """Try robot, gripper, camera and scan views; yields one finding after the other."""
    yield Finding("cell", settings.name + (" (SIMULATED)" if settings.is_simulated else ""))
    yield examine_robot(settings)
    yield examine_gripper(settings)
    yield examine_camera(settings)
    if settings.camera.kind != "replay":
        yield from _views(settings)


def examine_robot(settings: CellSettings) -> Finding:
    """Ask the arm's controller what it is and whether it can be used."""
    robot = settings.robot
    if not robot.is_real:
        return Finding("robot", f"{robot.kind} {robot.model}")
    assert robot.address is not None, "checked by the validator for ur5"
    subject = f"{robot.model} at {robot.address}"
    try:
        arm = real_arm(settings)
        seen = arm.look()
        pending = arm.pending_step()
        number, control = _identity(robot.address)
    except PoursightError as error:
        return Finding("robot", subject, str(error))
    version = ".".join(map(str, arm.controller_version))
    modes = f"{seen.robot_mode.words}, safety {seen.safety_mode.words}"
    agree = "are only known when it is connected" if seen.tool_offset is None else "agree"
    what = f"{subject}, controller {version}{number}{control}"
    said = f"{what}; {modes}, its kinematics {agree}, speed slider {seen.slider:.0%}"
    limits = "not read (compare them at its panel)" if arm.joint_limits is None else "read"
    said = f"{said}, {_kinematics_read(arm.kinematics)}, joint limits {limits}"
    unready = unreadiness(seen.safety_mode, seen.robot_mode)
    problem = pending[1] if pending is not None else None if unready is None else str(unready)
    return Finding("robot", said, problem or why_other_arm(settings, arm.kinematics) or None)


def _identity(address: str) -> tuple[str, str]:
    """Serial number and control, as they are said; empty where the controller does not tell them."""
    with Dashboard(address) as dashboard:
        number = dashboard.serial_number()
        control = ", in remote control" if dashboard.has_remote_control() else ""
    return "" if number is None else f", serial number {number}", control


def examine_gripper(settings: CellSettings) -> Finding:
    """Say what holds the cup; a Robotiq gripper is asked how it is."""
    gripper, robot = settings.gripper, settings.robot
    if gripper.kind == "simulated":
        return Finding("gripper", "simulated")
    if gripper.kind == "ur5":
        return Finding("gripper", f"switched by tool output {gripper.output}")
    if not robot.is_real:
        return Finding("gripper", f"simulated Robotiq {gripper.model}")
    assert robot.address is not None and gripper.model is not None, "checked by the validators"
    address = robotiq_address(gripper, robot.address)
    assert address is not None, "it is one"
    subject = f"Robotiq {gripper.model} at {address}"
    try:
        with RobotiqLine(address) as line:
            refuse_faulty(line, address)
            contact, width_m = line.get("OBJ"), MODELS[gripper.model].width_m(line.get("POS"))
    except PoursightError as error:
        return Finding("gripper", subject, str(error))
    held = "something" if contact == Contact.WHILE_CLOSING else "nothing"
    return Finding("gripper", f"{subject}, {1000 * width_m:.0f} mm wide, holds {held}")


def _kinematics_read(kinematics: Kinematics) -> str:
    """In words; that they are not known keeps nobody from using the arm."""
    if kinematics.checksum:
        return f"calibrated kinematics read (checksum {kinematics.checksum})"
    return "calibrated kinematics not read (published ones are used, which may cost 1 to 3 mm)"


def examine_camera(settings: CellSettings) -> Finding:
    """Take an image."""
    try:
        camera = camera_alone(settings)
        with camera:
            image = camera.capture()
    except PoursightError as error:
        return Finding("camera", settings.camera.kind, str(error))
    share = float((image.depth_m > 0).mean())
    height, width = image.depth_m.shape
    value = f"{camera.name}, {width} x {height}; depth in {share:.0%} of the pixels"
    if share == 0:
        return Finding("camera", value, "It gives no depth at all; check its projector and what it looks at.")
    value, problem = _with_plane(value, find_plane(image.depth_m, image.intrinsics))
    return Finding("camera", f"{value}; {_intrinsics(settings, image.intrinsics)}", problem)


def _intrinsics(settings: CellSettings, found: Intrinsics) -> str:
    """The camera's intrinsics, and who says so."""
    source = "the cell file" if settings.camera.intrinsics is not None else "the camera"
    if settings.camera.kind == "replay":
        source = "the recording"
    return (
        f"focal lengths {found.fx:.1f} and {found.fy:.1f}, centre {found.cx:.1f}, {found.cy:.1f} pixels, as "
        f"{source} has them"
    )


def _with_plane(value: str, plane: DepthPlane | None) -> tuple[str, str | None]:
    """What the camera is with how true its depth is, and what to do if it is not."""
    if plane is None or not plane.is_flat:
        return f"{value}; look at a flat surface from the distance of a scan to see how true it is", None
    said = (
        f"{value}, within {1000 * plane.rms_m:.1f} mm (RMS) of a plane at {plane.distance_m:.2f} m, "
        f"seen at {np.degrees(plane.tilt_rad):.0f} degrees"
    )
    if plane.is_true:
        return said, None
    return said, (
        f"Its depth is {1000 * plane.rms_m:.1f} mm (RMS) off a plane at {plane.distance_m:.2f} m, and "
        f"{1000 * MOST_RMS_SHARE * plane.distance_m:.1f} mm are allowed; clean its windows, keep sunlight "
        "and shiny surfaces out of sight, and calibrate its depth as its maker says."
    )


def camera_alone(settings: CellSettings) -> Camera:
    """Return a cell's camera without its arm; a simulated one sees an empty cell from where the arm rests.

    Raises:
        InputError: there is no driver for its kind.
    """
    if not settings.has_simulated_object:
        return real_camera(settings)
    table_m = np.array([*settings.place.platform_center_m[:2], settings.place.table_height_m])
    return open_cell(settings, World(None, table_m)).camera


def _views(settings: CellSettings) -> Iterator[Finding]:
    joints = np.array(settings.scan.views_rad)
    scene = motion_scene(settings)
    subject = "scan views"
    for number, row in enumerate((np.array(settings.robot.home_rad), *joints)):
        what = f"view {number}" if number else "home_rad"
        problem = check_path(scene, row, settings.scan.min_clearance_m).problem
        if problem is not None:
            yield Finding(
                subject, what, f"The arm cannot stand there ({problem}); correct it in the cell file."
            )
            return
    same = _same_views(flange_pose(settings.robot.arm, joints) @ settings.camera.pose)
    if same:
        pairs = ", ".join(f"{a + 1} and {b + 1}" for a, b in same)
        yield Finding(subject, f"{len(joints)}", f"Views {pairs} are the same; replace one of each pair.")
        return
    least_mm = scene.clearance(joints).distance_m.min() * 1000
    yield Finding(subject, f"{len(joints)}, all reachable, {least_mm:.0f} mm clear")


def _same_views(T_base_camera: FloatArray) -> list[tuple[int, int]]:
    """Pairs of views that hardly differ."""
    pairs = []
    for a, b in combinations(range(len(T_base_camera)), 2):
        shift_m = np.linalg.norm(T_base_camera[a, :3, 3] - T_base_camera[b, :3, 3])
        cosine = (np.trace(T_base_camera[a, :3, :3].T @ T_base_camera[b, :3, :3]) - 1) / 2
        if shift_m < SAME_VIEW_M and np.arccos(np.clip(cosine, -1, 1)) < SAME_VIEW_RAD:
            pairs.append((a, b))
    return pairs
