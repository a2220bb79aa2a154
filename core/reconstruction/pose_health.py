"""How well the views' poses agree, told by the table alone (no model, no second measurement needed).

Every view sees the table; if all poses were right, all would see it at one height and level.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray
from core.parameters.reconstruction import ReconstructionParameters
from core.reconstruction.planes import find_plane
from core.scan.model import Intrinsics, RgbdFrame

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


def measure_pose_health(
    frames: Sequence[RgbdFrame], intrinsics: Intrinsics, parameters: ReconstructionParameters
) -> PoseHealth:
    """Fit the table in every view, near the crop box."""
    return PoseHealth(tuple(measure_view_health(frame, intrinsics, parameters) for frame in frames))


def measure_view_health(
    frame: RgbdFrame, intrinsics: Intrinsics, parameters: ReconstructionParameters
) -> ViewHealth:
    """Fit the table in one view; for a live warning while scanning, too."""
    low, high = np.array(parameters.crop_min_m[:2]), np.array(parameters.crop_max_m[:2])
    points = frame.points_m(intrinsics, max_depth_m=parameters.max_depth_m, stride=STRIDE)
    is_near = (points[:, :2] > low - SURROUNDINGS_M) & (points[:, :2] < high + SURROUNDINGS_M)
    points = points[is_near.all(axis=1)]
    plane = find_plane(points) if len(points) >= FEWEST_POINTS else None
    if plane is None or plane.share < SMALLEST_SHARE:
        return ViewHealth(frame.name, None, None)
    middle_x, middle_y = (low + high) / 2
    return ViewHealth(frame.name, float(plane.height_m(middle_x, middle_y)), plane.tilt_rad)
