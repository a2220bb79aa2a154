"""Layers from what pages have: meshes, lines, points, arms, boxes and camera views."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.gui.views.scene.camera import Camera, Ray, Size
from app.gui.views.scene.parts import (
    Float32Array,
    Layer,
    Paint,
    Part,
    PreparedMesh,
    prepare_mesh,
)
from app.gui.views.scene.picking import BallTarget, FaceTarget
from app.gui.views.scene.shapes import (
    Shape,
    arrow_mesh,
    box_edges,
)
from core.geometry import FloatArray, transform_points

_HANDLE_PX = 11
_HANDLE_REACH_PX = 11
_THINNEST_M = 0.005
_FRUSTUM_DEPTH_M = 0.05
_HALF_WIDTH_M, _HALF_HEIGHT_M = 0.028, 0.021
_FRUSTUM_COLORS = ("muted", "good", "attention", "failed", "accent")
_FRUSTUM_STATES = {"pending": 0, "taken": 1, "poor": 2, "failed": 3}
_SELECTED = 4
_FRUSTUM_RIM = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * (_HALF_WIDTH_M, _HALF_HEIGHT_M)
_FRUSTUM_CORNERS = np.vstack([np.zeros(3), np.column_stack([_FRUSTUM_RIM, np.full(4, _FRUSTUM_DEPTH_M)])])
_FRUSTUM_SIDES = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1], [1, 3, 2], [1, 4, 3]])
_FRUSTUM_EDGES = np.array([[0, 1], [0, 2], [0, 3], [0, 4], [1, 2], [2, 3], [3, 4], [4, 1]])
_FRUSTUM_CROSS = np.array([[1, 3], [2, 4]])
_FRUSTUM_BAR = np.array([[1, 3]])


def mesh_layer(mesh: PreparedMesh, color: str, opacity: float) -> Layer:
    """A mesh as a surface, or as a wire frame."""
    paint = Paint(
        (color,), values=mesh.values, scale=mesh.scale, opacity=opacity, light=mesh.light, rgb=mesh.rgb
    )
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
    return Layer((_surface_part(arrow_mesh(start_m, end_m), Paint((color,))),))


def label_layer(point_m: npt.ArrayLike, text: str) -> Layer:
    """Words beside a point (3,)."""
    return Layer((Part("points", _points(point_m), Paint(("text",)), size_px=5, is_on_top=True),), text=text)


def _points(points_m: npt.ArrayLike) -> Float32Array:
    return np.array(points_m, dtype=np.float32).reshape(-1, 3)


def _surface_part(shape: Shape, paint: Paint) -> Part:
    mesh = prepare_mesh(*shape)
    return Part("surface", mesh.vertices_m, paint, mesh.normals, mesh.faces.ravel())


class CropBox:
    """A layer that shows a box; its sides can be dragged.

    Attributes:
        layer: to be drawn.
        has_handles: whether they can.
        min_m: (3,) lower corner.
        max_m: (3,) upper corner.
    """

    def __init__(self, min_m: npt.ArrayLike, max_m: npt.ArrayLike, has_handles: bool) -> None:
        self.has_handles = has_handles
        self.min_m, self.max_m = np.array(min_m, dtype=float), np.array(max_m, dtype=float)
        lines = Part("lines", self._edges(), Paint(("accent",)), size_px=1.6)
        handles = Part("points", self._handles(), Paint(("accent",)), size_px=_HANDLE_PX, is_on_top=True)
        self.layer = Layer((lines, handles) if has_handles else (lines,))

    def handle_at(self, pixel: tuple[float, float], camera: Camera, size: Size) -> int | None:
        """The handle under a pixel: 0 to 2 move the lower corner's x to z, 3 to 5 the upper corner's."""
        if not self.has_handles or not self.layer.is_visible:
            return None
        places = transform_points(self.layer.T_world_layer, self._handles())
        gaps = np.linalg.norm(camera.project(places, size) - pixel, axis=1)
        gaps = np.nan_to_num(gaps, nan=np.inf)
        nearest = int(gaps.argmin())
        return nearest if gaps[nearest] <= _HANDLE_REACH_PX else None

    def drag(self, handle: int, ray: Ray) -> None:
        """Move a side along its axis to where it is nearest to a line of sight; the box never turns over."""
        side, axis = divmod(handle, 3)
        place = _along_axis((self.min_m + self.max_m) / 2, axis, ray)
        if side == 0:
            self.min_m[axis] = min(place, self.max_m[axis] - _THINNEST_M)
        else:
            self.max_m[axis] = max(place, self.min_m[axis] + _THINNEST_M)
        self.layer.parts[0].move_vertices(self._edges())
        self.layer.parts[1].move_vertices(self._handles())

    def _edges(self) -> npt.NDArray[np.float32]:
        return box_edges(self.min_m, self.max_m).astype(np.float32)

    def _handles(self) -> npt.NDArray[np.float32]:
        """The middles (6, 3) of the sides."""
        middle = (self.min_m + self.max_m) / 2
        places = np.tile(middle, (6, 1))
        for axis in range(3):
            places[axis, axis], places[axis + 3, axis] = self.min_m[axis], self.max_m[axis]
        return places.astype(np.float32)


def _along_axis(through_m: FloatArray, axis: int, ray: Ray) -> float:
    """The coordinate at which a line along an axis is nearest to a line of sight."""
    along = float(ray.direction[axis])
    offset = ray.origin_m - through_m
    across = 1 - along**2
    if across < 1e-6:
        return float(through_m[axis])
    return float(through_m[axis] + (offset[axis] - along * (offset @ ray.direction)) / across)


@dataclass(frozen=True, eq=False)
class Frustum:
    """A view of the camera.

    Attributes:
        name: of the frame; not shown.
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
    corners = [transform_points(frustum.T_base_camera, _FRUSTUM_CORNERS) for frustum in frusta]
    filled = [k for k, frustum in enumerate(frusta) if frustum.state in ("taken", "poor")]
    parts = [_outlines(frusta, corners, is_selected) for is_selected in (False, True)]
    if filled:
        parts.append(_filled([frusta[k] for k in filled], [corners[k] for k in filled]))
    faces = np.vstack([_FRUSTUM_SIDES + 5 * k for k in range(len(frusta))])
    element = np.repeat(np.arange(len(frusta)), len(_FRUSTUM_SIDES))
    return Layer(
        tuple(part for part in parts if len(part.vertices_m)), FaceTarget(np.vstack(corners), faces, element)
    )


def _outlines(frusta: Sequence[Frustum], corners: Sequence[FloatArray], is_selected: bool) -> Part:
    """Outlines of the selected ones or of the others."""
    points, which = [np.empty((0, 3))], [np.empty(0, dtype=np.uint8)]
    for frustum, own in zip(frusta, corners, strict=True):
        if frustum.is_selected == is_selected:
            points.append(own[_segments(frustum).ravel()])
            color = _SELECTED if is_selected else _FRUSTUM_STATES[frustum.state]
            which.append(np.full(len(points[-1]), color, dtype=np.uint8))
    paint = Paint(_FRUSTUM_COLORS, which=np.concatenate(which))
    width = 3.5 if is_selected else 1.5
    return Part("lines", np.vstack(points).astype(np.float32), paint, size_px=width)


def _segments(frustum: Frustum) -> FloatArray:
    marks = {"failed": _FRUSTUM_CROSS, "poor": _FRUSTUM_BAR}.get(frustum.state)
    return _FRUSTUM_EDGES if marks is None else np.vstack([_FRUSTUM_EDGES, marks])


def _filled(frusta: Sequence[Frustum], corners: Sequence[FloatArray]) -> Part:
    """The filled ones; each face has its own corners, or smooth normals would round the pyramids."""
    vertices = np.vstack([own[_FRUSTUM_SIDES].reshape(-1, 3) for own in corners])
    triangles = vertices.reshape(-1, 3, 3)
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    which = np.repeat([_FRUSTUM_STATES[frustum.state] for frustum in frusta], _FRUSTUM_SIDES.size).astype(
        np.uint8
    )
    return Part(
        "surface",
        vertices.astype(np.float32),
        Paint(_FRUSTUM_COLORS, which=which, opacity=0.55),
        normals=np.repeat(normals, 3, axis=0).astype(np.float32),
    )
