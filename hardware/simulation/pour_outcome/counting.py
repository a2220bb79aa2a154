"""Which candies are in the object at the end."""

from __future__ import annotations

import numpy as np

from core.geometry import BoolArray, FloatArray
from core.mesh import TriangleMesh

_FLAT_M2 = 1e-12
"""Twice the area, seen from above, below which a face is upright and carries nothing."""
_SAMPLES = np.array(
    [
        (0.0, 0.0, 0.0),
        *((0.8 * np.cos(angle), 0.8 * np.sin(angle), 0.0) for angle in np.arange(8) * np.pi / 4),
    ]
)
"""Points of a candy seen from above, in radii."""


def in_object(
    mesh: TriangleMesh,
    positions_m: FloatArray,
    platform_height_m: float,
    rim_margin_m: float,
    candy_radius_m: float,
) -> BoolArray:
    """Return (N,) which of the candies at rest at (N, 3) are in the object.

    In it are those within the AABB's outline, above the platform, no higher than `rim_margin_m` above the
    AABB, and with the object's own surface somewhere beneath most of them: a candy on the platform beside a
    round bowl, in a corner of its AABB, was spilled, and so was one inside a ring that has no floor. One that
    lies over a crack narrower than itself was not.

    Args:
        mesh: the object as it stood, in the base frame.
        positions_m: the candies' centres.
        platform_height_m: top of the platform.
        rim_margin_m: for heaps.
        candy_radius_m: how far a candy reaches from its centre.
    """
    low, high = mesh.aabb_min_m, mesh.aabb_max_m
    height = positions_m[:, 2]
    inside: BoolArray = (
        ((positions_m[:, :2] > low[:2]) & (positions_m[:, :2] < high[:2])).all(axis=1)
        & (height > platform_height_m)
        & (height < high[2] + rim_margin_m)
    )
    for candy in np.flatnonzero(inside).tolist():
        beneath = [_surface_beneath(mesh, positions_m[candy] + shift) for shift in candy_radius_m * _SAMPLES]
        inside[candy] = 2 * sum(beneath) > len(beneath)
    return inside


def _surface_beneath(mesh: TriangleMesh, point_m: FloatArray) -> bool:
    """Whether a plumb line from a point (3,) meets the surface."""
    a, b, c = (mesh.vertices_m[mesh.faces[:, k]] for k in range(3))
    of_c = _turn(a, b, point_m)
    of_a = _turn(b, c, point_m)
    of_b = _turn(c, a, point_m)
    area = of_a + of_b + of_c
    covers = ((of_a >= 0) & (of_b >= 0) & (of_c >= 0)) | ((of_a <= 0) & (of_b <= 0) & (of_c <= 0))
    covers &= np.abs(area) > _FLAT_M2
    weighted = of_a * a[:, 2] + of_b * b[:, 2] + of_c * c[:, 2]
    return bool((weighted[covers] / area[covers] < point_m[2]).any())


def _turn(start_m: FloatArray, end_m: FloatArray, point_m: FloatArray) -> FloatArray:
    """Twice the signed area (F,) of the triangles start, end, point, seen from above."""
    along, towards = end_m - start_m, point_m - start_m
    turn: FloatArray = along[:, 0] * towards[:, 1] - along[:, 1] * towards[:, 0]
    return turn
