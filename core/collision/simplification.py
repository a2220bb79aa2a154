"""Fewer faces for the physics, within a bound on how far they lie from the surface (decision 0002)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from core.collision.hollows import Hollows
from core.mesh import SurfaceDistance, TriangleMesh
from core.mesh_topology import topology

MAX_MEAN_DEVIATION_M = 0.0005
MAX_USUAL_DEVIATION_M = 0.0012
"""Of 99 % of the vertices; decision 0002."""
_RELENT = 1.5
_FINE = 10
"""Times the wanted faces are kept at first: a second try begins there, and costs a tenth of the first."""
_AGGRESSIVENESS = 3
"""How fast the first step's error may grow from pass to pass; with less more faces are left than wanted."""
_MOST = 4
"""Times the wanted faces that nearness alone is worth: Bullet's time grows with them."""
_N_SAMPLES = 20_000
_LEAST_EULER = -2
"""Of a closed surface with two handles; one with less has gaps, or is a sieve."""


def simplify(mesh: TriangleMesh, max_faces: int) -> TriangleMesh:
    """Reduce a mesh to `max_faces` by quadric error (Garland and Heckbert 1997); no hole comes into it.

    A mesh of no more faces is returned as it is. Where decimation runs out of faces that it may remove
    without turning others round, it ruins the shape in search of more (a teapot lost its lower 17 mm): if the
    mesh's vertices end up more than 0.5 mm from the new surface on average, more faces are kept. Up to four
    times as many are, too, where one vertex in a hundred is more than 1.2 mm from it: thin walls suffer, and
    their pinholes grow, before the average tells. A rough surface never gets there, and needs not.
    As many more as it takes are kept where a gap in a thin wall would grow until the surface no longer holds
    what it held (decision 0060). The two sides of a thin wall may meet in an edge of four faces.
    """
    fine = simplify_finely(mesh, max_faces)
    if len(fine.faces) <= max_faces:
        return fine
    # What has a handle or two has no gap that could grow.
    held = Hollows.of(fine) if topology(fine).euler < _LEAST_EULER else None

    def serves(coarse: TriangleMesh, n_faces: int) -> bool:
        deviation = _deviation(mesh, coarse)
        is_near = deviation.is_near or (deviation.is_in_shape and n_faces * _RELENT > _MOST * max_faces)
        return is_near and (held is None or held.are_kept_by(coarse))

    return _decimated(fine, max_faces, serves)


def simplify_finely(mesh: TriangleMesh, max_faces: int) -> TriangleMesh:
    """Reduce a mesh to ten times `max_faces`, where its shape is hardly touched (0.02 mm): the first step.

    Ten times as fast as Open3D, and enough where not much physics follows. Not further: with fewer faces
    pinholes in thin walls grow more than with Open3D's (decision 0050). Where the quick way loses the shape,
    as of faces that share no vertices, Open3D goes all of it.
    """
    from fast_simplification import simplify as decimate

    n_faces = _FINE * max_faces
    if len(mesh.faces) <= n_faces:
        return mesh
    vertices, faces = decimate(
        mesh.vertices_m, mesh.faces.astype(np.int32), target_count=n_faces, agg=_AGGRESSIVENESS
    )
    fine = TriangleMesh(np.array(vertices, dtype=float), np.array(faces, dtype=np.int64))
    if _deviation(mesh, fine).is_near:
        return fine
    return _decimated(mesh, n_faces, lambda coarse, _: _deviation(mesh, coarse).is_in_shape)


def _decimated(mesh: TriangleMesh, n_faces: int, serves: Callable[[TriangleMesh, int], bool]) -> TriangleMesh:
    """Return the mesh with so many faces, or with as many more as it takes to serve."""
    while n_faces < len(mesh.faces):
        coarse = _with_faces(mesh, n_faces)
        if serves(coarse, n_faces):
            return coarse
        n_faces = int(n_faces * _RELENT)
    return mesh


def _with_faces(mesh: TriangleMesh, n_faces: int) -> TriangleMesh:
    body = _to_open3d(mesh).simplify_quadric_decimation(n_faces)
    return _from_open3d(body.remove_degenerate_triangles().remove_unreferenced_vertices())


def _to_open3d(mesh: TriangleMesh) -> Any:
    import open3d as o3d

    vertices, faces = mesh.vertices_m, mesh.faces.astype(np.int32)
    return o3d.geometry.TriangleMesh(o3d.utility.Vector3dVector(vertices), o3d.utility.Vector3iVector(faces))


def _from_open3d(body: Any) -> TriangleMesh:
    return TriangleMesh(np.array(body.vertices, dtype=float), np.array(body.triangles, dtype=np.int64))


class _Deviation(NamedTuple):
    """How far a surface lies from the vertices of what it simplifies, in metres."""

    mean_m: float
    usual_m: float

    @property
    def is_in_shape(self) -> bool:
        return self.mean_m <= MAX_MEAN_DEVIATION_M

    @property
    def is_near(self) -> bool:
        return self.is_in_shape and self.usual_m <= MAX_USUAL_DEVIATION_M


def _deviation(mesh: TriangleMesh, coarse: TriangleMesh) -> _Deviation:
    """Measure it at (a sample of) the vertices of `mesh`; crumbs may well vanish."""
    if not len(coarse.faces):
        return _Deviation(np.inf, np.inf)
    samples = mesh.vertices_m[:: 1 + len(mesh.vertices_m) // _N_SAMPLES]
    distances_m = SurfaceDistance(coarse).of_m(samples)
    return _Deviation(float(distances_m.mean()), float(np.percentile(distances_m, 99)))
