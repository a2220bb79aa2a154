"""Which candies at rest are in the object (Sec. IV-D)."""

from __future__ import annotations

from functools import lru_cache
from math import ceil

import numpy as np

from core.geometry import BoolArray, FloatArray
from core.mesh import TriangleMesh

_FLAT_M2 = 1e-12
"""Twice the area, seen from above, below which a face is upright and carries nothing."""
_UNIT = np.column_stack([np.cos(np.arange(8) * np.pi / 4), np.sin(np.arange(8) * np.pi / 4)])
_ROUND = np.vstack([(0.0, 0.0), 0.8 * _UNIT])
"""Points (9, 2) of a candy seen from above, in radii."""
_CELL_M = 0.001
"""Narrower than any bar."""


def in_object(
    mesh: TriangleMesh,
    positions_m: FloatArray,
    platform_height_m: float,
    rim_margin_m: float,
    candy_m: tuple[float, float],
) -> BoolArray:
    """Return (N,) which of the candies at rest at (N, 3) are in the object.

    In it are those within the AABB's outline, above the platform, no higher than `rim_margin_m` above the
    AABB, and with the object's own surface beneath: a candy on the platform beside a round bowl, in a corner
    of its AABB, was spilled, and so was one inside a ring that has no floor. Surface is beneath if it is
    beneath most of the candy, or if what is open there is too narrow for it even on edge: it lies on a grid.

    Args:
        mesh: the object as it stood, in the base frame.
        positions_m: the candies' centres.
        platform_height_m: top of the platform.
        rim_margin_m: for heaps.
        candy_m: a candy's diameter and thickness.
    """
    low, high = mesh.aabb_min_m, mesh.aabb_max_m
    height = positions_m[:, 2]
    inside: BoolArray = (
        ((positions_m[:, :2] > low[:2]) & (positions_m[:, :2] < high[:2])).all(axis=1)
        & (height > platform_height_m)
        & (height < high[2] + rim_margin_m)
    )
    corners = mesh.vertices_m[mesh.faces]
    reach_m = sum(candy_m) / 2
    lows, highs = corners[..., :2].min(axis=1), corners[..., :2].max(axis=1)
    for candy in np.flatnonzero(inside).tolist():
        center_m = positions_m[candy]
        is_near = (lows <= center_m[:2] + reach_m) & (highs >= center_m[:2] - reach_m)
        inside[candy] = _is_carried(corners[is_near.all(axis=1)], center_m, candy_m)
    return inside


def _is_carried(near: FloatArray, center_m: FloatArray, candy_m: tuple[float, float]) -> bool:
    """Whether the faces with corners `near` (F, 3, 3) in m are beneath a candy with its centre at (3,)."""
    diameter_m, thickness_m = candy_m
    beneath = _surface_beneath(near, center_m[2], center_m[:2] + diameter_m / 2 * _ROUND)
    if 2 * beneath.sum() > len(beneath):
        return True
    n = ceil(sum(candy_m) / 2 / _CELL_M)
    cells = np.stack(np.meshgrid(*2 * [np.arange(-n, n + 1)], indexing="ij"), axis=-1)
    covered = _surface_beneath(near, center_m[2], center_m[:2] + _CELL_M * cells.reshape(-1, 2))
    taken = np.rint(_ways_down(diameter_m, thickness_m) / _CELL_M).astype(int) + n
    return bool(covered.reshape(cells.shape[:2])[taken[..., 0], taken[..., 1]].any(axis=1).all())


@lru_cache
def _ways_down(diameter_m: float, thickness_m: float) -> FloatArray:
    """Points (W, P, 2) of a candy on edge seen from above, turned, and moved by half its thickness."""
    places = thickness_m / 2 * np.vstack([(0.0, 0.0), _UNIT])
    along, across = np.meshgrid(np.linspace(-1, 1, 15), np.linspace(-1, 1, 8))
    outline = np.column_stack([along.ravel(), across.ravel()])
    lens = outline[np.linalg.norm(outline, axis=1) <= 1] * [diameter_m / 2, thickness_m / 2]
    turns = np.arange(12) * np.pi / 12
    rotations = np.array([[(np.cos(a), -np.sin(a)), (np.sin(a), np.cos(a))] for a in turns])
    turned = np.einsum("tij,pj->tpi", rotations, lens)
    ways: FloatArray = (places[:, None, None, :] + turned[None]).reshape(-1, *lens.shape)
    return ways


def _surface_beneath(corners_m: FloatArray, height_m: float, points_m: FloatArray) -> BoolArray:
    """Whether plumb lines from points (M, 2) at a height meet faces (F, 3, 3)."""
    a, b, c = (corners_m[None, :, k] for k in range(3))
    points = points_m[:, None]
    of_c, of_a, of_b = (
        _signed_area_m2(a, b, points),
        _signed_area_m2(b, c, points),
        _signed_area_m2(c, a, points),
    )
    area = of_a + of_b + of_c
    covers = ((of_a >= 0) & (of_b >= 0) & (of_c >= 0)) | ((of_a <= 0) & (of_b <= 0) & (of_c <= 0))
    covers &= np.abs(area) > _FLAT_M2
    weighted = of_a * a[..., 2] + of_b * b[..., 2] + of_c * c[..., 2]
    is_low = np.sign(area) * (weighted - height_m * area) < 0  # weighted / area < height_m
    return np.asarray((covers & is_low).any(axis=1))


def _signed_area_m2(start_m: FloatArray, end_m: FloatArray, points_m: FloatArray) -> FloatArray:
    """Twice the signed area (M, F) of the triangles start, end, point, seen from above."""
    along, towards = end_m - start_m, points_m - start_m[..., :2]
    area: FloatArray = along[..., 0] * towards[..., 1] - along[..., 1] * towards[..., 0]
    return area
