"""The stage: from a mesh to a collision model."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from core.collision.model import GIVEN, CollisionModel
from core.errors import StageError
from core.geometry import FloatArray
from core.mesh import SurfaceDistance, TriangleMesh
from core.mesh_file import read_mesh, read_mesh_parts
from core.mesh_topology import is_convex, join, topology
from core.parameters.reconstruction import CollisionParameters
from core.progress import Reporter
from core.quiet import quiet

STAGE = "collision"
DECOMPOSITION_MAX_FACES = 2000
"""Convex parts get no better from more faces, and CoACD takes minutes."""
MAX_MEAN_DEVIATION_M = 0.0005
MAX_USUAL_DEVIATION_M = 0.0012
"""Of 99 % of the vertices; decision 0002."""
_QUADRIC_MAX_FACES = 200_000
"""Quadric decimation takes 13 us a face (2.4 s here); above, vertices are first clustered in a fine grid."""
_RELENT = 1.5
_FINE = 10
"""Times the wanted faces are kept at first: a second try begins there, and costs a tenth of the first."""
_MOST = 4
"""Times the wanted faces that nearness alone is worth: Bullet's time grows with them."""
_N_SAMPLES = 20_000


def build_collision_model(
    mesh: TriangleMesh,
    parameters: CollisionParameters,
    reporter: Reporter,
) -> CollisionModel:
    """Make a body for the physics out of a mesh in metres; same arguments, same result.

    Raises:
        StageError: the decomposition found no part.
        Cancelled: somebody asked to stop.
    """
    reporter.progress(STAGE, 0, 1)
    reporter.raise_if_cancelled()
    surface = simplify(mesh, parameters.max_faces)
    if parameters.method == "exact":
        model = CollisionModel.exact(surface)
    else:
        model = CollisionModel(parameters.method, _decompose(surface, parameters, reporter), surface)
    reporter.progress(STAGE, 1, 1)
    return model


def from_parts(parts: tuple[TriangleMesh, ...]) -> CollisionModel:
    """Take convex parts as they are, such as the authors' own decomposition."""
    return CollisionModel(GIVEN, parts, join(parts))


def read_collision_model(path: Path, parameters: CollisionParameters, reporter: Reporter) -> CollisionModel:
    """Build from a mesh file; if its parts are several and all convex, they are the decomposition already.

    Raises:
        InputError: the file cannot be used.
        StageError: the decomposition found no part.
    """
    parts = read_mesh_parts(path, reporter)
    if len(parts) > 1 and all(map(is_convex, parts)):
        return from_parts(parts)
    return build_collision_model(read_mesh(path, reporter), parameters, reporter)


def _decompose(
    surface: TriangleMesh, parameters: CollisionParameters, reporter: Reporter
) -> tuple[TriangleMesh, ...]:
    method = parameters.method
    coarse = simplify(surface, DECOMPOSITION_MAX_FACES)
    n_open = topology(coarse).n_open
    if n_open:
        reporter.warn(
            f"The mesh is not closed ({n_open} open edges), so {method} may fill its cavity; "
            "collision.method=exact does not."
        )
    parts = _DECOMPOSE[method](coarse, parameters)
    if not parts:
        raise StageError(
            f"{method} found no convex part in a mesh of {len(coarse.faces)} faces; "
            "use collision.method=exact."
        )
    return parts


def simplify(mesh: TriangleMesh, max_faces: int) -> TriangleMesh:
    """Reduce a mesh to `max_faces` by quadric error (Garland and Heckbert 1997); closed stays closed.

    A mesh of no more faces is returned as it is. Where decimation runs out of faces that it may remove
    without turning others round, it ruins the shape in search of more (a teapot lost its lower 17 mm): if the
    mesh's vertices end up more than 0.5 mm from the new surface on average, more faces are kept. Up to four
    times as many are, too, where one vertex in a hundred is more than 1.2 mm from it: thin walls suffer, and
    their pinholes grow, before the average tells. A rough surface never gets there, and needs not.
    """
    fine = _finely_decimated(mesh, _FINE * max_faces)
    n_faces = max_faces
    while n_faces < len(fine.faces):
        coarse = _decimated(fine, n_faces)
        distances_m = _distances_m(mesh, coarse)
        n_faces = int(n_faces * _RELENT)
        is_near = n_faces > _MOST * max_faces or np.percentile(distances_m, 99) <= MAX_USUAL_DEVIATION_M
        if is_near and distances_m.mean() <= MAX_MEAN_DEVIATION_M:
            return coarse
    return fine


def _finely_decimated(mesh: TriangleMesh, n_faces: int) -> TriangleMesh:
    """Reduce a mesh as far as its shape is hardly touched; clustering first is quicker, where it serves.

    Where it closes a thin wall the shape is lost, or no face may be removed any more.
    """
    if len(mesh.faces) > _QUADRIC_MAX_FACES:
        fine = _decimated(_clustered(mesh, _QUADRIC_MAX_FACES), n_faces)
        if len(fine.faces) < 2 * n_faces and _distances_m(mesh, fine).mean() <= MAX_MEAN_DEVIATION_M:
            return fine
    return _decimated(mesh, n_faces)


def _clustered(mesh: TriangleMesh, n_faces: int) -> TriangleMesh:
    """Merge vertices in a grid of which a flat surface gets so many faces; walls thinner than it close up."""
    body = _to_open3d(mesh)
    # A flat grid of cells c has 2 / c^2 faces on each unit of area.
    return _from_open3d(body.simplify_vertex_clustering(np.sqrt(2 * body.get_surface_area() / n_faces)))


def _decimated(mesh: TriangleMesh, n_faces: int) -> TriangleMesh:
    if len(mesh.faces) <= n_faces:
        return mesh
    body = _to_open3d(mesh).simplify_quadric_decimation(n_faces)
    return _from_open3d(body.remove_degenerate_triangles().remove_unreferenced_vertices())


def _to_open3d(mesh: TriangleMesh) -> Any:
    import open3d as o3d

    vertices, faces = mesh.vertices_m, mesh.faces.astype(np.int32)
    return o3d.geometry.TriangleMesh(o3d.utility.Vector3dVector(vertices), o3d.utility.Vector3iVector(faces))


def _from_open3d(body: Any) -> TriangleMesh:
    return TriangleMesh(np.array(body.vertices, dtype=float), np.array(body.triangles, dtype=np.int64))


def _distances_m(mesh: TriangleMesh, coarse: TriangleMesh) -> FloatArray:
    """How far (a sample of) the vertices of `mesh` are from `coarse`; crumbs may well vanish."""
    if coarse is mesh:
        return np.zeros(1)
    if not len(coarse.faces):
        return np.full(1, np.inf)
    samples = mesh.vertices_m[:: 1 + len(mesh.vertices_m) // _N_SAMPLES]
    return np.asarray(SurfaceDistance(coarse).of_m(samples), dtype=float)


def _coacd(mesh: TriangleMesh, parameters: CollisionParameters) -> tuple[TriangleMesh, ...]:
    """Decompose a closed mesh with CoACD (Wei et al., SIGGRAPH 2022).

    Its own voxel preprocessing stays off, because it thickens walls and costs most.

    The concavity threshold is CoACD's normalised one, not the one in metres. A small search suffices: it
    takes 1 to 8 s on most household objects.
    """
    import coacd

    with quiet(1):
        coacd.set_log_level("off")
        hulls = coacd.run_coacd(
            coacd.Mesh(mesh.vertices_m, mesh.faces),
            threshold=parameters.coacd_threshold,
            preprocess_mode="off",
            resolution=500,
            mcts_nodes=8,
            mcts_iterations=30,
            mcts_max_depth=2,
            seed=0,
        )
    return _as_meshes(hulls)


def _vhacd(mesh: TriangleMesh, parameters: CollisionParameters) -> tuple[TriangleMesh, ...]:
    """Decompose a mesh with V-HACD (Mamou), the paper's method (Sec. IV-C).

    The parts' order and coordinates depend on nothing but the arguments.
    """
    import vhacdx

    # Faces are one flat row in which each is led by its number of corners, as the library wants it.
    faces = np.insert(mesh.faces, 0, 3, axis=1).astype(np.uint32).ravel()
    with quiet(1):
        hulls = vhacdx.compute_vhacd(
            mesh.vertices_m,
            faces,
            maxConvexHulls=parameters.vhacd_hulls,
            resolution=parameters.vhacd_voxels,
            asyncACD=False,
        )
    return _as_meshes(hulls)


def _as_meshes(hulls: Iterable[tuple[Any, Any]]) -> tuple[TriangleMesh, ...]:
    return tuple(TriangleMesh(np.array(v, dtype=float), np.array(f, dtype=np.int64)) for v, f in hulls)


_DECOMPOSE = {"vhacd": _vhacd, "coacd": _coacd}
