"""How well the views' poses agree, told by the table alone (no model, no second measurement needed).

Every view sees the table; if all poses were right, all would see it at one height and level.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray
from core.parameters.reconstruction import ReconstructionParameters
from core.reconstruction.planes import Plane, find_plane
from core.scan.crop_box import crop_box_of
from core.scan.model import CropBox, Intrinsics, RgbdFrame, Scan

STRIDE = 6
SURROUNDINGS_M = 0.3
"""How far around the crop box the table is looked for."""
FEWEST_POINTS = 300
SMALLEST_SHARE = 0.2
FEWEST_VIEWS = 3


@dataclass(frozen=True)
class ViewHealth:
    """The table as one view sees it: its height at the crop box's middle and its tilt; none if not seen."""

    name: str
    height_m: float | None
    tilt_rad: float | None


@dataclass(frozen=True)
class PoseHealth:
    """The table in all views; the summary is over those that see it, and none when fewer than three do."""

    views: tuple[ViewHealth, ...]

    @property
    def mean_height_m(self) -> float | None:
        """Mean height of the table."""
        heights = self._heights_m()
        return float(heights.mean()) if len(heights) >= FEWEST_VIEWS else None

    @property
    def sd_height_m(self) -> float | None:
        """Standard deviation of the height over the views: the measure of the pose error."""
        heights = self._heights_m()
        return float(heights.std(ddof=1)) if len(heights) >= FEWEST_VIEWS else None

    @property
    def largest_tilt_rad(self) -> float | None:
        """Tilt of the view that sees the table least level."""
        return max((view.tilt_rad for view in self.views if view.tilt_rad is not None), default=None)

    def _heights_m(self) -> FloatArray:
        return np.array([view.height_m for view in self.views if view.height_m is not None], dtype=float)


def measure_pose_health(scan: Scan, parameters: ReconstructionParameters) -> PoseHealth:
    """Fit the table in every view, near the crop box."""
    return pose_health_of(scan, find_tables(scan, parameters), crop_box_of(scan, parameters))


def find_tables(scan: Scan, parameters: ReconstructionParameters) -> tuple[Plane | None, ...]:
    """Fit the table in every view, near the crop box; none where it is not seen."""
    box = crop_box_of(scan, parameters)
    return tuple(_find_table(frame, scan.intrinsics, box, parameters.max_depth_m) for frame in scan.frames)


def pose_health_of(scan: Scan, tables: Sequence[Plane | None], box: CropBox) -> PoseHealth:
    """Judge the poses by the tables that were found."""
    views = zip(scan.frames, tables, strict=True)
    return PoseHealth(tuple(_view_health(frame.name, table, box) for frame, table in views))


def measure_view_health(
    frame: RgbdFrame, intrinsics: Intrinsics, box: CropBox, max_depth_m: float
) -> ViewHealth:
    """Fit the table in one view, around the crop box; for a live warning while scanning, too."""
    return _view_health(frame.name, _find_table(frame, intrinsics, box, max_depth_m), box)


def _find_table(frame: RgbdFrame, intrinsics: Intrinsics, box: CropBox, max_depth_m: float) -> Plane | None:
    low, high = np.array(box.min_m[:2]), np.array(box.max_m[:2])
    points = frame.points_m(intrinsics, max_depth_m=max_depth_m, stride=STRIDE)
    is_near = (points[:, :2] > low - SURROUNDINGS_M) & (points[:, :2] < high + SURROUNDINGS_M)
    points = points[is_near.all(axis=1)]
    plane = find_plane(points) if len(points) >= FEWEST_POINTS else None
    return plane if plane is not None and plane.share >= SMALLEST_SHARE else None


def _view_health(name: str, table: Plane | None, box: CropBox) -> ViewHealth:
    if table is None:
        return ViewHealth(name, None, None)
    middle_x, middle_y = (np.array(box.min_m[:2]) + np.array(box.max_m[:2])) / 2
    return ViewHealth(name, float(table.height_m(middle_x, middle_y)), table.tilt_rad)
