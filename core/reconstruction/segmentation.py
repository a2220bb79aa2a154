"""Telling the object from the scene: its part of the volume (Sec. IV-A and its footnote)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from core.errors import StageError
from core.geometry import FloatArray, IntArray
from core.parameters.reconstruction import ReconstructionParameters
from core.reconstruction.clusters import largest_cluster
from core.reconstruction.planes import Plane, find_plane
from core.reconstruction.tsdf import SURFACE_BAND, TsdfVolume
from core.scan.crop_box import crop_box_of
from core.scan.model import Scan

CLUSTER_GAP_M = 0.015
SMALLEST_AREA_M2 = 0.0016
"""A cluster's least surface: the released code's 200 voxels of 4 mm at its truncation."""
PADDING_LOW = (3, 2, 3)
PADDING_HIGH = (3, 10, 3)
"""Voxels around the cluster, as in the released code; the upper side is exclusive."""
STRIDE = 6


@dataclass(frozen=True)
class Part:
    """A block of the volume, indices `low` to `high` (exclusive), around the surface voxels `seen` (N, 3)."""

    low: IntArray
    high: IntArray
    seen: IntArray

    @property
    def slices(self) -> tuple[slice, slice, slice]:
        """The block as an index of the volume's arrays."""
        x, y, z = (slice(int(low), int(high)) for low, high in zip(self.low, self.high, strict=True))
        return x, y, z

    def down_to(self, layer: int) -> Part:
        """The same block, reaching at least down to `layer` or the volume's floor."""
        low = self.low.copy()
        low[2] = max(0, min(int(low[2]), layer))
        return replace(self, low=low)


def find_object(
    volume: TsdfVolume, scan: Scan, parameters: ReconstructionParameters, table: Plane | None
) -> Part:
    """Return the block around the largest cluster of surface voxels, above the `table` if there is one.

    Raises:
        StageError: the crop box holds no surface or only crumbs.
    """
    seen = volume.surface_voxels()
    if table is not None:
        centers = volume.centers_m(seen)
        seen = seen[centers[:, 2] > table.height_m(centers[:, 0], centers[:, 1]) + parameters.plane_margin_m]
    if len(seen) == 0:
        raise StageError(f"No surface is left in the crop box{_where_points_are(scan, parameters)}")
    gap = max(CLUSTER_GAP_M / volume.voxel_m + 1e-6, np.sqrt(3.0))
    cluster = largest_cluster(seen, gap)
    if len(cluster) < fewest_voxels(volume):
        raise StageError(f"Only crumbs are left in the crop box{_where_points_are(scan, parameters)}")
    low = np.maximum(cluster.min(axis=0) - PADDING_LOW, 0)
    high = np.minimum(cluster.max(axis=0) + PADDING_HIGH, volume.distance.shape)
    return Part(low, high, cluster)


def fewest_voxels(volume: TsdfVolume) -> int:
    """How many surface voxels the least surface fills; 200 with the released code's grid."""
    thickness_m = 2 * SURFACE_BAND * volume.truncation_m
    return round(SMALLEST_AREA_M2 * thickness_m / volume.voxel_m**3)


def find_table(scan: Scan, parameters: ReconstructionParameters) -> Plane:
    """Find the plane on which the object stands, from all depth points in the crop box (RANSAC).

    Raises:
        StageError: no near-horizontal plane lies in the crop box.
    """
    points = _points_in_box(scan, parameters)
    plane = find_plane(points)
    if plane is None:
        raise StageError(
            f"No table was found in the crop box{_where_points_are(scan, parameters)[:-1]}; "
            "or use reconstruction.segmentation = box."
        )
    return plane


def touched_sides(part: Part, volume: TsdfVolume, *, with_bottom: bool) -> list[str]:
    """Name the sides of the crop box which the object's seen surface touches."""
    low, high = part.seen.min(axis=0) == 0, part.seen.max(axis=0) == np.array(volume.distance.shape) - 1
    sides = {"-x": low[0], "+x": high[0], "-y": low[1], "+y": high[1], "+z": high[2]}
    if with_bottom:
        sides["-z"] = low[2]
    return [side for side, touched in sides.items() if touched]


def _points_in_box(scan: Scan, parameters: ReconstructionParameters) -> FloatArray:
    points = _all_points(scan, parameters)
    box = crop_box_of(scan, parameters)
    low, high = np.array(box.min_m), np.array(box.max_m)
    return points[((points >= low) & (points <= high)).all(axis=1)]


def _all_points(scan: Scan, parameters: ReconstructionParameters) -> FloatArray:
    views: Sequence[FloatArray] = [
        frame.points_m(scan.intrinsics, max_depth_m=parameters.max_depth_m, stride=STRIDE)
        for frame in scan.frames
    ]
    return np.concatenate([np.zeros((0, 3)), *views])


def _where_points_are(scan: Scan, parameters: ReconstructionParameters) -> str:
    points = _all_points(scan, parameters)
    if len(points) == 0:
        return f", no pixel has a depth up to {parameters.max_depth_m:g} m; scan again or raise max_depth_m."
    x, y, z = np.median(points, axis=0)
    return (
        f"; the depth points lie around ({x:.2f}, {y:.2f}, {z:.2f}) m in the base frame, so set "
        "reconstruction.crop_min_m and crop_max_m to the place of the object."
    )
