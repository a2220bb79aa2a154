"""How far one result lies off another: what a changed parameter did to the surface."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

from core.geometry import FloatArray
from core.mesh import TriangleMesh

_RAYS = 3
"""By whose majority inside is told from outside: one may graze an edge."""


def surface_difference_m(before: TriangleMesh, after: TriangleMesh) -> FloatArray:
    """Return how far each vertex (V,) of `after` lies off the surface of `before`: positive outside of it.

    Both are closed, in one frame. Call it in a worker: Open3D takes a second to load.
    """
    o3d: Any = import_module("open3d")  # as Any: its stubs do not know numpy's arrays
    scene = o3d.t.geometry.RaycastingScene()
    tensor = o3d.core.Tensor
    scene.add_triangles(tensor(before.vertices_m.astype(np.float32)), tensor(before.faces.astype(np.uint32)))
    points = tensor(after.vertices_m.astype(np.float32))
    distances: FloatArray = scene.compute_signed_distance(points, nsamples=_RAYS).numpy().astype(float)
    return distances
