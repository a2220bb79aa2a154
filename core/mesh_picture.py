"""A shaded picture of a mesh without OpenGL: far faces first, each as bright as it faces the light."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw

from core.geometry import FloatArray
from core.mesh import TriangleMesh

_BACKGROUND = (242, 243, 239)
_BODY = np.array([200.0, 190.0, 176.0])
_CANDY, _CANDY_EDGE = (46, 125, 80), (20, 66, 40)
_PHOTO_GAIN = 1.25
"""Photographed colours hold their shadows already."""
_MARGIN = 0.1
_SUPERSAMPLING = 2
_TO_EYE = np.array([0.55, -0.95, 0.85])
_TO_LIGHT = np.array([-0.35, -0.75, 1.2])


def shaded_picture(
    mesh: TriangleMesh,
    size_px: tuple[int, int],
    candies_m: FloatArray | None = None,
    candy_radius_m: float = 0.0,
    rgb: npt.NDArray[np.uint8] | None = None,
) -> Image.Image:
    """Return a mesh (z up) seen obliquely from above, in parallel projection; 100,000 faces take a second.

    Args:
        mesh: the mesh.
        size_px: width and height.
        candies_m: (N, 3) centres of candies that lie on it, drawn as discs; none: without.
        candy_radius_m: their radius.
        rgb: (V, 3) colour of each vertex; none: all are of the colour of clay.
    """
    width, height = (_SUPERSAMPLING * length for length in size_px)
    picture = Image.new("RGB", (width, height), _BACKGROUND)
    draw = ImageDraw.Draw(picture)
    right, up, to_eye = _axes()
    to_picture = np.column_stack([right, -up])
    fit = _Fit.of(mesh.vertices_m @ to_picture, width, height)
    corners = fit.px(mesh.vertices_m @ to_picture)[mesh.faces]
    normals = _normals(mesh) if rgb is None else _smooth_normals(mesh)
    brightness = 0.35 + 0.65 * np.abs(normals @ (_TO_LIGHT / np.linalg.norm(_TO_LIGHT)))
    body = _BODY if rgb is None else _PHOTO_GAIN * rgb[mesh.faces].mean(axis=1)
    colors = np.minimum(brightness[:, None] * body, 255).astype(int)
    depths = (mesh.vertices_m @ to_eye)[mesh.faces].mean(axis=1)
    candies = np.zeros((0, 3)) if candies_m is None else candies_m
    discs = fit.px(candies @ to_picture)
    radius = candy_radius_m * fit.scale
    # A candy lies on what is beneath it: half its size nearer to the eye it is not hidden by that.
    for item in np.argsort(np.concatenate([depths, candies @ to_eye + candy_radius_m]), kind="stable"):
        if item < len(depths):
            draw.polygon(corners[item].ravel().tolist(), fill=tuple(colors[item].tolist()))
        else:
            x, y = discs[item - len(depths)]
            draw.ellipse(_around(x, y, radius), fill=_CANDY, outline=_CANDY_EDGE, width=_SUPERSAMPLING)
    for x, y in discs:  # what lies behind a wall shows through it as a ring
        draw.ellipse(_around(x, y, radius), outline=_CANDY_EDGE, width=_SUPERSAMPLING)
    return picture.resize(size_px, Image.Resampling.LANCZOS)


def _axes() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the picture's axes to the right, upwards and to the eye, as unit vectors (3,)."""
    to_eye = _TO_EYE / np.linalg.norm(_TO_EYE)
    right = np.cross([0.0, 0.0, 1.0], to_eye)
    right /= np.linalg.norm(right)
    return right, np.cross(to_eye, right), to_eye


def _around(x: float, y: float, radius: float) -> tuple[float, float, float, float]:
    return x - radius, y - radius, x + radius, y + radius


@dataclass(frozen=True)
class _Fit:
    """Scales points (V, 2) so that some of them fill the picture but for a margin, in its middle."""

    middle_m: FloatArray
    scale: float
    center_px: FloatArray

    @classmethod
    def of(cls, points_m: FloatArray, width: int, height: int) -> _Fit:
        low, high = points_m.min(axis=0), points_m.max(axis=0)
        available_px = (1 - 2 * _MARGIN) * np.array([width, height])
        scale = float((available_px / np.maximum(high - low, 1e-9)).min())
        return cls((low + high) / 2, scale, np.array([width, height]) / 2)

    def px(self, points_m: FloatArray) -> FloatArray:
        found: FloatArray = (points_m - self.middle_m) * self.scale + self.center_px
        return found


def _normals(mesh: TriangleMesh) -> FloatArray:
    a, b, c = (mesh.vertices_m[mesh.faces[:, k]] for k in range(3))
    normals: FloatArray = np.cross(b - a, c - a)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    return normals


def _smooth_normals(mesh: TriangleMesh) -> FloatArray:
    """(F, 3) of the corners' surroundings: a scan's faces are small, and rough by the camera's noise."""
    normals, at_vertices = _normals(mesh), np.zeros_like(mesh.vertices_m)
    for corner in range(3):
        np.add.at(at_vertices, mesh.faces[:, corner], normals)
    smooth: FloatArray = at_vertices[mesh.faces].sum(axis=1)
    smooth /= np.maximum(np.linalg.norm(smooth, axis=1, keepdims=True), 1e-30)
    return smooth
