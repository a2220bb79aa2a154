"""How good one view is: judged by its images alone while scanning, and against the model afterwards."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product
from math import degrees, radians

import numpy as np

from core.geometry import FloatArray, invert_pose, transform_points
from core.mesh import SurfaceDistance, TriangleMesh
from core.reconstruction.pose_health import measure_view_health
from core.scan.model import CropBox, Intrinsics, RgbdFrame

FARTHEST_M = 3.0
"""What lies beyond is not part of the cell."""
SMALLEST_VALID_SHARE = 0.4
STRAY_TABLE_M = 0.010
STEEPEST_TABLE_RAD = radians(2.0)
MOVED_M = 0.001
MOVED_RAD = radians(0.1)
NEAR_M = 0.02
"""Farther off the model a point belongs to something else."""
ABOVE_FOOT_M = 0.005
STRIDE = 3
FEWEST_POINTS = 100


@dataclass(frozen=True)
class ViewQuality:
    """How good one view is.

    Attributes:
        name: the frame's.
        valid_share: share of the pixels with a depth, within the image of the crop box.
        is_repeated: colour and depth are those of the view before although the camera moved.
        table_height_m: where the view sees the table, under the crop box's middle; none if it does not.
        table_tilt_rad: how far from level it sees it.
        table_offset_m: its height above where the other views, or the cell, have it; none if not known.
        residual_median_m: median distance of its points on the object to the model; none before there is one.
        residual_rms_m: root mean square of the same.
    """

    name: str
    valid_share: float
    is_repeated: bool = False
    table_height_m: float | None = None
    table_tilt_rad: float | None = None
    table_offset_m: float | None = None
    residual_median_m: float | None = None
    residual_rms_m: float | None = None

    def against_table(self, table_height_m: float) -> ViewQuality:
        """Return it with its table's offset from the height where the table is."""
        if self.table_height_m is None:
            return self
        return replace(self, table_offset_m=self.table_height_m - table_height_m)

    @property
    def is_useless(self) -> bool:
        """Whether it shows nothing, so that it counts as not taken."""
        return self.valid_share == 0 or self.is_repeated

    @property
    def problems(self) -> tuple[str, ...]:
        """A plain sentence for each thing that is wrong with it."""
        if self.valid_share == 0:
            return (f"{self.name} has no depth at all; check the camera's projector and take it again.",)
        if self.is_repeated:
            return (f"{self.name} repeats the previous image although the arm moved: the camera is frozen.",)
        found = []
        if self.valid_share < SMALLEST_VALID_SHARE:
            found.append(
                f"{self.name} has a depth in only {self.valid_share:.0%} of the pixels around the object; "
                "look for glare, or for something in front of the camera."
            )
        if self.table_offset_m is not None and abs(self.table_offset_m) > STRAY_TABLE_M:
            side = "above" if self.table_offset_m > 0 else "below"
            found.append(
                f"{self.name} sees the table {abs(self.table_offset_m) * 1000:.0f} mm {side} its place; "
                "its pose is wrong; take it again."
            )
        if self.table_tilt_rad is not None and self.table_tilt_rad > STEEPEST_TABLE_RAD:
            found.append(
                f"{self.name} sees the table tilted by {degrees(self.table_tilt_rad):.1f} degrees; "
                "its pose is wrong; take it again."
            )
        return tuple(found)


def check_view(
    frame: RgbdFrame,
    intrinsics: Intrinsics,
    box: CropBox,
    *,
    before: RgbdFrame | None = None,
    table_height_m: float | None = None,
) -> ViewQuality:
    """Judge one view as soon as it is taken; 10 ms.

    Args:
        frame: the view.
        intrinsics: of its camera.
        box: the crop box.
        before: the view taken before it, to detect a frozen camera.
        table_height_m: the table's height, known in the cell or from the views so far.
    """
    health = measure_view_health(frame, intrinsics, box, FARTHEST_M)
    view = ViewQuality(
        name=frame.name,
        valid_share=valid_share(frame, intrinsics, box),
        is_repeated=before is not None and is_repeated(frame, before),
        table_height_m=health.height_m,
        table_tilt_rad=health.tilt_rad,
    )
    return view if table_height_m is None else view.against_table(table_height_m)


def valid_share(frame: RgbdFrame, intrinsics: Intrinsics, box: CropBox) -> float:
    """Share of pixels with a depth in the rectangle that the crop box fills; 0 if that is not in view."""
    height, width = frame.depth_m.shape
    corners = np.array(list(product(*zip(box.min_m, box.max_m, strict=True))))
    x, y, z = transform_points(invert_pose(frame.T_base_camera), corners).T
    if z.min() <= 0:
        return float((frame.depth_m > 0).mean())
    u, v = intrinsics.fx * x / z + intrinsics.cx, intrinsics.fy * y / z + intrinsics.cy
    left, right = np.clip([u.min(), u.max() + 1], 0, width).astype(int)
    top, bottom = np.clip([v.min(), v.max() + 1], 0, height).astype(int)
    window = frame.depth_m[top:bottom, left:right]
    return float((window > 0).mean()) if window.size else 0.0


def is_repeated(frame: RgbdFrame, before: RgbdFrame) -> bool:
    """Whether both images are those of the view before, from another pose: noise never repeats."""
    T = invert_pose(before.T_base_camera) @ frame.T_base_camera
    turn_rad = np.arccos(np.clip((np.trace(T[:3, :3]) - 1) / 2, -1, 1))
    moved = np.linalg.norm(T[:3, 3]) > MOVED_M or turn_rad > MOVED_RAD
    return bool(
        moved and np.array_equal(frame.depth_m, before.depth_m) and np.array_equal(frame.color, before.color)
    )


class ModelResiduals:
    """Distances of views' points to a model; make it in a worker."""

    def __init__(self, mesh: TriangleMesh, platform_height_m: float) -> None:
        self._surface = SurfaceDistance(mesh)
        self._low: FloatArray = mesh.aabb_min_m - NEAR_M
        self._low[2] = platform_height_m + ABOVE_FOOT_M
        self._high: FloatArray = mesh.aabb_max_m + NEAR_M

    def of_points_m(self, points_m: FloatArray) -> FloatArray:
        """Distances (M,) of those points (N, 3) that lie on the object."""
        near = points_m[((points_m > self._low) & (points_m < self._high)).all(axis=1)]
        distances = self._surface.of_m(near).astype(float)
        return distances[distances < NEAR_M]

    def add_to(self, view: ViewQuality, frame: RgbdFrame, intrinsics: Intrinsics) -> ViewQuality:
        """Return the view with its residuals; unchanged if it shows too little of the object."""
        distances = self.of_points_m(frame.points_m(intrinsics, max_depth_m=FARTHEST_M, stride=STRIDE))
        if len(distances) < FEWEST_POINTS:
            return view
        return replace(
            view,
            residual_median_m=float(np.median(distances)),
            residual_rms_m=float(np.sqrt(np.mean(distances**2))),
        )
