"""Convex parts by V-HACD (Mamou), the paper's method (Sec. IV-C)."""

from __future__ import annotations

import numpy as np

from core.mesh import TriangleMesh
from core.parameters.reconstruction import CollisionParameters
from core.quiet import quiet


def vhacd(mesh: TriangleMesh, parameters: CollisionParameters) -> tuple[TriangleMesh, ...]:
    """Decompose a mesh; the parts' order and coordinates depend on nothing but the arguments."""
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
    return tuple(TriangleMesh(np.array(v, dtype=float), np.array(f, dtype=np.int64)) for v, f in hulls)
