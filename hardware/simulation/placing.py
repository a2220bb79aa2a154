"""Where an object stands in the simulated cell, and the world around it."""

from __future__ import annotations

import numpy as np

from core.errors import InputError
from core.geometry import FloatArray, make_pose, rotation_z, transform_points
from core.mesh import TriangleMesh
from hardware.cell.settings import PlaceSettings
from hardware.simulation.world import World

WALL_MARGIN_M = 0.01
"""Clearance between object and crop box."""
MAX_OFFSET_M = 0.03
_PLACING_DRAWS = 200


def world_with(mesh: TriangleMesh, place: PlaceSettings, seed: int) -> World:
    """Return the simulated world with an object on its platform; the transparent platform is not seen.

    Raises:
        InputError: the object does not fit into the crop box.
    """
    table = np.array([*place.platform_center_m[:2], place.table_height_m])
    return World(transform_mesh(mesh, place_on_platform(mesh, seed, place)), table)


def place_on_platform(mesh: TriangleMesh, seed: int, place: PlaceSettings) -> FloatArray:
    """Return `T_base_object` of an object upright on the platform: any yaw, up to 30 mm beside its middle.

    Raises:
        InputError: the object does not fit into the crop box, however it is rotated.
    """
    random = np.random.default_rng([seed, 0])
    low, high = np.array(place.crop_min_m) + WALL_MARGIN_M, np.array(place.crop_max_m) - WALL_MARGIN_M
    center = place.platform_center_m
    for _ in range(_PLACING_DRAWS):
        rotation = rotation_z(random.uniform(0, 2 * np.pi))
        offset = random.uniform(-MAX_OFFSET_M, MAX_OFFSET_M, size=2)
        rotated = mesh.vertices_m @ rotation.T
        middle = (rotated.min(axis=0) + rotated.max(axis=0)) / 2
        stand = center + np.array([*(offset - middle[:2]), -rotated[:, 2].min()])
        if (rotated.min(axis=0) + stand >= low).all() and (rotated.max(axis=0) + stand <= high).all():
            return make_pose(rotation, stand)
    size = " x ".join(f"{edge * 1000:.0f}" for edge in mesh.extents_m)
    space = " x ".join(f"{edge * 1000:.0f}" for edge in (*(high - low)[:2], high[2] - center[2]))
    raise InputError(
        f"The object of {size} mm does not fit on the platform, whose crop box has space for {space} mm; "
        "take a smaller object, or enlarge crop_min_m and crop_max_m in the cell file."
    )


def transform_mesh(mesh: TriangleMesh, T_target_source: FloatArray) -> TriangleMesh:
    """Return the mesh in another frame."""
    return TriangleMesh(transform_points(T_target_source, mesh.vertices_m), mesh.faces)
