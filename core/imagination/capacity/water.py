"""How much water, and how much of anything as thick as a candy, an object at rest holds: geometry alone.

Imported by workers alone, for it loads numba.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, pi

import numba
import numpy as np

from core.geometry import BoolArray, FloatArray, IntArray
from core.imagination.capacity.basin import ML, Basin
from core.imagination.capacity.stand_in import NOWHERE, Surroundings
from core.imagination.hollow_map import HollowMap
from core.mesh import TriangleMesh
from core.voxel_groups import large_groups

FLATNESS = 0.5
"""Pitch along z relative to that across: a rim's height decides more than a wall's place."""
_FINEST_M = 0.0005
_MOUTH_LAYERS = 12
_NEAR = 1.5
"""Water within so many half thicknesses of a candy's centre is where candies are."""
_BESIDE, _BESIDE_PITCHES = 1.3, 1.2
"""So far, likewise, where it is not known to hold water; and so many pitches beyond a ball if a wall is next,
for a coarse lattice leaves so much beside it. More would run out of a basket's openings."""


def find_basin(mesh: TriangleMesh, thickness_m: float, smallest_ml: float, points: int) -> Basin:
    """Pour water, and candies without friction, into a mesh at rest.

    Args:
        mesh: any surface, open or closed; its upward axis is z. Below its lowest point is outside.
        thickness_m: of a candy.
        smallest_ml: of a hollow that counts.
        points: of the lattice, about; the result's error goes with its pitch.
    """
    pitch = lattice_pitch_m(mesh, points)
    lattice = lattice_around(mesh, pitch, FLATNESS * pitch, thickness_m)
    layers = np.arange(lattice.shape[2])
    spill = spill_layers(lattice, np.zeros(lattice.shape, dtype=np.bool_))
    water = large_groups(spill > layers, smallest_ml / ML / lattice.cell_m3)
    candies, rims_m = _candies(lattice, water, thickness_m / 2, smallest_ml / ML / lattice.cell_m3)
    heights, volumes = _curve(lattice, candies)
    return Basin(
        water_ml=float(water.sum() * lattice.cell_m3 * ML),
        water_level_m=_main_level(lattice, spill, water),
        rim_m=_most_common(rims_m[candies]),
        heights_m=heights,
        volumes_ml=volumes,
        around=_surroundings(lattice, candies),
        mouth_m=_mouth_m(lattice, candies),
        narrow_ml=float((water & ~candies).sum() * lattice.cell_m3 * ML),
        hollow_map=_map(lattice, candies, rims_m),
    )


def _map(lattice: Lattice, held: BoolArray, rims_m: FloatArray) -> HollowMap:
    is_open: BoolArray = np.any(held & ~lattice.below_surface(), axis=2)
    return HollowMap(
        origin_m=lattice.origin_m[:2],
        pitch_m=float(lattice.pitch_m[0]),
        rim_m=np.where(held, rims_m, -np.inf).max(axis=2),
        floor_m=np.where(held, lattice.heights_m, np.inf).min(axis=2),
        is_open=is_open,
    )


def lattice_pitch_m(mesh: TriangleMesh, points: int) -> float:
    """Return the pitch across of a lattice of about so many points; along z it is `FLATNESS` of it."""
    pitch: float = (float(np.prod(mesh.extents_m)) / FLATNESS / points) ** (1 / 3)
    return max(pitch, _FINEST_M)


def _candies(
    lattice: Lattice, water: BoolArray, radius_m: float, fewest: float
) -> tuple[BoolArray, FloatArray]:
    """Return the points (X, Y, Z) that a sphere in the hollows reaches, and the height of each one's rim."""
    from scipy.ndimage import distance_transform_edt

    pitch = lattice.pitch_m.tolist()
    layers = np.arange(lattice.shape[2])
    taken = distance_transform_edt(~lattice.beside_surface(), sampling=pitch) < radius_m
    spill = spill_layers(lattice, taken)
    centres = (spill > layers) & ~taken
    if not centres.any():
        return centres, np.full(lattice.shape, -np.inf)
    away, nearest = distance_transform_edt(~centres, sampling=pitch, return_indices=True)
    # A sphere runs over when its centre is its radius above the rim.
    rims_m = lattice.heights_m[spill[tuple(nearest)]] - radius_m - pitch[2] / 2
    below_rim = lattice.heights_m < rims_m
    near = (away < _NEAR * radius_m) & below_rim
    touched = (away < radius_m) & below_rim
    reached = touched | _beside(lattice, touched, away, radius_m, rims_m) | (water & near)
    return large_groups(reached, fewest), rims_m


def _beside(
    lattice: Lattice, touched: BoolArray, away: FloatArray, radius_m: float, rims_m: FloatArray
) -> BoolArray:
    """Return the points (X, Y, Z) between balls and a wall that no face parts from where balls reach.

    A scan's wall is rough, and one with a pinhole holds no water that would tell what lies beside a ball. Not
    in the uppermost layers, where points are joined over the rim.
    """
    pitch = lattice.pitch_m.tolist()
    below_rim = lattice.heights_m < rims_m - 2 * pitch[2]
    within = (away < _BESIDE * radius_m) & below_rim
    at_wall = (away < radius_m + _BESIDE_PITCHES * pitch[0]) & below_rim
    held: BoolArray = touched & within
    layers = round(1 / FLATNESS)
    for axis in (0, 1, *(2,) * layers) * ceil((_BESIDE - 1) * radius_m / pitch[0]):
        parted = np.moveaxis(lattice.parted[axis], axis, 0)
        line, room, wall = (np.moveaxis(one, axis, 0) for one in (held, within, at_wall))
        up = line[:-1] & ~parted[:-1] & (room[1:] | wall[1:] & parted[1:])
        down = line[1:] & ~parted[:-1] & room[:-1]
        down[1:] |= line[2:] & ~parted[1:-1] & wall[1:-1] & parted[:-2]
        line[1:] |= up
        line[:-1] |= down
    return held


def _most_common(values: FloatArray) -> float:
    """The value that most have; NaN of none."""
    if not len(values):
        return float("nan")
    found, counts = np.unique(values, return_counts=True)
    return float(found[counts.argmax()])


def _curve(lattice: Lattice, held: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Heights (K,), from floor to rim, and the volume (K,) in ml below each."""
    areas = held.sum(axis=(0, 1))
    used = np.flatnonzero(areas)
    if not len(used):
        return np.empty(0), np.empty(0)
    first, last = int(used[0]), int(used[-1])
    heights = lattice.heights_m[0] + lattice.pitch_m[2] * (np.arange(first, last + 2) - 0.5)
    points = np.concatenate([[0], np.cumsum(areas[first : last + 1])])
    return heights, points * lattice.cell_m3 * ML


def _main_level(lattice: Lattice, spill: IntArray, water: BoolArray) -> float:
    """Height at which most of the water runs over."""
    if not water.any():
        return float("nan")
    layer = int(np.bincount(spill[water]).argmax())
    return float(lattice.heights_m[layer] - lattice.pitch_m[2] / 2)


def _surroundings(lattice: Lattice, held: BoolArray) -> Surroundings:
    """Floor and walls beside points; of upright walls seen along x and y, whichever way they are turned."""
    if not held.any():
        return NOWHERE
    x, y, z = lattice.pitch_m
    seen = [
        int((parted & held).sum() + (lattice.before(axis) & held).sum())
        for axis, parted in enumerate(lattice.parted)
    ]
    side_m2 = pi / 4 * (seen[0] * y * z + seen[1] * x * z)
    return Surroundings(float(held.sum()) * lattice.cell_m3, seen[2] * x * y, side_m2)


def _mouth_m(lattice: Lattice, held: BoolArray) -> float:
    """Width of the narrowest layer among those that lie above half of the volume; zero without volume."""
    from scipy.ndimage import distance_transform_edt

    above = np.cumsum(held.sum(axis=(0, 1))[::-1])[::-1]
    used = np.flatnonzero((above > 0) & (above <= max(above[0] / 2, 1)))
    if not len(used):
        return 0.0
    used = used[: max(len(used) - 1, 1)]  # the uppermost may be cut by a slanting rim
    layers = used[:: max(len(used) // _MOUTH_LAYERS, 1)]
    return float(min(2 * distance_transform_edt(held[:, :, k]).max() for k in layers) * lattice.pitch_m[0])


_MARGIN = 2
"""Points beyond the mesh on each side, which are outside."""
_EDGE_SLACK = 1e-9
"""Share of a face by which a line may miss it: no line slips between two faces."""


@dataclass(frozen=True)
class Lattice:
    """Points (i, j, k) at `origin_m + pitch_m * (i, j, k)`, i < X, j < Y, k < Z.

    Attributes:
        origin_m: (3,).
        pitch_m: (3,) distance of neighbours along each axis.
        parted: (3, X, Y, Z) whether a face lies between a point and the next one along x, y, z.
    """

    origin_m: FloatArray
    pitch_m: FloatArray
    parted: BoolArray

    @property
    def shape(self) -> tuple[int, int, int]:
        """(X, Y, Z)."""
        _, n_x, n_y, n_z = self.parted.shape
        return n_x, n_y, n_z

    @property
    def cell_m3(self) -> float:
        """Volume that a point stands for."""
        return float(np.prod(self.pitch_m))

    @property
    def heights_m(self) -> FloatArray:
        """(Z,) heights of the layers."""
        heights: FloatArray = self.origin_m[2] + self.pitch_m[2] * np.arange(self.shape[2])
        return heights

    def beside_surface(self) -> BoolArray:
        """(X, Y, Z) points with a face between them and a neighbour."""
        after = [self.before(axis) for axis in range(3)]
        beside: BoolArray = np.any([*self.parted, *after], axis=0)
        return beside

    def below_surface(self) -> BoolArray:
        """(X, Y, Z) points with a face anywhere above them."""
        below: BoolArray = np.logical_or.accumulate(self.parted[2, :, :, ::-1], axis=2)[:, :, ::-1]
        return below

    def before(self, axis: int) -> BoolArray:
        """(X, Y, Z) points with a face between them and the one before; no face lies behind the last one."""
        return np.roll(self.parted[axis], 1, axis=axis)


def lattice_around(mesh: TriangleMesh, pitch_m: float, pitch_z_m: float, above_m: float) -> Lattice:
    """Lay a lattice around a mesh, from half a pitch below it to at least `above_m` above it."""
    pitch = np.array([pitch_m, pitch_m, pitch_z_m])
    counts = np.ceil((mesh.extents_m + np.array([0, 0, above_m])) / pitch).astype(np.int64) + 2 * _MARGIN
    middle = (mesh.aabb_min_m + mesh.aabb_max_m) / 2
    origin = middle - pitch * (counts - 1) / 2
    origin[2] = mesh.aabb_min_m[2] - pitch_z_m / 2
    parted = np.zeros((3, *counts.tolist()), dtype=np.bool_)
    points = (mesh.vertices_m - origin) / pitch
    for axis in range(3):
        across = np.roll(np.arange(3), -axis)[1:]
        order = np.array([axis, *across])
        moved = parted[axis].transpose(order)
        _part(np.ascontiguousarray(points[:, order]), mesh.faces, moved, _EDGE_SLACK)
    return Lattice(origin, pitch, parted)


@numba.njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _part(points: FloatArray, faces: IntArray, parted: BoolArray, slack: float) -> None:
    """Mark in `parted` (A, B, C) where faces cut the lines along the first axis; `points` in pitches."""
    last_a, last_b, last_c = parted.shape[0] - 2, parted.shape[1] - 1, parted.shape[2] - 1
    for face in range(len(faces)):
        p, q, r = points[faces[face, 0]], points[faces[face, 1]], points[faces[face, 2]]
        area = (q[1] - p[1]) * (r[2] - p[2]) - (q[2] - p[2]) * (r[1] - p[1])
        if area == 0.0:
            continue  # seen edge on: its neighbours part what it would
        b_from, b_to = max(np.ceil(min(p[1], q[1], r[1])), 0), min(np.floor(max(p[1], q[1], r[1])), last_b)
        c_from, c_to = max(np.ceil(min(p[2], q[2], r[2])), 0), min(np.floor(max(p[2], q[2], r[2])), last_c)
        for b in range(int(b_from), int(b_to) + 1):
            for c in range(int(c_from), int(c_to) + 1):
                u = ((q[1] - b) * (r[2] - c) - (q[2] - c) * (r[1] - b)) / area
                v = ((r[1] - b) * (p[2] - c) - (r[2] - c) * (p[1] - b)) / area
                w = 1 - u - v
                if u >= -slack and v >= -slack and w >= -slack:
                    a = int(np.floor(u * p[0] + v * q[0] + w * r[0]))
                    if 0 <= a <= last_a:
                        parted[a, b, c] = True


NEVER = -1
"""Spill layer of what water cannot reach, or that is taken."""


def spill_layers(lattice: Lattice, taken: BoolArray) -> IntArray:
    """Return (X, Y, Z) for each point the lowest layer over which it is joined to the outside.

    Water stands at a point when that layer is above its own: every way out leads higher. Outside is the
    border of the lattice, and all below the object: the table carries no water. Air caught under an overhang
    counts as water.

    Args:
        lattice: around the object.
        taken: (X, Y, Z) points at which nothing can be.
    """
    return _spill(lattice.parted, taken)  # type: ignore[no-any-return]  # numba hides it


@numba.njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _root(parent: IntArray, point: int) -> int:
    while parent[point] != point:
        parent[point] = parent[parent[point]]
        point = parent[point]
    return point


@numba.njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _neighbours(
    parted: BoolArray, taken: BoolArray, at: tuple[int, int, int], outside: int, found: IntArray
) -> int:
    """Write the points already reached that `at` is joined to into `found` and return how many."""
    i, j, k = at
    n_x, n_y, n_z = taken.shape
    point = (i * n_y + j) * n_z + k
    count = 0
    if min(i, j, k) == 0 or i == n_x - 1 or j == n_y - 1 or k == n_z - 1:
        found[count] = outside
        count += 1
    if i > 0 and not parted[0, i - 1, j, k] and not taken[i - 1, j, k]:
        found[count] = point - n_y * n_z
        count += 1
    if j > 0 and not parted[1, i, j - 1, k] and not taken[i, j - 1, k]:
        found[count] = point - n_z
        count += 1
    if k > 0 and not parted[2, i, j, k - 1] and not taken[i, j, k - 1]:
        found[count] = point - 1
        count += 1
    return count


@numba.njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _spill(parted: BoolArray, taken: BoolArray) -> IntArray:
    """Raise the water layer by layer, joining points (union-find); each group is a list that drains once."""
    n_x, n_y, n_z = taken.shape
    n = n_x * n_y * n_z
    parent, following, tail = np.arange(n + 1), np.full(n + 1, -1), np.arange(n + 1)
    spill, found = np.full(n, NEVER), np.empty(4, dtype=np.int64)
    for k, i, j in np.ndindex(n_z, n_x, n_y):
        if taken[i, j, k]:
            continue
        for index in range(_neighbours(parted, taken, (i, j, k), n, found)):
            one, other = _root(parent, (i * n_y + j) * n_z + k), _root(parent, found[index])
            if one == other:
                continue
            if one == n:  # the outside stays a root
                one, other = other, one
            parent[one] = other
            if other == n:
                while one >= 0:
                    spill[one] = k
                    one = following[one]
            else:
                following[tail[other]] = one
                tail[other] = tail[one]
    return spill.reshape(n_x, n_y, n_z)
