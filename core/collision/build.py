"""The stage: from a mesh to a collision model."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from core.collision.model import GIVEN, CollisionModel
from core.collision.simplification import simplify
from core.errors import StageError
from core.mesh import TriangleMesh
from core.mesh_file import read_mesh, read_mesh_parts
from core.mesh_topology import is_convex, join, topology
from core.parameters.reconstruction import CollisionParameters
from core.progress import Reporter
from core.quiet import quiet

STAGE = "collision"
DECOMPOSITION_MAX_FACES = 2000
"""Convex parts get no better from more faces, and CoACD takes minutes."""


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
