"""How well the views' poses agree, measured by the table alone (no model, no second measurement needed).

Every view sees the table; if all poses were right, all would see it at one height and level.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from weakref import ref

import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray
from core.parameters.reconstruction import ReconstructionParameters
from core.scan.model import CropBox, Intrinsics, RgbdFrame, Scan, crop_box_of
from core.threads import in_threads

STRIDE = 6
SURROUNDINGS_M = 0.3
"""How far around the crop box the table is looked for."""
FEWEST_POINTS = 300
SMALLEST_SHARE = 0.2
FEWEST_VIEWS = 3
N_HYPOTHESES = 200
N_VOTERS = 4000
"""Points that vote for a hypothesis; the least squares after it use all."""
N_REFINEMENTS = 5
STEEPEST_RAD = np.deg2rad(10.0)
INLIER_DISTANCE_M = 0.006
"""Twice the depth noise of a structured-light camera at 0.7 m."""


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


def find_tables(scan: Scan, parameters: ReconstructionParameters) -> tuple[Plane | None, ...]:
    """Fit the table in every view, near the crop box; none where it is not seen.

    Of a view that is still in memory it is fitted once: there is time for it while the arm takes the next.
    """
    box = crop_box_of(scan, parameters)

    def find(frame: RgbdFrame) -> Plane | None:
        key = id(frame), scan.intrinsics, box, parameters.max_depth_m
        known = _tables.get(key)
        if known is not None and known.of() is frame:
            return known.table
        table = _find_table(frame, scan.intrinsics, box, parameters.max_depth_m)
        _tables[key] = _KnownTable(ref(frame, lambda _: _tables.pop(key, None)), table)
        return table

    return tuple(in_threads(find, scan.frames))


@dataclass(frozen=True)
class _KnownTable:
    """The table in a view, for as long as somebody holds the view."""

    of: ref[RgbdFrame]
    table: Plane | None


_tables: dict[tuple[int, Intrinsics, CropBox, float], _KnownTable] = {}


def pose_health_of(scan: Scan, tables: Sequence[Plane | None], box: CropBox) -> PoseHealth:
    """Judge the poses by the tables that were found."""
    views = zip(scan.frames, tables, strict=True)
    return PoseHealth(tuple(_view_health(frame.name, table, box) for frame, table in views))


def measure_view_health(
    frame: RgbdFrame, intrinsics: Intrinsics, box: CropBox, max_depth_m: float
) -> ViewHealth:
    """Fit the table in one view, around the crop box; also for a live warning while scanning."""
    return _view_health(frame.name, _find_table(frame, intrinsics, box, max_depth_m), box)


def _find_table(frame: RgbdFrame, intrinsics: Intrinsics, box: CropBox, max_depth_m: float) -> Plane | None:
    low, high = np.array(box.min_m), np.array(box.max_m)
    points = frame.points_m(intrinsics, max_depth_m=max_depth_m, stride=STRIDE)
    is_near = (points[:, :2] > low[:2] - SURROUNDINGS_M) & (points[:, :2] < high[:2] + SURROUNDINGS_M)
    points = points[is_near.all(axis=1)]
    plane = _large_plane(points)
    if plane is None or plane.height_m(*(low[:2] + high[:2]) / 2) <= low[2]:
        return plane
    # It may be the floor of a large object.
    is_in_box = ((points > low) & (points < high)).all(axis=1)
    return _large_plane(points[~is_in_box])


def _large_plane(points_m: FloatArray) -> Plane | None:
    plane = find_plane(points_m) if len(points_m) >= FEWEST_POINTS else None
    return plane if plane is not None and plane.share >= SMALLEST_SHARE else None


def _view_health(name: str, table: Plane | None, box: CropBox) -> ViewHealth:
    if table is None:
        return ViewHealth(name, None, None)
    middle_x, middle_y = (np.array(box.min_m[:2]) + np.array(box.max_m[:2])) / 2
    return ViewHealth(name, float(table.height_m(middle_x, middle_y)), table.tilt_rad)


@dataclass(frozen=True)
class Plane:
    """A plane through `point_m` (3,) with the upward unit `normal` (3,); `share` of the points lies on it."""

    point_m: FloatArray
    normal: FloatArray
    share: float

    @property
    def tilt_rad(self) -> float:
        """Angle between the normal and the vertical."""
        return float(np.arccos(np.clip(self.normal[2], -1.0, 1.0)))

    def height_m(self, x_m: npt.ArrayLike, y_m: npt.ArrayLike) -> FloatArray:
        """Height z of the plane above (x, y)."""
        dx, dy = np.asarray(x_m) - self.point_m[0], np.asarray(y_m) - self.point_m[1]
        height: FloatArray = self.point_m[2] - (self.normal[0] * dx + self.normal[1] * dy) / self.normal[2]
        return height


def find_plane(points_m: FloatArray) -> Plane | None:
    """Return the near-horizontal plane that most of the points (N, 3) lie on; none if there is none.

    RANSAC over seeded samples, then least squares over the inliers.
    """
    if len(points_m) < 3:
        return None
    random = np.random.default_rng(0)
    corners = points_m[random.integers(len(points_m), size=(N_HYPOTHESES, 3))]
    voters = (
        points_m if len(points_m) <= N_VOTERS else points_m[random.integers(len(points_m), size=N_VOTERS)]
    )
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    is_flat = np.abs(normals[:, 2]) > np.cos(STEEPEST_RAD) * np.maximum(lengths, 1e-9)
    if not is_flat.any():
        return None
    normals, anchors = normals[is_flat] / lengths[is_flat, None], corners[is_flat, 0]
    distances = np.abs(voters @ normals.T - np.einsum("ij,ij->i", anchors, normals))
    best = int((distances < INLIER_DISTANCE_M).sum(axis=0).argmax())
    return _refine(points_m, anchors[best], normals[best])


def _refine(points_m: FloatArray, point_m: FloatArray, normal: FloatArray) -> Plane | None:
    share = 0.0
    for _ in range(N_REFINEMENTS):
        inliers = points_m[np.abs((points_m - point_m) @ normal) < INLIER_DISTANCE_M]
        if len(inliers) < 3:
            return None
        share = len(inliers) / len(points_m)
        point_m = inliers.mean(axis=0)
        normal = np.linalg.svd(inliers - point_m, full_matrices=False)[2][2]
    normal = normal * np.sign(normal[2])
    return Plane(point_m, normal, share) if normal[2] > np.cos(STEEPEST_RAD) else None
