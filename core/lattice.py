"""A lattice of points around a mesh at rest: which of them faces part, and what is held where.

Loads numba; not for the window.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from core.geometry import BoolArray, FloatArray, IntArray
from core.mesh import TriangleMesh

FLATNESS = 0.5
"""Pitch along z relative to that across: a rim's height decides more than a wall's place."""
_FINEST_M = 0.0005
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


def lattice_of(mesh: TriangleMesh, points: int, thickness_m: float) -> Lattice:
    """Lay a lattice of about so many points around a mesh, with room for something so thick above it."""
    pitch_m = _pitch_m(mesh, points)
    return lattice_around(mesh, pitch_m, FLATNESS * pitch_m, thickness_m)


def _pitch_m(mesh: TriangleMesh, points: int) -> float:
    """Return the pitch across of a lattice of about so many points."""
    pitch: float = (float(np.prod(mesh.extents_m)) / FLATNESS / points) ** (1 / 3)
    return max(pitch, _FINEST_M)


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


def held_centers(lattice: Lattice, radius_m: float) -> tuple[BoolArray, IntArray]:
    """Return (X, Y, Z) where the centre of a ball is held, and the layers over which it would run.

    It is held where every way out leads higher; a notch or crack narrower than the ball is closed to it.
    """
    from scipy.ndimage import distance_transform_edt

    beside = lattice.beside_surface()
    taken = distance_transform_edt(~beside, sampling=lattice.pitch_m.tolist()) < radius_m
    spill = spill_layers(lattice, taken)
    held: BoolArray = (spill > np.arange(lattice.shape[2])) & ~taken
    return held, spill


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
