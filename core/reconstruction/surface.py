"""From a grid of signed distances to a closed triangle mesh."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from skimage.measure import marching_cubes

from core.geometry import FloatArray
from core.mesh import TriangleMesh


def extract_surface(distance: npt.NDArray[np.float32], origin_m: FloatArray, voxel_m: float) -> TriangleMesh:
    """Zero surface of `distance` (X, Y, Z; positive outside) by Lewiner's marching cubes.

    A layer of free space around the grid closes what touches its border. Without a surface the mesh is empty.
    """
    padded = np.pad(distance, 1, constant_values=1.0)
    if not padded.min() < 0:
        return TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))
    vertices, faces, _, _ = marching_cubes(padded, level=0.0, method="lewiner")
    return TriangleMesh(origin_m + (vertices.astype(float) - 1.0) * voxel_m, faces.astype(np.int64))


def largest_piece(mesh: TriangleMesh) -> TriangleMesh:
    """The connected piece of the largest signed volume: no crumbs, no cavities (their volume is negative)."""
    n_vertices = len(mesh.vertices_m)
    edges = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]]])
    graph = coo_array(
        (np.ones(len(edges), dtype=np.int8), (edges[:, 0], edges[:, 1])), (n_vertices, n_vertices)
    )
    n_pieces, piece_of_vertex = connected_components(graph, directed=False)
    piece_of_face = piece_of_vertex[mesh.faces[:, 0]]
    a, b, c = (mesh.vertices_m[mesh.faces[:, k]] - mesh.vertices_m[0] for k in range(3))
    volumes = np.bincount(piece_of_face, np.einsum("ij,ij->i", a, np.cross(b, c)), minlength=n_pieces)
    best = int(np.argmax(volumes))
    kept = piece_of_vertex == best
    new_index = np.cumsum(kept) - 1
    return TriangleMesh(mesh.vertices_m[kept], new_index[mesh.faces[piece_of_face == best]])
