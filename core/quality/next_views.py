"""Where to look again (the paper's future work): the views that reveal most of a hidden cavity.

A structured-light camera measures a point that it sees, that its projector lights, that is not too near and
not seen at a grazing angle. A pixel with a depth frees everything before it. So the ray through each unseen
voxel is followed to what must stop it, a known wall or the platform; if nothing is before the voxel and that
end could be measured, it would be revealed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, radians

import numba
import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter

from core.geometry import BoolArray, FloatArray, IntArray
from core.reconstruction.tsdf import TsdfVolume
from core.scan.model import Intrinsics
from core.threads import in_threads

SMALLEST_SHARE = 0.02
"""A further view must reveal this share of the hidden region, ..."""
FEWEST_VOXELS = 10
"""... and this many voxels."""
BOTTOM_VOXELS = 3.0
"""How high above the platform the unseen may be a hole in the bottom, ..."""
BOTTOM_WORTH = 10
"""... and how many other voxels such a one is worth."""
WALL_VOXELS = 2.0
"""How far behind a seen surface its wall is taken for known; deeper a view only assumes."""
NORMAL_BLUR_VOXELS = 1.5
PADDING_VOXELS = 6
PARALLEL = 1e-12
"""What a ray runs at least along each axis, in voxels; it spares the case of the parallel ray."""


@dataclass(frozen=True)
class DepthCamera:
    """What a structured-light camera can measure.

    Attributes:
        intrinsics: of its depth image.
        width_px, height_px: of that image.
        baseline_m: the projector's place along +x of the camera.
        min_range_m: nothing nearer has a depth.
        max_incidence_rad: nothing seen at a flatter angle has one.
    """

    intrinsics: Intrinsics
    width_px: int
    height_px: int
    baseline_m: float = 0.075
    min_range_m: float = 0.35
    max_incidence_rad: float = radians(78)


@dataclass(frozen=True)
class ProposedView:
    """A candidate and how many unseen voxels it reveals that the ones proposed before it do not."""

    index: int
    n_revealed_voxels: int


@dataclass(frozen=True)
class _Scene:
    """The volume from a little below a cavity up.

    Attributes:
        origin_m: (3,) lower corner of its first voxel.
        wall: (X, Y, Z) what stops light.
        normals: (X, Y, Z, 3) float32, of the wall's surface; zero deep within.
    """

    origin_m: FloatArray
    wall: BoolArray
    normals: npt.NDArray[np.float32]


def propose_views(
    volume: TsdfVolume,
    region: IntArray,
    platform_height_m: float,
    candidates: FloatArray,
    camera: DepthCamera,
    most: int,
    can_take: Callable[[int], bool] = lambda _index: True,
) -> tuple[ProposedView, ...]:
    """Choose up to `most` of the candidates `T_base_camera` (N, 4, 4), each for what it adds.

    Stops where a view adds less than 2 % of the hidden region; nothing hidden, or nothing that any candidate
    could reveal, gives an empty answer. `can_take` is asked of those alone that would be chosen, and one that
    it refuses is left out.
    """
    if len(region) == 0 or len(candidates) == 0:
        return ()
    revealed = revealed_voxels(volume, region, platform_height_m, candidates, camera)
    is_bottom = bottom_of(volume, region, platform_height_m)
    all_of_it = worth_of(np.ones((1, len(is_bottom)), dtype=np.bool_), is_bottom)[0]
    least = max(SMALLEST_SHARE * all_of_it, FEWEST_VOXELS)
    chosen: list[ProposedView] = []
    while len(chosen) < most:
        gains = worth_of(revealed, is_bottom)
        best = int(gains.argmax())
        if gains[best] < least:
            break
        if can_take(best):
            chosen.append(ProposedView(best, int(revealed[best].sum())))
            revealed &= ~revealed[best]
        else:
            revealed[best] = False
    return tuple(chosen)


def sample_of(region: IntArray, most: int) -> IntArray:
    """Return every voxel of a region (M, 3), or `most` that stand for all, evenly."""
    return region if len(region) <= most else region[np.linspace(0, len(region) - 1, most).astype(int)]


def bottom_of(volume: TsdfVolume, region: IntArray, platform_height_m: float) -> BoolArray:
    """Which voxels (M,) of a region (M, 3) lie where a hole in the bottom would be."""
    above_m = volume.centers_m(region)[:, 2] - platform_height_m
    return np.asarray(above_m < BOTTOM_VOXELS * volume.voxel_m)


def worth_of(revealed: BoolArray, is_bottom: BoolArray) -> IntArray:
    """What each view (N,) is worth that reveals voxels (N, M): one each, more at the bottom (M,)."""
    return np.asarray(revealed.sum(axis=1) + (BOTTOM_WORTH - 1) * revealed[:, is_bottom].sum(axis=1))


def revealed_voxels(
    volume: TsdfVolume,
    region: IntArray,
    platform_height_m: float,
    candidates: FloatArray,
    camera: DepthCamera,
) -> BoolArray:
    """Which voxels (M, 3) of a hidden region each candidate (N, 4, 4) would reveal: (N, M).

    About 0.6 us a voxel and candidate on one processor.
    """
    scene = _scene(volume, region, platform_height_m)
    revealed = np.zeros((len(candidates), len(region)), dtype=np.bool_)
    middles = (volume.centers_m(region) - scene.origin_m) / volume.voxel_m

    def look(k: int) -> None:
        _reveal(
            scene.wall,
            scene.normals,
            middles,
            scene.origin_m,
            volume.voxel_m,
            np.ascontiguousarray(candidates[k], dtype=float),
            camera.intrinsics.matrix,
            np.array([camera.width_px, camera.height_px]),
            camera.baseline_m,
            camera.min_range_m,
            cos(camera.max_incidence_rad),
            revealed[k],
        )

    in_threads(look, range(len(candidates)))
    return revealed


def _scene(volume: TsdfVolume, region: IntArray, platform_height_m: float) -> _Scene:
    # All around and up to the top: the wall on the other side and a rim above throw their shadows into it.
    low = np.array([0, 0, max(int(region[:, 2].min()) - PADDING_VOXELS, 0)])
    block = (slice(None), slice(None), slice(int(low[2]), None))
    depth_voxels = -volume.distance[block] * (volume.truncation_m / volume.voxel_m)
    wall = (volume.weight[block] > 0) & (depth_voxels > 0) & (depth_voxels < WALL_VOXELS)
    platform_layer = round((platform_height_m - volume.origin_m[2]) / volume.voxel_m) - int(low[2])
    wall[:, :, : max(0, platform_layer)] = True
    blurred = gaussian_filter(wall.astype(np.float32), NORMAL_BLUR_VOXELS)
    normals = np.stack([np.gradient(blurred, axis=axis) for axis in range(3)], axis=-1)
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-6)
    return _Scene(volume.centers_m(low) - volume.voxel_m / 2, wall, normals)


@numba.njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _reveal(
    wall: BoolArray,
    normals: npt.NDArray[np.float32],
    middles: FloatArray,
    origin_m: FloatArray,
    voxel_m: float,
    pose: FloatArray,
    matrix: FloatArray,
    size_px: IntArray,
    baseline_m: float,
    min_range_m: float,
    least_facing: float,
    revealed: BoolArray,
) -> None:
    """Mark which voxels, at `middles` (M, 3) in voxels from the scene's corner, one view reveals."""
    eye = (pose[:3, 3] - origin_m) / voxel_m
    projector = (pose[:3, 3] + baseline_m * pose[:3, 0] - origin_m) / voxel_m
    for m in range(len(middles)):
        ray = middles[m] - eye
        depth_m = voxel_m * (pose[:3, 2] * ray).sum()
        if depth_m <= 0:
            continue
        column = matrix[0, 0] * voxel_m * (pose[:3, 0] * ray).sum() / depth_m + matrix[0, 2]
        row = matrix[1, 1] * voxel_m * (pose[:3, 1] * ray).sum() / depth_m + matrix[1, 2]
        if not (0 <= column < size_px[0] and 0 <= row < size_px[1]):
            continue
        if _march(wall, middles[m], -ray, 1.0)[0] != np.inf:
            continue  # something is before it
        further, i, j, k = _march(wall, middles[m], ray, np.inf)
        if further == np.inf or depth_m * (1 + further) < min_range_m:
            continue
        length = np.sqrt((ray * ray).sum())
        if abs((normals[i, j, k] * ray).sum()) < least_facing * length:
            continue
        # A little before the wall, so that it does not shade itself.
        end = middles[m] + (further - 0.5 / length) * ray
        revealed[m] = _march(wall, end, projector - end, 1.0)[0] == np.inf


@numba.njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _march(
    wall: BoolArray, start: FloatArray, ray: FloatArray, longest: float
) -> tuple[float, int, int, int]:
    """Follow a ray, in voxels, to the first wall (Amanatides and Woo 1987).

    Returns the length to it in lengths of the ray (infinite if there is none), and the wall's voxel.
    """
    length, last = 0.0, longest
    for axis in range(3):
        slope = ray[axis] if abs(ray[axis]) > PARALLEL else PARALLEL
        one, other = -start[axis] / slope, (wall.shape[axis] - start[axis]) / slope
        length, last = max(length, min(one, other)), min(last, max(one, other))
    i, to_i, per_i, step_i = _first_step(start[0], ray[0], length, wall.shape[0])
    j, to_j, per_j, step_j = _first_step(start[1], ray[1], length, wall.shape[1])
    k, to_k, per_k, step_k = _first_step(start[2], ray[2], length, wall.shape[2])
    while length < last and 0 <= i < wall.shape[0] and 0 <= j < wall.shape[1] and 0 <= k < wall.shape[2]:
        if wall[i, j, k]:
            return length, i, j, k
        length = min(to_i, to_j, to_k)
        if length == to_i:
            i, to_i = i + step_i, to_i + per_i
        elif length == to_j:
            j, to_j = j + step_j, to_j + per_j
        else:
            k, to_k = k + step_k, to_k + per_k
    return np.inf, 0, 0, 0


@numba.njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _first_step(start: float, slope: float, length: float, size: int) -> tuple[int, float, float, int]:
    """Along one axis: the voxel, the lengths to the next one and between two, and the index step."""
    slope = slope if abs(slope) > PARALLEL else PARALLEL
    voxel = min(max(int(np.floor(start + length * slope)), 0), size - 1)
    step = 1 if slope > 0 else -1
    return voxel, (voxel + (step > 0) - start) / slope, abs(1.0 / slope), step
