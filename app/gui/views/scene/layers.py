"""Layers from what pages have: meshes, lines, points, arrows, labels."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.gui.views.scene.parts import Layer, Paint, Part
from app.gui.views.scene.picking import BallTarget, FaceTarget
from app.gui.views.scene.prepared import Float32Array, PreparedMesh, prepare_mesh
from app.gui.views.scene.shapes import arrow_mesh


def mesh_layer(mesh: PreparedMesh, color: str, opacity: float) -> Layer:
    """A mesh as a surface, or as a wire frame."""
    paint = Paint((color,), values=mesh.values, scale=mesh.scale, opacity=opacity)
    if mesh.edges is None:
        part = Part("surface", mesh.vertices_m, paint, mesh.normals, mesh.faces.ravel())
    else:
        part = Part("lines", mesh.vertices_m, paint, indices=mesh.edges.ravel())
    return Layer((part,), FaceTarget(mesh.vertices_m, mesh.faces))


def line_layer(points_m: npt.ArrayLike, color: str, width_px: float) -> Layer:
    """A line through points (N, 3)."""
    points = _points(points_m)
    k = np.arange(max(len(points) - 1, 0), dtype=np.uint32)
    segments = np.column_stack([k, k + 1]).ravel().astype(np.uint32)
    return Layer((Part("lines", points, Paint((color,)), indices=segments, size_px=width_px),))


def points_layer(points_m: npt.ArrayLike, color: str, size_px: float) -> Layer:
    """Points (N, 3) of a size on the screen."""
    points = _points(points_m)
    part = Part("points", points, Paint((color,)), size_px=size_px)
    return Layer((part,), BallTarget(points.astype(float)))


def arrow_layer(start_m: npt.ArrayLike, end_m: npt.ArrayLike, color: str) -> Layer:
    """An arrow between two points (3,)."""
    mesh = prepare_mesh(*arrow_mesh(start_m, end_m))
    return Layer((Part("surface", mesh.vertices_m, Paint((color,)), mesh.normals, mesh.faces.ravel()),))


def label_layer(point_m: npt.ArrayLike, text: str) -> Layer:
    """Words beside a point (3,)."""
    return Layer((Part("points", _points(point_m), Paint(("text",)), size_px=5, is_on_top=True),), text=text)


def _points(points_m: npt.ArrayLike) -> Float32Array:
    return np.array(points_m, dtype=np.float32).reshape(-1, 3)
