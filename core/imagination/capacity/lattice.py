"""A lattice of points around a surface, and which neighbours the surface keeps apart.

No inside or outside is asked of the mesh: a face between two points parts them, however it is wound and
however thin the wall is. So open, self-crossing and wrongly wound meshes serve as well as closed ones.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from core.geometry import BoolArray, FloatArray, IntArray
from core.mesh import TriangleMesh

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
