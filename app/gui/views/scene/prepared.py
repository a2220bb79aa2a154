"""A mesh as the graphics card takes it. Preparing is the slow part and may run in a thread."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.gui.views.scene.colors import ColorScale
from core.geometry import AnyArray

Float32Array = npt.NDArray[np.float32]
UInt32Array = npt.NDArray[np.uint32]


@dataclass(frozen=True)
class PreparedMesh:
    """Arrays to be drawn as they are.

    Attributes:
        vertices_m: (N, 3).
        normals: (N, 3) unit vectors, smooth; the shader makes creases sharp.
        faces: (F, 3) of vertex indices.
        edges: (E, 2) of vertex indices when it is a wire frame, otherwise None.
        values: (N,) what its colours stand for; NaN where nothing is known.
        scale: the colours of the values.
    """

    vertices_m: Float32Array
    normals: Float32Array
    faces: UInt32Array
    edges: UInt32Array | None = None
    values: Float32Array | None = None
    scale: ColorScale | None = None


def prepare_mesh(
    vertices_m: npt.ArrayLike,
    faces: npt.ArrayLike,
    *,
    values: npt.ArrayLike | None = None,
    scale: ColorScale | None = None,
    is_wireframe: bool = False,
) -> PreparedMesh:
    """Do what takes time before a mesh can be drawn: 200,000 faces take some 40 ms.

    Args:
        vertices_m: (N, 3).
        faces: (F, 3) of vertex indices.
        values: (N,) a number per vertex, shown by `scale`; NaN where nothing is known.
        scale: the colours of the values.
        is_wireframe: whether only its edges are to be drawn.
    """
    points = np.ascontiguousarray(vertices_m, dtype=np.float32).reshape(-1, 3)
    triangles = np.ascontiguousarray(faces, dtype=np.uint32).reshape(-1, 3)
    return PreparedMesh(
        vertices_m=points,
        normals=vertex_normals(points, triangles),
        faces=triangles,
        edges=_edges(triangles) if is_wireframe else None,
        values=None if values is None else np.asarray(values, dtype=np.float32),
        scale=scale,
    )


def vertex_normals(vertices_m: Float32Array, faces: UInt32Array) -> Float32Array:
    """Unit normals (N, 3) of the vertices, the adjacent faces' weighted by their area."""
    index = faces.astype(np.intp)
    a, b, c = (vertices_m[index[:, k]] for k in range(3))
    area = _cross(b - a, c - a)
    normals = np.empty((len(vertices_m), 3), dtype=np.float32)
    for axis in range(3):
        weights = area[:, axis]
        normals[:, axis] = sum(np.bincount(index[:, k], weights, minlength=len(vertices_m)) for k in range(3))
    length = np.sqrt(np.einsum("ij,ij->i", normals, normals))
    normals /= np.maximum(length, np.finfo(np.float32).tiny)[:, None]
    return normals


def _edges(faces: UInt32Array) -> UInt32Array:
    """Each edge (E, 2) once."""
    pairs = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1).astype(
        np.uint64
    )
    keys = np.unique(pairs[:, 0] << np.uint64(32) | pairs[:, 1])
    return np.column_stack([keys >> np.uint64(32), keys & np.uint64(0xFFFFFFFF)]).astype(np.uint32)


def _cross(u: AnyArray, v: AnyArray) -> AnyArray:
    """Cross product (N, 3); numpy's own takes twice as long."""
    product = np.empty_like(u)
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        product[:, k] = u[:, i] * v[:, j] - u[:, j] * v[:, i]
    return product
