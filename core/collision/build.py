"""The stage: from a mesh to a collision model."""

from __future__ import annotations

from pathlib import Path

from core.collision.coacd import coacd
from core.collision.model import GIVEN, CollisionModel
from core.collision.simplify import simplify
from core.collision.vhacd import vhacd
from core.errors import StageError
from core.mesh import TriangleMesh
from core.mesh_file import read_mesh, read_mesh_parts
from core.mesh_topology import is_convex, join, topology
from core.parameters.reconstruction import CollisionParameters
from core.progress import Reporter

STAGE = "collision"
DECOMPOSITION_MAX_FACES = 2000
"""Convex parts get no better from more faces, and CoACD takes minutes."""
_DECOMPOSE = {"vhacd": vhacd, "coacd": coacd}


def build_collision_model(
    mesh: TriangleMesh, parameters: CollisionParameters, reporter: Reporter
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
        model = CollisionModel("exact", (surface,), surface)
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
