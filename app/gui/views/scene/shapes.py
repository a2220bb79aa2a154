"""Simple surfaces as arrays of vertices (N, 3) and faces (F, 3), counter-clockwise from outside."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray, IntArray

Shape = tuple[FloatArray, IntArray]

_SIDES = 24
_NONE = np.empty((0, 3))


def box_mesh(min_m: npt.ArrayLike, max_m: npt.ArrayLike) -> Shape:
    """A box; each side has its own four vertices, so that its edges look sharp.

    Args:
        min_m: (3,) lower corner.
        max_m: (3,) upper corner.
    """
    low, high = np.asarray(min_m, dtype=float), np.asarray(max_m, dtype=float)
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    vertices: list[FloatArray] = []
    faces = []
    for axis, sign in product(range(3), (-1, 1)):
        corners = np.full((4, 3), float(sign))
        corners[:, [(axis + 1) % 3, (axis + 2) % 3]] = square[:: sign or 1]
        faces.append(np.array([[0, 1, 2], [0, 2, 3]]) + 4 * len(vertices))
        vertices.append(corners)
    return (low + high) / 2 + np.vstack(vertices) * (high - low) / 2, np.vstack(faces)


def revolved_mesh(profile_m: Sequence[tuple[float, float]], sides: int = _SIDES) -> Shape:
    """A profile revolved about z; its edge is sharp where a point of the profile is repeated.

    Args:
        profile_m: (radius, height) from the top to the bottom of the outside; it is closed where it begins
            and ends on the axis.
        sides: of the polygon that approximates the circle.
    """
    outline = np.array(profile_m, dtype=float)
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    vertices = np.empty((len(outline), sides, 3))
    vertices[..., :2] = outline[:, None, :1] * ring
    vertices[..., 2] = outline[:, None, 1]
    here = np.arange(sides)
    after = np.roll(here, -1)
    faces = []
    for k in range(len(outline) - 1):
        if (outline[k] == outline[k + 1]).all():
            continue
        upper, lower = k * sides, (k + 1) * sides
        if outline[k + 1, 0] > 0:
            faces.append(np.column_stack([upper + here, lower + here, lower + after]))
        if outline[k, 0] > 0:
            faces.append(np.column_stack([upper + here, lower + after, upper + after]))
    return vertices.reshape(-1, 3), np.vstack(faces)


def cylinder_mesh(radius_m: float, length_m: float, top_radius_m: float | None = None) -> Shape:
    """A closed cylinder, or a frustum of a cone, from the origin along z."""
    top = radius_m if top_radius_m is None else top_radius_m
    rim = [(0.0, length_m), (top, length_m), (top, length_m), (radius_m, 0.0), (radius_m, 0.0), (0.0, 0.0)]
    return revolved_mesh(rim)


def capsule_mesh(start_m: npt.ArrayLike, end_m: npt.ArrayLike, radius_m: float, sides: int = _SIDES) -> Shape:
    """All points within a radius of a segment: a cylinder with round ends."""
    start, end = np.asarray(start_m, dtype=float), np.asarray(end_m, dtype=float)
    length = float(np.linalg.norm(end - start))
    angle = np.linspace(0, np.pi / 2, sides // 4 + 1)
    cap = [(radius_m * float(np.sin(a)), radius_m * float(np.cos(a))) for a in angle]
    cap[0] = (0.0, radius_m)
    profile = [(r, length + h) for r, h in cap] + [(r, -h) for r, h in reversed(cap)]
    vertices, faces = revolved_mesh(profile, sides)
    return vertices @ _axes_along(end - start).T + start, faces


def rounded_cylinder(
    start_m: npt.ArrayLike, end_m: npt.ArrayLike, radius_m: float, bevel_m: float, sides: int = 32
) -> Shape:
    """A closed cylinder between two points whose edges are rounded by a bevel, at most half its length."""
    start, end = np.asarray(start_m, dtype=float), np.asarray(end_m, dtype=float)
    length = float(np.linalg.norm(end - start))
    bevel = min(bevel_m, length / 2, radius_m)
    angle = np.linspace(0, np.pi / 2, 4)
    edge = [(radius_m - bevel * (1 - float(np.sin(a))), bevel * (1 - float(np.cos(a)))) for a in angle]
    top = [(r, length - h) for r, h in edge]
    profile = [(0.0, length), top[0], *top, *reversed(edge), edge[0], (0.0, 0.0)]
    vertices, faces = revolved_mesh(profile, sides)
    return vertices @ _axes_along(end - start).T + start, faces


def arrow_mesh(start_m: npt.ArrayLike, end_m: npt.ArrayLike) -> Shape:
    """An arrow as thick as suits its length."""
    start, end = np.asarray(start_m, dtype=float), np.asarray(end_m, dtype=float)
    length = float(np.linalg.norm(end - start))
    shaft, head, neck = 0.022 * length, 0.07 * length, 0.78 * length
    profile = [(0.0, length), (head, neck), (head, neck), (shaft, neck), (shaft, neck), (shaft, 0.0)]
    vertices, faces = revolved_mesh([*profile, (shaft, 0.0), (0.0, 0.0)])
    return vertices @ _axes_along(end - start).T + start, faces


def merged(shapes: Sequence[Shape]) -> Shape:
    """Several surfaces as one."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in shapes)])
    faces = [faces + start for (_, faces), start in zip(shapes, starts, strict=False)]
    return np.vstack([_NONE, *(vertices for vertices, _ in shapes)]), np.vstack([_NONE.astype(int), *faces])


def box_edges(min_m: npt.ArrayLike, max_m: npt.ArrayLike) -> FloatArray:
    """The twelve edges (24, 3) of a box, two points each."""
    corners = np.array(list(product((0, 1), repeat=3)), dtype=float)
    pairs = [
        (a, b) for a, b in product(range(8), repeat=2) if a < b and np.abs(corners[a] - corners[b]).sum() == 1
    ]
    low, high = np.asarray(min_m, dtype=float), np.asarray(max_m, dtype=float)
    edges: FloatArray = low + corners[np.array(pairs).ravel()] * (high - low)
    return edges


def _axes_along(direction: FloatArray) -> FloatArray:
    """A rotation (3, 3) that takes z to a direction; any for a zero direction."""
    length = np.linalg.norm(direction)
    if length == 0:
        return np.eye(3)
    z = direction / length
    x = np.cross([0.0, 1.0, 0.0] if abs(z[1]) < 0.9 else [1.0, 0.0, 0.0], z)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def band_mesh(ends_m: FloatArray, normals: FloatArray, width_m: float, apart_m: float) -> Shape:
    """An upright band along pieces of a level line, in front of what the line lies on.

    Args:
        ends_m: (K, 2, 3) of the pieces.
        normals: (K, 3) level unit vectors towards where it is seen from.
        width_m: from its lower to its upper edge.
        apart_m: from what it lies on, so that both are told apart.
    """
    middle = ends_m + apart_m * normals[:, None]
    half = np.array([0.0, 0.0, width_m / 2])
    corners = np.concatenate([middle - half, middle[:, ::-1] + half], axis=1)
    faces = np.array([[0, 1, 2], [0, 2, 3]]) + 4 * np.arange(len(ends_m))[:, None, None]
    return corners.reshape(-1, 3), faces.reshape(-1, 3)
