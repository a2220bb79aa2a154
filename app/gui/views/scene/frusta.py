"""The camera's views as small pyramids; their state is told by shape as well as by colour."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from app.gui.views.scene.parts import Layer, Paint, Part
from app.gui.views.scene.picking import FaceTarget
from core.geometry import FloatArray, transform_points

_DEPTH_M = 0.05
_HALF_WIDTH_M, _HALF_HEIGHT_M = 0.028, 0.021
_COLORS = ("muted", "good", "attention", "failed", "accent")
_STATES = {"pending": 0, "taken": 1, "poor": 2, "failed": 3}
_SELECTED = 4
_RIM = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * (_HALF_WIDTH_M, _HALF_HEIGHT_M)
_CORNERS = np.vstack([np.zeros(3), np.column_stack([_RIM, np.full(4, _DEPTH_M)])])
_SIDES = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1], [1, 3, 2], [1, 4, 3]])
_EDGES = np.array([[0, 1], [0, 2], [0, 3], [0, 4], [1, 2], [2, 3], [3, 4], [4, 1]])
_CROSS = np.array([[1, 3], [2, 4]])
_BAR = np.array([[1, 3]])


@dataclass(frozen=True, eq=False)
class Frustum:
    """A view of the camera.

    Attributes:
        name: of the frame, shown nowhere but told by those who ask.
        T_base_camera: (4, 4) pose of the optical frame: z forward, y down.
        state: `pending` is an outline, `taken` filled, `poor` filled with a bar, `failed` an outline with a
            cross.
        is_selected: whether it stands out.
    """

    name: str
    T_base_camera: FloatArray
    state: Literal["pending", "taken", "poor", "failed"] = "pending"
    is_selected: bool = False


def frusta_layer(frusta: Sequence[Frustum]) -> Layer:
    """All frusta as one surface and two sets of lines; the index of a hit is the frustum's."""
    if not frusta:
        return Layer(())
    corners = [transform_points(frustum.T_base_camera, _CORNERS) for frustum in frusta]
    filled = [k for k, frustum in enumerate(frusta) if frustum.state in ("taken", "poor")]
    parts = [_lines(frusta, corners, is_selected) for is_selected in (False, True)]
    if filled:
        parts.append(_surface([frusta[k] for k in filled], [corners[k] for k in filled]))
    faces = np.vstack([_SIDES + 5 * k for k in range(len(frusta))])
    element = np.repeat(np.arange(len(frusta)), len(_SIDES))
    return Layer(
        tuple(part for part in parts if len(part.vertices_m)), FaceTarget(np.vstack(corners), faces, element)
    )


def _lines(frusta: Sequence[Frustum], corners: Sequence[FloatArray], is_selected: bool) -> Part:
    """Outlines of the selected ones or of the others."""
    points, which = [np.empty((0, 3))], [np.empty(0, dtype=np.uint8)]
    for frustum, own in zip(frusta, corners, strict=True):
        if frustum.is_selected == is_selected:
            points.append(own[_segments(frustum).ravel()])
            color = _SELECTED if is_selected else _STATES[frustum.state]
            which.append(np.full(len(points[-1]), color, dtype=np.uint8))
    paint = Paint(_COLORS, which=np.concatenate(which))
    width = 3.5 if is_selected else 1.5
    return Part("lines", np.vstack(points).astype(np.float32), paint, size_px=width)


def _segments(frustum: Frustum) -> FloatArray:
    marks = {"failed": _CROSS, "poor": _BAR}.get(frustum.state)
    return _EDGES if marks is None else np.vstack([_EDGES, marks])


def _surface(frusta: Sequence[Frustum], corners: Sequence[FloatArray]) -> Part:
    """The filled ones; each face has its own corners, or the pyramids would look round."""
    vertices = np.vstack([own[_SIDES].reshape(-1, 3) for own in corners])
    triangles = vertices.reshape(-1, 3, 3)
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    which = np.repeat([_STATES[frustum.state] for frustum in frusta], _SIDES.size).astype(np.uint8)
    return Part(
        "surface",
        vertices.astype(np.float32),
        Paint(_COLORS, which=which, opacity=0.55),
        normals=np.repeat(normals, 3, axis=0).astype(np.float32),
    )
