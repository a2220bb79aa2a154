"""How much of the object's surface the views saw."""

from __future__ import annotations

import numpy as np

from core.geometry import BoolArray, FloatArray, IntArray, invert_pose, transform_points
from core.mesh import TriangleMesh
from core.scan.model import RgbdFrame, Scan

TOLERANCE_M = 0.008
"""How far a measured depth may lie off a vertex that it shows: noise, pose error and the fusion's rounding. A
wall's other side is nearer than that, but it faces away."""
DOWNWARD = -0.2
"""Upward part of the normal below which a face looks down: all views come from above, none can see it."""


def count_views(mesh: TriangleMesh, scan: Scan) -> IntArray:
    """In how many views each vertex (V,) faces the camera and has the depth that was measured there."""
    normals = _vertex_normals(mesh)
    counts = np.zeros(len(mesh.vertices_m), dtype=np.int64)
    for frame in scan.frames:
        counts += _seen_in(frame, scan, mesh.vertices_m, normals)
    return counts


def unseen_share(mesh: TriangleMesh, n_views: IntArray) -> float:
    """Share of the area, but of faces that look down, none of whose corners any view saw (`n_views` (V,))."""
    crosses = _face_crosses(mesh)
    areas = np.linalg.norm(crosses, axis=1)
    counted = crosses[:, 2] > DOWNWARD * areas
    unseen = (n_views[mesh.faces] == 0).all(axis=1)
    total = areas[counted].sum()
    return float(areas[counted & unseen].sum() / total) if total > 0 else 0.0


def _seen_in(frame: RgbdFrame, scan: Scan, points_m: FloatArray, normals: FloatArray) -> BoolArray:
    height, width = frame.depth_m.shape
    x, y, z = transform_points(invert_pose(frame.T_base_camera), points_m).T
    before = z > 0
    safe_z = np.where(before, z, 1.0)
    column = np.round(scan.intrinsics.fx * x / safe_z + scan.intrinsics.cx)
    row = np.round(scan.intrinsics.fy * y / safe_z + scan.intrinsics.cy)
    inside = before & (column >= 0) & (column < width) & (row >= 0) & (row < height)
    measured = np.zeros(len(points_m))
    measured[inside] = frame.depth_m[row[inside].astype(int), column[inside].astype(int)]
    faces_camera = np.einsum("ij,ij->i", normals, frame.T_base_camera[:3, 3] - points_m) > 0
    seen: BoolArray = (measured > 0) & (np.abs(measured - z) < TOLERANCE_M) & faces_camera
    return seen


def _face_crosses(mesh: TriangleMesh) -> FloatArray:
    a, b, c = (mesh.vertices_m[mesh.faces[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def _vertex_normals(mesh: TriangleMesh) -> FloatArray:
    """Sums (V, 3) of the normals of the faces around, weighted by area; only their direction matters here."""
    normals = np.zeros_like(mesh.vertices_m)
    crosses = _face_crosses(mesh)
    for corner in range(3):
        np.add.at(normals, mesh.faces[:, corner], crosses)
    return normals
