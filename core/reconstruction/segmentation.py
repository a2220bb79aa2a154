"""Telling the object from the scene: its part of the volume (Sec. IV-A and its footnote).

What the views could not see is solid above the support, and nothing below it. No view sees the inside of a
wall or of a floor. Left free, the fused surface would be a crust as thick as the truncation; taken as solid,
a wall is as thick as the views from its two sides say, and the object stands flat on its support.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.ndimage import binary_fill_holes, label
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from core.errors import StageError
from core.geometry import BoolArray, FloatArray, IntArray
from core.parameters.reconstruction import ReconstructionParameters
from core.reconstruction.pose_health import Plane, find_plane
from core.reconstruction.tsdf import SURFACE_BAND, DistanceGrid, TsdfVolume
from core.scan.model import CropBox, Scan, crop_box_of

CLUSTER_GAP_M = 0.015
SMALLEST_AREA_M2 = 0.0016
"""A cluster's least surface: the released code's 200 voxels of 4 mm at its truncation."""
PADDING_LOW = (3, 2, 3)
PADDING_HIGH = (3, 10, 3)
"""Voxels around the cluster, as in the released code; the upper side is exclusive."""
STRIDE = 6
PLATFORM_STRIDE = 3
LOWEST_PERCENT = 0.2
"""What may be noise below the object's foot."""
SMALLEST_DISTANCE = np.float32(1e-4)
"""Marching cubes makes faces without area where a distance is exactly zero."""


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

    def box(self, volume: TsdfVolume) -> CropBox:
        """The block as a box in the base frame."""
        low, high = volume.centers_m(self.low).tolist(), volume.centers_m(self.high - 1).tolist()
        return CropBox((low[0], low[1], low[2]), (high[0], high[1], high[2]))


def whole(volume: TsdfVolume) -> Part:
    """Return all of a volume as the object's part."""
    return Part(np.zeros(3, dtype=np.int64), np.array(volume.distance.shape), volume.surface_voxels())


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
    points = _all_points(scan, parameters)
    box = crop_box_of(scan, parameters)
    plane = find_plane(points[((points >= box.min_m) & (points <= box.max_m)).all(axis=1)])
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


def largest_cluster(indices: IntArray, gap_voxels: float) -> IntArray:
    """The largest set of voxels (N, 3) in which each is within `gap_voxels` of another, rows in their order.

    Neighbouring voxels are joined first, which leaves few groups to be measured against one another.
    """
    low = indices.min(axis=0)
    grid = np.zeros(indices.max(axis=0) - low + 1, dtype=np.bool_)
    grid[tuple((indices - low).T)] = True
    labels, n_groups = label(grid, structure=np.ones((3, 3, 3)))
    group_of_voxel = labels[tuple((indices - low).T)] - 1
    cluster_of_group = _join(indices, group_of_voxel, n_groups, gap_voxels)
    cluster_of_voxel = cluster_of_group[group_of_voxel]
    largest: IntArray = indices[cluster_of_voxel == np.bincount(cluster_of_voxel).argmax()]
    return largest


def _join(indices: IntArray, group_of_voxel: IntArray, n_groups: int, gap_voxels: float) -> IntArray:
    """Return the cluster (G,) of each group."""
    order = np.argsort(group_of_voxel, kind="stable")
    members = np.split(indices[order], np.cumsum(np.bincount(group_of_voxel, minlength=n_groups))[:-1])
    lows = np.array([group.min(axis=0) for group in members])
    highs = np.array([group.max(axis=0) for group in members])
    pairs: list[tuple[int, int]] = []
    for first, group in enumerate(members):
        overlap = (lows <= highs[first] + gap_voxels) & (highs >= lows[first] - gap_voxels)
        others = [int(other) for other in np.nonzero(overlap.all(axis=1))[0] if other > first]
        tree = cKDTree(group) if others else None
        for other in others:
            if tree is not None and np.min(tree.query(members[other])[0]) <= gap_voxels:
                pairs.append((first, other))
    ends = np.array(pairs, dtype=int).reshape(-1, 2)
    graph = coo_array((np.ones(len(ends), dtype=np.int8), (ends[:, 0], ends[:, 1])), (n_groups, n_groups))
    clusters: IntArray = connected_components(graph, directed=False)[1].astype(np.int64)
    return clusters


def estimate_platform_height_m(
    volume: TsdfVolume, part: Part, scan: Scan, parameters: ReconstructionParameters
) -> float:
    """Height of the lowest depth points of the object: the platform itself leaves none.

    A few millimetres too low with poor poses, too high when every view looks steeply down.
    """
    low_m = volume.centers_m(part.seen.min(axis=0)) - volume.voxel_m
    high_m = volume.centers_m(part.seen.max(axis=0)) + volume.voxel_m
    heights_m = []
    for frame in scan.frames:
        points = frame.points_m(scan.intrinsics, max_depth_m=parameters.max_depth_m, stride=PLATFORM_STRIDE)
        heights_m.append(points[((points > low_m) & (points < high_m)).all(axis=1), 2])
    everywhere = np.concatenate(heights_m)
    return float(np.percentile(everywhere, LOWEST_PERCENT)) if len(everywhere) else float(low_m[2])


def fill_unseen(volume: TsdfVolume, part: Part) -> DistanceGrid:
    """Distances (x, y, z) of the part with -1 in every voxel that only views from behind a surface know of.

    A voxel that lies in no view, or in none with a depth, stays free: it hides behind nothing.
    """
    distance = volume.distance[part.slices].copy()
    distance[(volume.weight[part.slices] == 0) & volume.hidden[part.slices]] = -1.0
    return distance


def cut_at_height(distance: DistanceGrid, volume: TsdfVolume, part: Part, height_m: float) -> DistanceGrid:
    """Remove what lies below a horizontal plane in the base frame."""
    _, _, z = centers_m(volume, part)
    return _above(distance, z - height_m, volume.truncation_m)


def cut_at_table(
    distance: DistanceGrid, volume: TsdfVolume, part: Part, table: Plane, margin_m: float
) -> DistanceGrid:
    """Remove what lies below the table, and around the object also what lies `margin_m` above it.

    Under and inside the object nothing is removed above the table, so that a low floor stays (in the
    footnote of Sec. IV-A a bag loses it).
    """
    x, y, z = centers_m(volume, part)
    height_m = z - table.height_m(x, y)
    is_object = (distance < 0) & (height_m > margin_m)
    footprint: BoolArray = binary_fill_holes(np.any(is_object, axis=2).astype(np.bool_))
    around = np.where(footprint[:, :, None], height_m, height_m - margin_m)
    return _above(distance, around, volume.truncation_m)


def _above(distance: DistanceGrid, height_m: npt.ArrayLike, truncation_m: float) -> DistanceGrid:
    below = np.clip(-np.asarray(height_m) / truncation_m, -1.0, 1.0).astype(np.float32)
    cut = np.maximum(distance, below)
    cut[np.abs(cut) < SMALLEST_DISTANCE] = SMALLEST_DISTANCE
    return cut


def centers_m(volume: TsdfVolume, part: Part) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Coordinates of the part's voxel centres, shaped to broadcast: (x, 1, 1), (1, y, 1), (1, 1, z)."""
    axes = [
        volume.origin_m[axis] + volume.voxel_m * np.arange(part.low[axis], part.high[axis])
        for axis in range(3)
    ]
    x, y, z = np.ix_(*axes)
    return x, y, z
