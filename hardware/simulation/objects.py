"""Built-in objects, made by code: closed surfaces in metres that rest on z = 0, z up.

Seven hold something as they stand, six do not; of the last three, looks and physics may say different things.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Sequence
from math import pi

import numpy as np
import numpy.typing as npt

from core.errors import InputError
from core.formats import excerpt
from core.geometry import AnyArray, FloatArray
from core.mesh import TriangleMesh
from core.mesh_topology import join

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
    """Revolve a profile of (radius, height) about z; it runs from the underside outwards, up and back in."""
    angles = np.linspace(0, 2 * np.pi, N_SIDES, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    return loft([_ring(radius * circle, height) for radius, height in profile], closed=closed)


def boxed(profile: Sequence[tuple[float, float, float]], corner_m: float) -> TriangleMesh:
    """Like `turned`, with rounded rectangles: a profile of (length along x, width along y, height)."""
    return loft(
        [_ring(rounded_rectangle(length, width, corner_m), height) for length, width, height in profile]
    )


def rounded_rectangle(length_m: float, width_m: float, corner_m: float) -> FloatArray:
    """Outline (32, 2) of a rectangle about the origin, its corners rounded to `corner_m`."""
    arcs = []
    for quarter, (x, y) in enumerate([(1, 1), (-1, 1), (-1, -1), (1, -1)]):
        angles = np.linspace(0, np.pi / 2, 8) + quarter * np.pi / 2
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


def builtin_object(name: str) -> TriangleMesh:
    """Make the object of that name: closed, in metres, resting on z = 0.

    Raises:
        InputError: there is none of that name; the nearest is offered.
    """
    if name not in BUILTIN_OBJECTS:
        said = excerpt(name)
        nearest = max(BUILTIN_OBJECTS, key=lambda known: difflib.SequenceMatcher(None, said, known).ratio())
        raise InputError(
            f"There is no built-in object '{said}'; did you mean '{nearest}'? "
            f"Known are {', '.join(BUILTIN_OBJECTS)}."
        )
    return BUILTIN_OBJECTS[name]()


def vessel_profile(outside: list[Point], wall_m: float, floor_m: float) -> tuple[list[Point], list[Point]]:
    """Profile of a vessel of even wall, in two: from the foot to the rim, and from its top to the floor.

    The cavity is the outside, (radius, height) from the foot to the rim, moved inwards by the wall and cut
    off at the floor; the rim is half a circle.
    """
    outline = np.array(outside)
    along = np.gradient(outline, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    inside = outline + wall_m * np.column_stack([-along[:, 1], along[:, 0]])
    floor_radius = float(np.interp(floor_m, inside[:, 1], inside[:, 0]))
    inside = inside[inside[:, 1] > floor_m + 0.0005]
    rim_centre = (outline[-1] + inside[-1]) / 2
    lean = float(np.arctan2(*(outline[-1] - inside[-1])[::-1]))
    rim = arc((float(rim_centre[0]), float(rim_centre[1])), wall_m / 2, lean, lean + pi)
    top = max(range(len(rim)), key=lambda k: rim[k][1])
    return [*outside[:-1], *rim[:top]], [*rim[top:], *map(_point, inside[-2::-1]), (floor_radius, floor_m)]


def _vessel(outside: list[Point], wall_m: float, floor_m: float) -> TriangleMesh:
    """A turned vessel of even wall; `outside` are (radius, height) from the foot to the rim."""
    outer, inner = vessel_profile(outside, wall_m, floor_m)
    return turned([*outer, *inner])


def _point(values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> Point:
    return float(values[0]), float(values[1])


def smooth(corners: list[Point], n: int = 40) -> list[Point]:
    """A monotone curve of radius over height through (radius, height) corners."""
    from scipy.interpolate import PchipInterpolator

    radii, heights = np.array(corners).T
    fine = np.linspace(heights[0], heights[-1], n)
    return list(zip(PchipInterpolator(heights, radii)(fine).tolist(), fine.tolist(), strict=True))


def _mug() -> TriangleMesh:
    """80 x 95 mm, wall 4 mm. Handle and body are two closed surfaces; the handle ends within the wall."""
    body = _vessel(
        [(0.037, 0.0), (0.0395, 0.003), (0.040, 0.008), (0.040, 0.05), (0.040, 0.095)], 0.004, 0.006
    )
    bow = arc((0.0, 0.0), 1.0, -pi / 2, pi / 2, 25)
    handle = bent_tube([(0.0385 + 0.031 * x, 0.050 + 0.029 * z) for x, z in bow], 0.0065, 0.0042)
    return join((body, handle))


def _bowl() -> TriangleMesh:
    """150 x 65 mm, wall 4 mm."""
    curve = [(0.030, 0.0), (0.045, 0.006), (0.060, 0.020), (0.070, 0.040), (0.075, 0.063)]
    return _vessel(smooth(curve), 0.004, 0.007)


def _plate() -> TriangleMesh:
    """240 x 24 mm: a flat middle of 150 mm and a rising rim, 4 mm thick."""
    profile = [(0.074, 0.0), (0.082, 0.003), (0.118, 0.020)]
    lip = arc((0.1175, 0.0219), 0.002, -pi / 3, 2 * pi / 3)
    return turned([*profile, *lip, (0.080, 0.0075), (0.072, 0.0045)])


def _bottle() -> TriangleMesh:
    """65 x 210 mm with its cap on, so it holds nothing as it stands; solid, for nothing sees its inside."""
    body = smooth([(0.0325, 0.004), (0.0325, 0.13), (0.031, 0.145), (0.014, 0.18), (0.014, 0.188)], 50)
    cap = [(0.0165, 0.188), (0.0165, 0.208), (0.0145, 0.210)]
    return turned([(0.030, 0.0), *body, *cap])


def _open_ring() -> TriangleMesh:
    """120 mm across, 24 mm thick, lying flat: a wall around nothing but the table."""
    return turned(arc((0.048, 0.012), 0.012, -pi / 2, 3 * pi / 2, 33)[:-1], closed=True)


def _vase() -> TriangleMesh:
    """200 mm tall, 84 mm at its belly, with an opening of 40 mm; wall 4 mm."""
    belly = [(0.030, 0.0), (0.034, 0.01), (0.042, 0.06), (0.034, 0.12), (0.023, 0.17), (0.024, 0.198)]
    return _vessel(smooth(belly, 60), 0.004, 0.008)


def _glass() -> TriangleMesh:
    """A tumbler, 76 mm at the rim, 120 mm tall; wall 3 mm, floor 8 mm."""
    return _vessel([(0.0290, 0.0), (0.0300, 0.002), (0.0340, 0.06), (0.0380, 0.119)], 0.003, 0.008)


def _box() -> TriangleMesh:
    """An open box, 180 x 130 x 90 mm; wall and floor 4 mm."""
    return boxed([(0.18, 0.13, 0.0), (0.18, 0.13, 0.09), (0.172, 0.122, 0.09), (0.172, 0.122, 0.004)], 0.006)


def _tray() -> TriangleMesh:
    """A serving tray, 280 x 190 x 36 mm with leaning walls; wall and floor 4 mm."""
    outside = [(0.25, 0.16, 0.0), (0.28, 0.19, 0.036)]
    inside = [(0.272, 0.182, 0.036), (0.2453, 0.1553, 0.004)]
    return boxed([*outside, *inside], 0.012)


def _block() -> TriangleMesh:
    """A solid block, 120 x 80 x 60 mm."""
    return boxed([(0.12, 0.08, 0.0), (0.12, 0.08, 0.06)], 0.003)


def _upturned_cup() -> TriangleMesh:
    """A mug without a handle, upside down, 84 x 100 mm; its foot, now on top, is hollow by 3 mm."""
    outer, inner = vessel_profile([(0.038, 0.0), (0.040, 0.004), (0.042, 0.099)], 0.004, 0.008)
    foot = [(0.034, 0.003), (0.0345, 0.0)]
    upright = turned([*foot, *outer, *inner])
    top = upright.aabb_max_m[2]
    return TriangleMesh(upright.vertices_m * [1, -1, -1] + [0, 0, top], upright.faces)


def _holed_cup() -> TriangleMesh:
    """A tumbler, 80 x 100 mm, whose floor has a hole of 46 mm: candies fall through as through a ring."""
    outer, inner = vessel_profile(
        [(0.0320, 0.0), (0.0330, 0.002), (0.0370, 0.05), (0.0400, 0.099)], 0.003, 0.005
    )
    return turned([(0.023, 0.0), *outer, *inner, (0.023, 0.005)], closed=True)


def _lid() -> TriangleMesh:
    """The lid of a pot, 170 x 47 mm, with a knob in a hollow whose edge is 3 mm high."""
    dome = smooth([(0.083, 0.004), (0.078, 0.018), (0.070, 0.022)], 12)
    knob = [(0.064, 0.019), (0.014, 0.019), (0.010, 0.030), (0.018, 0.038), (0.016, 0.046), (0.010, 0.047)]
    return turned([(0.080, 0.0), (0.085, 0.0), *dome, *knob])


BUILTIN_OBJECTS: dict[str, Callable[[], TriangleMesh]] = {
    "mug": _mug,
    "bowl": _bowl,
    "plate": _plate,
    "glass": _glass,
    "vase": _vase,
    "box": _box,
    "tray": _tray,
    "bottle": _bottle,
    "ring": _open_ring,
    "block": _block,
    "upturned-cup": _upturned_cup,
    "holed-cup": _holed_cup,
    "lid": _lid,
}
"""Makers by name; the first is the default."""
