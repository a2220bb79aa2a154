"""Convex parts by CoACD (Wei et al., SIGGRAPH 2022)."""

from __future__ import annotations

import numpy as np

from core.mesh import TriangleMesh
from core.parameters.reconstruction import CollisionParameters
from core.quiet import quiet


def coacd(mesh: TriangleMesh, parameters: CollisionParameters) -> tuple[TriangleMesh, ...]:
    """Decompose a closed mesh; its own voxel preprocessing stays off, for it thickens walls and costs most.

    The concavity threshold is CoACD's normalised one, not the one in metres. A small search suffices: it
    takes 1 to 8 s on most household objects.
    """
    import coacd as library

    with quiet(1):
        library.set_log_level("off")
        hulls = library.run_coacd(
            library.Mesh(mesh.vertices_m, mesh.faces),
            threshold=parameters.coacd_threshold,
            preprocess_mode="off",
            resolution=500,
            mcts_nodes=8,
            mcts_iterations=30,
            mcts_max_depth=2,
            seed=0,
        )
    return tuple(TriangleMesh(np.array(v, dtype=float), np.array(f, dtype=np.int64)) for v, f in hulls)
