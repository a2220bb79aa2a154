"""How much water, and how much of anything as thick as a candy, an object at rest holds: geometry alone.

Imported by workers alone, for it loads numba.
"""

from __future__ import annotations

from math import ceil, pi

import numpy as np

from core.geometry import BoolArray, FloatArray, IntArray
from core.imagination.capacity.basin import ML, Basin
from core.imagination.capacity.stand_in import NOWHERE, Surroundings
from core.imagination.hollow_map import HollowMap
from core.lattice import FLATNESS, Lattice, held_centers, lattice_of, spill_layers
from core.mesh import TriangleMesh
from core.voxel_groups import large_groups

_MOUTH_LAYERS = 12
_NEAR = 1.5
"""Water within so many half thicknesses of a candy's centre is where candies are."""
_BESIDE, _BESIDE_PITCHES = 1.3, 1.2
"""So far, likewise, where it is not known to hold water; and so many pitches beyond a ball if a wall is next,
for a coarse lattice leaves so much beside it. More would run out of a basket's openings."""


def find_basin(mesh: TriangleMesh, thickness_m: float, smallest_ml: float, points: int) -> Basin:
    """Pour water, and candies without friction, into a mesh at rest.

    Args:
        mesh: any surface, open or closed; its upward axis is z. Below its lowest point is outside.
        thickness_m: of a candy.
        smallest_ml: of a hollow that counts.
        points: of the lattice, about; the result's error goes with its pitch.
    """
    lattice = lattice_of(mesh, points, thickness_m)
    layers = np.arange(lattice.shape[2])
    spill = spill_layers(lattice, np.zeros(lattice.shape, dtype=np.bool_))
    water = large_groups(spill > layers, smallest_ml / ML / lattice.cell_m3)
    candies, rims_m = _candies(lattice, water, thickness_m / 2, smallest_ml / ML / lattice.cell_m3)
    heights, volumes = _curve(lattice, candies)
    return Basin(
        water_ml=float(water.sum() * lattice.cell_m3 * ML),
        water_level_m=_main_level(lattice, spill, water),
        rim_m=_most_common(rims_m[candies]),
        heights_m=heights,
        volumes_ml=volumes,
        around=_surroundings(lattice, candies),
        mouth_m=_mouth_m(lattice, candies),
        narrow_ml=float((water & ~candies).sum() * lattice.cell_m3 * ML),
        hollow_map=_map(lattice, candies, rims_m),
    )


def _map(lattice: Lattice, held: BoolArray, rims_m: FloatArray) -> HollowMap:
    is_open: BoolArray = np.any(held & ~lattice.below_surface(), axis=2)
    return HollowMap(
        origin_m=lattice.origin_m[:2],
        pitch_m=float(lattice.pitch_m[0]),
        rim_m=np.where(held, rims_m, -np.inf).max(axis=2),
        floor_m=np.where(held, lattice.heights_m, np.inf).min(axis=2),
        is_open=is_open,
    )


def _candies(
    lattice: Lattice, water: BoolArray, radius_m: float, fewest: float
) -> tuple[BoolArray, FloatArray]:
    """Return the points (X, Y, Z) that a sphere in the hollows reaches, and the height of each one's rim."""
    from scipy.ndimage import distance_transform_edt

    pitch = lattice.pitch_m.tolist()
    centers, spill = held_centers(lattice, radius_m)
    if not centers.any():
        return centers, np.full(lattice.shape, -np.inf)
    away, nearest = distance_transform_edt(~centers, sampling=pitch, return_indices=True)
    # A sphere runs over when its centre is its radius above the rim.
    rims_m = lattice.heights_m[spill[tuple(nearest)]] - radius_m - pitch[2] / 2
    below_rim = lattice.heights_m < rims_m
    near = (away < _NEAR * radius_m) & below_rim
    touched = (away < radius_m) & below_rim
    reached = touched | _beside(lattice, touched, away, radius_m, rims_m) | (water & near)
    return large_groups(reached, fewest), rims_m


def _beside(
    lattice: Lattice, touched: BoolArray, away: FloatArray, radius_m: float, rims_m: FloatArray
) -> BoolArray:
    """Return the points (X, Y, Z) between balls and a wall that no face parts from where balls reach.

    A scan's wall is rough, and one with a pinhole holds no water that would tell what lies beside a ball. Not
    in the uppermost layers, where points are joined over the rim.
    """
    pitch = lattice.pitch_m.tolist()
    below_rim = lattice.heights_m < rims_m - 2 * pitch[2]
    within = (away < _BESIDE * radius_m) & below_rim
    at_wall = (away < radius_m + _BESIDE_PITCHES * pitch[0]) & below_rim
    held: BoolArray = touched & within
    layers = round(1 / FLATNESS)
    for axis in (0, 1, *(2,) * layers) * ceil((_BESIDE - 1) * radius_m / pitch[0]):
        parted = np.moveaxis(lattice.parted[axis], axis, 0)
        line, room, wall = (np.moveaxis(one, axis, 0) for one in (held, within, at_wall))
        up = line[:-1] & ~parted[:-1] & (room[1:] | wall[1:] & parted[1:])
        down = line[1:] & ~parted[:-1] & room[:-1]
        down[1:] |= line[2:] & ~parted[1:-1] & wall[1:-1] & parted[:-2]
        line[1:] |= up
        line[:-1] |= down
    return held


def _most_common(values: FloatArray) -> float:
    """The value that most have; NaN of none."""
    if not len(values):
        return float("nan")
    found, counts = np.unique(values, return_counts=True)
    return float(found[counts.argmax()])


def _curve(lattice: Lattice, held: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Heights (K,), from floor to rim, and the volume (K,) in ml below each."""
    areas = held.sum(axis=(0, 1))
    used = np.flatnonzero(areas)
    if not len(used):
        return np.empty(0), np.empty(0)
    first, last = int(used[0]), int(used[-1])
    heights = lattice.heights_m[0] + lattice.pitch_m[2] * (np.arange(first, last + 2) - 0.5)
    points = np.concatenate([[0], np.cumsum(areas[first : last + 1])])
    return heights, points * lattice.cell_m3 * ML


def _main_level(lattice: Lattice, spill: IntArray, water: BoolArray) -> float:
    """Height at which most of the water runs over."""
    if not water.any():
        return float("nan")
    layer = int(np.bincount(spill[water]).argmax())
    return float(lattice.heights_m[layer] - lattice.pitch_m[2] / 2)


def _surroundings(lattice: Lattice, held: BoolArray) -> Surroundings:
    """Floor and walls beside points; of upright walls seen along x and y, whichever way they are turned."""
    if not held.any():
        return NOWHERE
    x, y, z = lattice.pitch_m
    seen = [
        int((parted & held).sum() + (lattice.before(axis) & held).sum())
        for axis, parted in enumerate(lattice.parted)
    ]
    side_m2 = pi / 4 * (seen[0] * y * z + seen[1] * x * z)
    return Surroundings(float(held.sum()) * lattice.cell_m3, seen[2] * x * y, side_m2)


def _mouth_m(lattice: Lattice, held: BoolArray) -> float:
    """Width of the narrowest layer among those that lie above half of the volume; zero without volume."""
    from scipy.ndimage import distance_transform_edt

    above = np.cumsum(held.sum(axis=(0, 1))[::-1])[::-1]
    used = np.flatnonzero((above > 0) & (above <= max(above[0] / 2, 1)))
    if not len(used):
        return 0.0
    used = used[: max(len(used) - 1, 1)]  # the uppermost may be cut by a slanting rim
    layers = used[:: max(len(used) // _MOUTH_LAYERS, 1)]
    return float(min(2 * distance_transform_edt(held[:, :, k]).max() for k in layers) * lattice.pitch_m[0])
