"""A box of wires whose six sides have handles."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.gui.views.scene.camera import Camera, Ray, Size
from app.gui.views.scene.parts import Layer, Paint, Part
from app.gui.views.scene.shapes import box_edges
from core.geometry import FloatArray, transform_points

_HANDLE_PX = 11
_REACH_PX = 11
_THINNEST_M = 0.005


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
        return nearest if gaps[nearest] <= _REACH_PX else None

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
