"""How the faces of a mesh hang together: joined vertices, open and crowded edges, convexity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry import AnyArray, BoolArray
from core.mesh import TriangleMesh

SMALLEST_AREA_M2 = 1e-16
"""Faces below it have no normal. Not more: dropping the thin ones of marching cubes would tear holes."""
CONVEX_SHARE = 0.99
"""Share of its hull's volume that a convex part fills at least; coordinates in files are rounded."""


@dataclass(frozen=True)
class Topology:
    """Counts over the undirected edges of a mesh whose equal vertices are joined.

    Attributes:
        n_edges: all edges.
        n_open: edges of one face only: the border of a hole.
        n_crowded: edges of more than two faces: what makes a mesh non-manifold.
        is_consistent: no two neighbouring faces are wound against each other.
        euler: vertices less edges plus faces: 2 of a closed surface in one piece, and two less for each
            handle, hole through it, or pinhole in its wall.
    """

    n_edges: int
    n_open: int
    n_crowded: int
    is_consistent: bool
    euler: int

    @property
    def is_closed(self) -> bool:
        """Whether the faces enclose a volume: each edge belongs to exactly two."""
        return self.n_open == 0 and self.n_crowded == 0


def topology(mesh: TriangleMesh) -> Topology:
    """Count the edges of a mesh; sorts 64-bit keys, two million faces take a second."""
    start, end = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
    n = len(mesh.vertices_m)
    undirected = np.minimum(start, end) * n + np.maximum(start, end)
    keys, shared_by = np.unique(undirected, return_counts=True)
    # Walked along twice in one direction means that two faces at it are turned different ways. At a crowded
    # edge that is no fault.
    directed, walks = np.unique(start * n + end, return_counts=True)
    twice = directed[walks > 1]
    twice_keys = np.minimum(twice // n, twice % n) * n + np.maximum(twice // n, twice % n)
    return Topology(
        n_edges=len(keys),
        n_open=int((shared_by == 1).sum()),
        n_crowded=int((shared_by > 2).sum()),
        is_consistent=not np.isin(twice_keys, keys[shared_by == 2]).any(),
        euler=int(np.count_nonzero(np.bincount(mesh.faces.ravel()))) - len(keys) + len(mesh.faces),
    )


def weld(mesh: TriangleMesh) -> TriangleMesh:
    """Join equal vertices (STL repeats each for every face), drop faces without area and unused vertices."""
    import trimesh

    welded = trimesh.Trimesh(mesh.vertices_m, mesh.faces, process=False)
    welded.merge_vertices()
    vertices, faces = np.asarray(welded.vertices, dtype=float), np.asarray(welded.faces, dtype=np.int64)
    return _keep_faces(vertices, faces, _has_area(vertices, faces))


def join(parts: tuple[TriangleMesh, ...]) -> TriangleMesh:
    """Put meshes into one, their vertices left apart."""
    starts = np.cumsum([0, *(len(part.vertices_m) for part in parts)])
    return TriangleMesh(
        np.concatenate([part.vertices_m for part in parts]),
        np.concatenate([part.faces + start for part, start in zip(parts, starts[:-1], strict=True)]),
    )


def is_convex(mesh: TriangleMesh) -> bool:
    """Whether a mesh is closed and fills its convex hull, up to the rounding of its file."""
    if not topology(mesh).is_closed:
        return False
    hull_m3 = hull_volume_m3(mesh)
    return hull_m3 > 0 and mesh.volume_m3 >= CONVEX_SHARE * hull_m3


def hull_volume_m3(mesh: TriangleMesh) -> float:
    """Return the volume of a mesh's convex hull; zero if it is flat."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return float(ConvexHull(mesh.vertices_m).volume)
    except (QhullError, ValueError):  # flat, or too few vertices
        return 0.0


def _has_area(vertices_m: AnyArray, faces: AnyArray) -> BoolArray:
    a, b, c = (vertices_m[faces[:, k]] for k in range(3))
    has_area: BoolArray = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2 > SMALLEST_AREA_M2
    return has_area


def _keep_faces(vertices_m: AnyArray, faces: AnyArray, keep: BoolArray) -> TriangleMesh:
    used, renumbered = np.unique(faces[keep], return_inverse=True)
    return TriangleMesh(vertices_m[used], renumbered.reshape(-1, 3).astype(np.int64))
