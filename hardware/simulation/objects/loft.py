"""Closed surfaces drawn through a row of rings: turned, boxed and bent bodies are all made so."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from core.geometry import AnyArray, FloatArray
from core.mesh import TriangleMesh

N_SIDES = 96
"""Corners of a circle: at 40 mm radius the polygon lies within 0.02 mm of it."""

Point = tuple[float, float]


def loft(rings: npt.ArrayLike, *, closed: bool = False) -> TriangleMesh:
    """Join rings (R, K, 3) one after the other; the first and last are capped, or joined if `closed`.

    Each ring turns counter-clockwise seen against the direction in which the rings follow; then the faces
    look outwards.
    """
    points = np.asarray(rings, dtype=float)
    n_rings, n_corners = points.shape[:2]
    index = np.arange(n_rings * n_corners).reshape(n_rings, n_corners)
    if closed:
        faces = _bands(np.vstack([index, index[:1]]))
        return TriangleMesh(points.reshape(-1, 3), faces)
    first, last = index.size, index.size + 1
    caps = [_fan(index[0, ::-1], first), _fan(index[-1], last)]
    centres = points[[0, -1]].mean(axis=1)
    return TriangleMesh(
        np.concatenate([points.reshape(-1, 3), centres]), np.concatenate([_bands(index), *caps])
    )


def turned(profile: Sequence[Point], *, closed: bool = False) -> TriangleMesh:
    """Turn a profile of (radius, height) about z; it runs from the underside outwards, up and back in."""
    angles = np.linspace(0, 2 * np.pi, N_SIDES, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    return loft([_ring(radius * circle, height) for radius, height in profile], closed=closed)


def boxed(profile: Sequence[tuple[float, float, float]], corner_m: float) -> TriangleMesh:
    """Like `turned`, with rounded rectangles: a profile of (length along x, width along y, height)."""
    return loft(
        [_ring(rounded_rectangle(length, width, corner_m), height) for length, width, height in profile]
    )


def rounded_rectangle(length_m: float, width_m: float, corner_m: float, n_arc: int = 8) -> FloatArray:
    """Outline (4 n_arc, 2) of a rectangle about the origin, its corners rounded to `corner_m`."""
    arcs = []
    for quarter, (x, y) in enumerate([(1, 1), (-1, 1), (-1, -1), (1, -1)]):
        angles = np.linspace(0, np.pi / 2, n_arc) + quarter * np.pi / 2
        centre = np.array([x * (length_m / 2 - corner_m), y * (width_m / 2 - corner_m)])
        arcs.append(centre + corner_m * np.column_stack([np.cos(angles), np.sin(angles)]))
    return np.concatenate(arcs)


def bent_tube(path_xz_m: npt.ArrayLike, half_width_m: float, half_thickness_m: float) -> TriangleMesh:
    """Sweep an ellipse along a path (N, 2) in the xz-plane; `half_width_m` lies along y."""
    path = np.asarray(path_xz_m, dtype=float)
    tangents = np.gradient(path, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    normals = np.column_stack([tangents[:, 1], -tangents[:, 0]])
    angles = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    rings = np.empty((len(path), len(angles), 3))
    across = half_thickness_m * np.cos(angles)
    rings[:, :, [0, 2]] = path[:, None] + normals[:, None] * across[None, :, None]
    rings[:, :, 1] = half_width_m * np.sin(angles)
    return loft(rings)


def arc(centre: Point, radius_m: float, start_rad: float, end_rad: float, n: int = 7) -> list[Point]:
    """Points on an arc in the plane of a profile."""
    angles = np.linspace(start_rad, end_rad, n)
    return [
        (centre[0] + radius_m * float(np.cos(a)), centre[1] + radius_m * float(np.sin(a))) for a in angles
    ]


def _ring(outline: FloatArray, height_m: float) -> FloatArray:
    return np.column_stack([outline, np.full(len(outline), height_m)])


def _bands(index: AnyArray) -> AnyArray:
    """Two triangles for each cell between neighbouring rows of `index`."""
    a, b = index[:-1], np.roll(index[:-1], -1, axis=1)
    d, c = index[1:], np.roll(index[1:], -1, axis=1)
    return np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)


def _fan(ring: AnyArray, centre: int) -> AnyArray:
    return np.stack([ring, np.roll(ring, -1), np.full_like(ring, centre)], axis=-1)
