"""Views of objects as the network is to learn them, each with its labels; from a seed, nothing downloaded."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from core.appearance.crops import SIZE_PX, Square, quarter_turns, square_around
from core.evaluation.labels import read_labels
from core.geometry import FloatArray, invert_pose, make_pose, transform_points
from core.mesh import TriangleMesh
from core.mesh_file import read_mesh
from core.motion.kinematics import flange_pose
from core.progress import Reporter
from hardware.cell.scene import object_space
from hardware.cell.settings import ARMS
from hardware.scanning.simulated import simulated_cell
from hardware.simulation.depth_camera import CARMINE_INTRINSICS
from hardware.simulation.families.catalogue import families_of, members
from hardware.simulation.placing import place_on_platform, transform_mesh
from hardware.simulation.world import Hits, World
from training.appearance.labels import Hollow
from training.appearance.scenes import painted, with_faults

MAP_PX = SIZE_PX // 2
"""Side of the contain map, in cells."""
_FINER = 2
"""Rays per pixel, across and down."""
_POSE_M, _POSE_RAD = 0.03, 0.08
"""SD of where the camera is beside the cell's views."""


@dataclass(frozen=True)
class Subject:
    """An object to be rendered.

    Attributes:
        name: unique.
        kind: its family, or its category.
        mesh: in metres, z up.
        is_container: its label.
        is_held_out: whether it is for watching the training, not for learning.
    """

    name: str
    kind: str
    mesh: TriangleMesh
    is_container: bool
    is_held_out: bool


@dataclass(frozen=True)
class Example:
    """One view, upright, all of 255.

    Attributes:
        color: (96, 96, 3).
        nearness: (96, 96): how much nearer than the object's middle it is, in sides of the crop; 0 is a side
            farther or nothing, 255 a side nearer. For the variant that sees depth.
        contain: (48, 48) share of each cell that contains.
    """

    color: npt.NDArray[np.uint8]
    nearness: npt.NDArray[np.uint8]
    contain: npt.NDArray[np.uint8]


def family_subjects(n: int, seed: int) -> Iterator[Subject]:
    """Make members of the development half; every eighth of a family is held out, ambiguous ones are none."""
    chosen = families_of((), "development")
    for index, member in enumerate(members(chosen, n, seed)):
        if member.truth.label != "ambiguous":
            is_held_out = index // len(chosen) % 8 == 7
            is_container = member.truth.label == "container"
            yield Subject(member.name, member.family.name, member.mesh, is_container, is_held_out)


def development_objects(folder: Path) -> Iterator[Subject]:
    """Read the objects that parameters may be fitted to; none where the data set is not there."""
    if not folder.is_dir():
        return
    for one in read_labels(folder):
        if one.is_calibration and one.label != "ambiguous":
            mesh = read_mesh(one.mesh, Reporter())
            yield Subject(one.name, one.category, mesh, one.label == "container", is_held_out=False)


def examples_of(subject: Subject, n_views: int, seed: int) -> Iterator[Example]:
    """Render views of a subject: some of the cell's, a little beside them, each with another look.

    Raises:
        InputError: the object does not fit on the platform.
    """
    cell = simulated_cell()
    place = cell.place
    random = np.random.default_rng([seed, *subject.name.encode()])
    table_m = np.array([*place.platform_center_m[:2], place.table_height_m])
    pose = place_on_platform(subject.mesh, int(random.integers(2**31)), place, object_space(cell))
    mesh = transform_mesh(subject.mesh, pose)
    world = World(mesh, table_m)
    hollow = Hollow(mesh, world) if subject.is_container else None
    flanges = flange_pose(ARMS[cell.robot.model], np.array(cell.scan.views_rad))
    for k in random.choice(len(flanges), n_views, replace=n_views > len(flanges)):
        camera = _beside(flanges[k] @ cell.camera.pose, random)
        yield _example(world, mesh, hollow, camera, table_m, random)


def _beside(T_base_camera: FloatArray, random: np.random.Generator) -> FloatArray:
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_rotvec(random.normal(0, _POSE_RAD, 3)).as_matrix()
    return T_base_camera @ make_pose(turn, random.normal(0, _POSE_M, 3))


def _example(
    world: World,
    mesh: TriangleMesh,
    hollow: Hollow | None,
    T_base_camera: FloatArray,
    table_m: FloatArray,
    random: np.random.Generator,
) -> Example:
    square = _drawn_square(mesh, T_base_camera, random)
    rays = _rays(square)
    directions = rays @ T_base_camera[:3, :3].T
    eye_m = T_base_camera[:3, 3]
    hits = world.cast(eye_m, directions)
    unit_rays = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    fine = painted(random, hits, unit_rays, table_m, lambda lamp_m: world.hidden(hits.points_m, lamp_m))
    image = with_faults(random, _pooled(fine, _FINER))
    contain: FloatArray = np.zeros(hits.distance.shape)
    if hollow is not None:
        contain[hits.on_object] = hollow.contains(hits.points_m[hits.on_object], eye_m)
    cells = _pooled(contain, len(contain) // MAP_PX)
    nearness = _nearness(hits, square)[::_FINER, ::_FINER]
    turns = quarter_turns(T_base_camera)
    color, near, contains = (
        np.ascontiguousarray(np.rot90(np.rint(255 * one), turns)).astype(np.uint8)
        for one in (image, nearness, cells)
    )
    return Example(color, near, contains)


def _nearness(hits: Hits, square: Square) -> FloatArray:
    """Return (192, 192) from 0 to 1; distances along rays of z = 1 are depths."""
    middle_m = float(np.median(hits.distance[hits.on_object])) if hits.on_object.any() else 1.0
    side_m = square.side_px / CARMINE_INTRINSICS.fx * middle_m
    near: FloatArray = (0.5 + (middle_m - hits.distance) / (2 * side_m)).clip(0, 1)
    return near


def _drawn_square(mesh: TriangleMesh, T_base_camera: FloatArray, random: np.random.Generator) -> Square:
    """The object's square, a little off and a little larger or smaller."""
    points = transform_points(invert_pose(T_base_camera), mesh.vertices_m)
    x, y, z = points.T
    around = square_around(
        CARMINE_INTRINSICS.fx * x / z + CARMINE_INTRINSICS.cx,
        CARMINE_INTRINSICS.fy * y / z + CARMINE_INTRINSICS.cy,
    )
    side = around.side_px * random.uniform(0.92, 1.15)
    shift = random.uniform(-0.04, 0.04, 2) * side + (around.side_px - side) / 2
    return Square(around.left_px + shift[0], around.top_px + shift[1], side)


def _rays(square: Square) -> FloatArray:
    """Directions (192, 192, 3) in the camera's frame, z = 1."""
    n = SIZE_PX * _FINER
    columns, rows = np.meshgrid(np.arange(n), np.arange(n))
    places = square.pixels(np.column_stack([columns.ravel(), rows.ravel()]), n).reshape(n, n, 2)
    x = (places[..., 0] - CARMINE_INTRINSICS.cx) / CARMINE_INTRINSICS.fx
    y = (places[..., 1] - CARMINE_INTRINSICS.cy) / CARMINE_INTRINSICS.fy
    return np.stack([x, y, np.ones_like(x)], axis=-1)


def _pooled(values: FloatArray, n: int) -> FloatArray:
    """Means over blocks of `n` by `n`."""
    height, width = values.shape[0] // n, values.shape[1] // n
    means: FloatArray = values.reshape(height, n, width, n, *values.shape[2:]).mean(axis=(1, 3))
    return means
