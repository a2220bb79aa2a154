"""What no view saw behind an object's openings: neither solid nor free, so both readings are kept.

Where known free space ends at voxels that no view saw, the views could not look further. Around the object
that is an ordinary shadow; within a closed ring of wall it is the inside of something that may hold candies,
or the way through its bottom.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import binary_dilation, distance_transform_edt, generate_binary_structure, label

from core.geometry import BoolArray, FloatArray
from core.reconstruction.tsdf import TsdfVolume
from core.threads import in_threads
from core.voxel_groups import large_groups

FREE_SHARE = 0.5
"""Share of the truncation in front of the surface from which on a voxel is surely free."""
SMALLEST_PATCH_M2 = 1e-4
"""Smaller frontiers are gaps that noise leaves; 10 mm by 10 mm."""
ALL_NEIGHBOURS = generate_binary_structure(3, 3)
IN_LAYER = generate_binary_structure(3, 1) & np.array([False, True, False])
"""The four neighbours within a horizontal layer; the last axis is z."""
_FAR_M = 1e3
"""Between layers: distances are taken within them."""
THINNEST_WALL_M = 0.003
"""What the roomiest reading leaves of walls and floor that nobody saw from inside."""
SMALLEST_UNSEEN_ML = 2.0
"""Room for two candies; less is no inside that was not seen."""
NARROWEST_HOLE_M = 0.006
"""A way through the bottom is at least as wide: less than a candy is thick."""


@dataclass(frozen=True)
class UnseenInside:
    """Masks (X, Y, Z) over the layers of a volume from `first_layer` up.

    Attributes:
        outside: not within a closed ring, in its layer, of wall or of what may be wall.
        enclosed: within one, and not solid.
        free: of these, what a view looked through.
        frontier: unseen voxels of it at which known free space ends.
        region: the unseen that is joined to the frontier, the cores of walls and floors included.
        assumed: what is joined to the region and solid only because it lies just behind an outer side.
        behind_walls: of region and assumed, what lies deeper within its layer than the thinnest wall.
        first_layer: of the volume, just above the platform.
    """

    outside: BoolArray
    enclosed: BoolArray
    free: BoolArray
    frontier: BoolArray
    region: BoolArray
    assumed: BoolArray
    behind_walls: BoolArray
    first_layer: int

    def room(self, voxel_m: float) -> BoolArray:
        """Return (X, Y, Z) what may be hollow, with walls and floor as thin as they can be."""
        room = self.behind_walls.copy()
        room[:, :, : int(np.ceil(THINNEST_WALL_M / voxel_m))] = False
        return room

    def way_through(self, volume: TsdfVolume) -> BoolArray | None:
        """Return (X, Y, Z) of the volume what may be hollow down through the platform; none: nothing may be.

        Something as thick as the narrowest hole must get from what a view looked through to the platform: a
        ring at the foot of a wall whose inner side nobody saw is no hole, nor is the core of a floor.
        """
        if not self._reaches_support(self.behind_walls & self.region, volume.voxel_m):
            return None
        # A spout's wall may be thinner than the thinnest that is counted on: its way is taken for all of it.
        through = self.in_volume(self.region | self.room(volume.voxel_m))
        below = volume.weight[:, :, : self.first_layer] == 0
        through[:, :, : self.first_layer] = self.region[:, :, :1] & below
        return through

    def beside_holes(self, volume: TsdfVolume, is_hole: BoolArray) -> BoolArray:
        """Return (X, Y, Z) of the volume the little that no view saw beside a hole that views looked through.

        Slanting views see no more than a part of a spout's mouth. Left solid, the rest would narrow the hole.

        Args:
            volume: the one that was asked.
            is_hole: (X, Y) columns that are known to be free down to the support.
        """
        groups, _ = label(self.region)
        sizes_ml = np.bincount(groups.ravel()) * volume.voxel_m**3 * 1e6
        beside = binary_dilation(is_hole & self.enclosed[:, :, 0] & self.free[:, :, 0])
        touching = np.unique(groups[:, :, 0][beside])
        little = touching[(touching > 0) & (sizes_ml[touching] < SMALLEST_UNSEEN_ML)]
        freed = np.isin(groups, little)
        down = freed[:, :, :1] & (volume.weight[:, :, : self.first_layer] == 0)
        return np.concatenate([down, freed], axis=2)

    def _reaches_support(self, hollow: BoolArray, voxel_m: float) -> bool:
        if hollow[:, :, 0].sum() * voxel_m**2 < SMALLEST_PATCH_M2:
            return False
        away_m = distance_transform_edt(hollow | self.free) * voxel_m - voxel_m / 2
        centres = away_m > NARROWEST_HOLE_M / 2
        reached = _connected_to(self.free & centres, centres)
        return bool((reached & hollow)[:, :, 0].any())

    def room_share(self, voxel_m: float) -> float:
        """Which share of all that may be hollow no view saw."""
        n_room = int(self.room(voxel_m).sum())
        return n_room / max(n_room + int(self.free.sum()), 1)

    def in_volume(self, mask: BoolArray) -> BoolArray:
        """Return a mask of these layers as one of the whole volume."""
        return np.pad(mask, ((0, 0), (0, 0), (self.first_layer, 0)))


def find_unseen_inside(volume: TsdfVolume, platform_height_m: float) -> UnseenInside:
    """Find where the views ended inside openings; 50 ms at 4 mm.

    Args:
        volume: fused from the views; its wall must be closed in each layer, or the layer counts as open.
        platform_height_m: of the support, in the base frame; what lies below it is not looked at.
    """
    first = (platform_height_m - volume.origin_m[2]) / volume.voxel_m
    first_layer = int(np.clip(np.ceil(first + 1), 0, volume.weight.shape[2] - 1))
    seen = volume.weight[:, :, first_layer:] > 0
    distance = volume.distance[:, :, first_layer:]
    solid = seen & (distance < 0)
    # Below a belly the outer side is hidden as well: what may be its wall parts inside and outside, too.
    outside = _outside_in_layer(solid | (~seen & volume.hidden[:, :, first_layer:]))
    enclosed = ~outside & ~solid
    free = seen & (distance > FREE_SHARE)
    frontier = enclosed & ~seen & binary_dilation(free & enclosed)
    frontier = large_groups(frontier, SMALLEST_PATCH_M2 / volume.voxel_m**2, ALL_NEIGHBOURS)
    region = _connected_to(frontier, enclosed & ~seen)
    looked_through = enclosed & seen
    if not region.any():
        nothing = np.zeros_like(region)
        return UnseenInside(
            outside, enclosed, looked_through, frontier, region, nothing, nothing, first_layer
        )
    any_way, within_layer = (1.0, 1.0, 1.0), (1.0, 1.0, _FAR_M / volume.voxel_m)
    asked = ((looked_through, any_way), (outside & seen, any_way), (outside, within_layer))
    inside_m, around_m, away_m = in_threads(lambda one: volume.voxel_m * _distance(*one), asked)
    # Joined to the region, and seen neither from the free space inside nor from around. A lid that was seen
    # from above was, as thin as it may be. Of a voxel as far away as the thinnest wall, half lies nearer.
    through_m = THINNEST_WALL_M + volume.voxel_m / 2
    unsure = solid & (inside_m > volume.behind_m) & (around_m > through_m)
    assumed = _connected_to(region, region | unsure) & unsure
    behind_walls = (region | assumed) & (away_m > through_m)
    return UnseenInside(
        outside, enclosed, looked_through, frontier, region, assumed, behind_walls, first_layer
    )


def _distance(free: BoolArray, lengths: tuple[float, float, float]) -> FloatArray:
    """Distance of each voxel from the free ones, infinite if there are none.

    Args:
        free: (X, Y, Z).
        lengths: of a voxel's edges.
    """
    if not free.any():
        return np.full(free.shape, np.inf)
    distance: FloatArray = distance_transform_edt(~free, sampling=lengths)
    return distance


def _outside_in_layer(solid: BoolArray) -> BoolArray:
    """What a flood from the border of each horizontal layer reaches, around the solid."""
    groups, _ = label(~solid, structure=IN_LAYER)
    border = [groups[0], groups[-1], groups[:, 0], groups[:, -1]]
    reached = np.unique(np.concatenate([edge.ravel() for edge in border]))
    outside: BoolArray = np.isin(groups, reached) & ~solid
    return outside


def _connected_to(seeds: BoolArray, mask: BoolArray) -> BoolArray:
    """The groups of `mask` that hold a seed."""
    groups, _ = label(mask)
    held: BoolArray = mask & np.isin(groups, np.unique(groups[seeds]))
    return held
