"""Where an object stands in the simulated cell, and the world around it."""

from __future__ import annotations

import numpy as np

from core.errors import InputError
from core.geometry import FloatArray, make_pose, rotation_z, transform_points
from core.mesh import TriangleMesh
from core.scan.model import CropBox
from hardware.cell.settings import PlaceSettings
from hardware.simulation.world import World

WALL_MARGIN_M = 0.01
"""Clearance between object and crop box."""
MAX_OFFSET_M = 0.03
_PLACING_DRAWS = 200


def world_with(
    mesh: TriangleMesh, place: PlaceSettings, seed: int, space: CropBox | None = None, *, is_lit: bool = True
) -> World:
    """Return the simulated world with an object on its platform; the transparent platform is not seen.

    Args, errors: see `place_on_platform`; without light its colour images are black.
    """
    table = np.array([*place.platform_center_m[:2], place.table_height_m])
    return World(transform_mesh(mesh, place_on_platform(mesh, seed, place, space)), table, is_lit=is_lit)


def place_on_platform(
    mesh: TriangleMesh, seed: int, place: PlaceSettings, space: CropBox | None = None
) -> FloatArray:
    """Return `T_base_object` of an object upright on the platform: any yaw, up to 30 mm beside its middle.

    Args:
        mesh: the object in metres, z up.
        seed: of the draws.
        place: platform and crop box, in which it is placed if it fits.
        space: where else it may stand, beyond the crop box; there straight in the middle if no draw fits.

    Raises:
        InputError: the object does not fit, however it is rotated.
    """
    random = np.random.default_rng([seed, 0])
    drawn = (_draw(random) for _ in range(_PLACING_DRAWS))
    beyond = (_draw(random) for _ in range(_PLACING_DRAWS))
    straight = ((yaw_rad, np.zeros(2)) for yaw_rad in (0.0, np.pi / 2))
    tries = [(place.crop_box, drawn)] + ([] if space is None else [(space, beyond), (space, straight)])
    for room, poses in tries:
        for yaw_rad, offset_m in poses:
            pose = _standing(mesh, yaw_rad, offset_m, place, room)
            if pose is not None:
                return pose
    raise InputError(_no_room(mesh, place, space))


def _draw(random: np.random.Generator) -> tuple[float, FloatArray]:
    """A yaw in radians and an offset (2,) in metres."""
    return random.uniform(0, 2 * np.pi), random.uniform(-MAX_OFFSET_M, MAX_OFFSET_M, size=2)


def _standing(
    mesh: TriangleMesh, yaw_rad: float, offset_m: FloatArray, place: PlaceSettings, box: CropBox
) -> FloatArray | None:
    """The pose (4, 4) of the object that stands there; none if it leaves the box."""
    rotation = rotation_z(yaw_rad)
    rotated = mesh.vertices_m @ rotation.T
    low, high = rotated.min(axis=0), rotated.max(axis=0)
    stand = place.platform_center_m + np.array([*(offset_m - ((low + high) / 2)[:2]), -low[2]])
    room_low, room_high = np.array(box.min_m) + WALL_MARGIN_M, np.array(box.max_m) - WALL_MARGIN_M
    is_inside = (low + stand >= room_low).all() and (high + stand <= room_high).all()
    return make_pose(rotation, stand) if is_inside else None


def _no_room(mesh: TriangleMesh, place: PlaceSettings, space: CropBox | None) -> str:
    box = space or place.crop_box
    room_m = np.array(box.max_m) - np.array(box.min_m) - 2 * WALL_MARGIN_M
    room_m[2] = box.max_m[2] - WALL_MARGIN_M - place.platform_height_m
    size, room = (" x ".join(f"{edge * 1000:.0f}" for edge in edges) for edges in (mesh.extents_m, room_m))
    return (
        f"The object of {size} mm does not fit on the platform, where there is space for {room} mm; take a "
        "smaller object"
        + (", or enlarge crop_min_m and crop_max_m in the cell file." if space is None else ".")
    )


def transform_mesh(mesh: TriangleMesh, T_target_source: FloatArray) -> TriangleMesh:
    """Return the mesh in another frame."""
    return TriangleMesh(transform_points(T_target_source, mesh.vertices_m), mesh.faces)
