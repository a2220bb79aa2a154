"""A floor near the support: kept where it is thinner than a voxel, and as high as its inside was seen.

Voxels hold no slab thinner than one of them, so a thin floor is first made `FLOOR_VOXELS` thick, which
closes it. The views say more exactly where its inside is: there the fused distances are zero, to a part of a
voxel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter, map_coordinates

from core.geometry import FloatArray
from core.mesh import TriangleMesh
from core.reconstruction.segmentation import Part, centers_m
from core.reconstruction.tsdf import DistanceGrid, TsdfVolume

FLOOR_VOXELS = 1.5
"""Thinner than a voxel, a floor may lie between two of them and be lost."""
THINNEST_M = 0.001
"""What is left of a floor however low its inside was seen; thinner ones are seldom made."""
_SMOOTHED_VOXELS = 2.0
"""SD of the weights with which neighbouring columns count: of some 50 columns the noise is a seventh."""
_LEAST_COLUMNS = 0.3
"""Share of these weights that must have seen the floor; fewer lie at its edge or are specks."""
_BELOW_TOP_VOXELS = 0.35
"""How far below its nominal top the voxels' interpolation may put a floor."""


def keep_floor(
    distance: DistanceGrid, volume: TsdfVolume, part: Part, support_m: float, error_m: float
) -> DistanceGrid:
    """Give what is on the support a floor of `FLOOR_VOXELS` where it was seen to have one at all.

    The inside of a low floor lies so near the support that noise puts half of it below: cut there, it is
    full of holes. Where a column is solid anywhere from a little below the support to a voxel above it,
    something kept the views from looking through to the table.

    Args:
        distance: (x, y, z) of the part, before it is cut at the support; below that it is filled, too.
        volume: it is taken from.
        part: it covers; reaches a little below the support.
        support_m: height of the support.
        error_m: how far a surface may err.
    """
    _, _, z = centers_m(volume, part)
    near = (z > support_m - error_m - volume.voxel_m) & (z < support_m + volume.voxel_m)
    has_floor = np.any((distance < 0) & near, axis=2, keepdims=True)
    thickness_m = FLOOR_VOXELS * volume.voxel_m
    floor = np.abs(z - support_m - thickness_m / 2) - thickness_m / 2
    kept = np.where(has_floor, np.minimum(distance, floor / volume.truncation_m), distance)
    return kept.astype(np.float32)


@dataclass(frozen=True)
class SeenFloor:
    """Where the views put the inside of a floor that `keep_floor` made thicker than they say.

    Attributes:
        heights_m: (X, Y) of the part's columns, in the base frame; NaN where none was seen.
        origin_m: (2,) of the first column.
        voxel_m: distance of the columns.
        support_m: height of the support.
    """

    heights_m: FloatArray
    origin_m: FloatArray
    voxel_m: float
    support_m: float

    def lowered(self, mesh: TriangleMesh) -> TriangleMesh:
        """Return the surface with the tops of floors that were made thicker at the height that was seen."""
        vertices = mesh.vertices_m.copy()
        top_m = self.support_m + FLOOR_VOXELS * self.voxel_m
        low_m, high_m = top_m - _BELOW_TOP_VOXELS * self.voxel_m, top_m + 1e-6
        on_top = (vertices[:, 2] > low_m) & (vertices[:, 2] < high_m)
        seen_m = self._at(vertices[on_top, :2])
        vertices[on_top, 2] = np.fmin(vertices[on_top, 2], np.maximum(seen_m, self.support_m + THINNEST_M))
        return TriangleMesh(vertices, mesh.faces)

    def _at(self, places_m: FloatArray) -> FloatArray:
        columns = ((places_m - self.origin_m) / self.voxel_m).T
        found: FloatArray = map_coordinates(self.heights_m, columns, order=1, mode="nearest")
        return found


def seen_floor(volume: TsdfVolume, part: Part, support_m: float, error_m: float) -> SeenFloor:
    """Find where views from above put the inside of a low floor, smoothed over neighbouring columns.

    Args: see `keep_floor`.
    """
    crossing_m = _crossings_m(volume, part, support_m, error_m)
    is_seen = ~np.isnan(crossing_m)
    weights = gaussian_filter(is_seen.astype(float), _SMOOTHED_VOXELS)
    sums = gaussian_filter(np.where(is_seen, crossing_m, 0.0), _SMOOTHED_VOXELS)
    enough = weights > _LEAST_COLUMNS
    heights_m = np.where(enough, sums / np.where(enough, weights, 1.0), np.nan)
    return SeenFloor(heights_m, volume.centers_m(part.low)[:2], volume.voxel_m, support_m)


def _crossings_m(volume: TsdfVolume, part: Part, support_m: float, error_m: float) -> FloatArray:
    """Heights (X, Y) near the support at which columns become solid downwards; NaN where none was seen."""
    _, _, z = centers_m(volume, part)
    heights_m = z.ravel()
    distance, seen = volume.distance[part.slices], volume.weight[part.slices] > 0
    below, above = distance[:, :, :-1], distance[:, :, 1:]
    near = (heights_m[:-1] > support_m - error_m - 2 * volume.voxel_m) & (
        heights_m[:-1] < support_m + FLOOR_VOXELS * volume.voxel_m
    )
    ends = (below < 0) & (above >= 0) & seen[:, :, :-1] & seen[:, :, 1:] & near
    part_of_voxel = below / np.where(ends, below - above, 1.0)
    at_m = np.where(ends, heights_m[:-1] + volume.voxel_m * part_of_voxel, -np.inf).max(axis=2)
    return np.where(np.isfinite(at_m), at_m, np.nan)
