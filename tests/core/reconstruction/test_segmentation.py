"""What noise does to a floor that lies on the support."""

import numpy as np
import pytest

from core.reconstruction.segmentation import FLOOR_VOXELS, cut_at_height, keep_floor, whole
from core.reconstruction.tsdf import TsdfVolume

VOXEL_M = 0.002
SUPPORT_M = 0.1


@pytest.fixture
def volume() -> TsdfVolume:
    return TsdfVolume((0.0, 0.0, 0.08), (0.04, 0.04, 0.14), VOXEL_M, 0.008, 0.006, 0.002)


def solid_below(volume: TsdfVolume, heights_m: np.ndarray) -> np.ndarray:
    """Distances of a floor whose inside was measured at `heights_m` (x, y), solid below."""
    z = volume.origin_m[2] + VOXEL_M * np.arange(volume.distance.shape[2])
    return np.clip((z - heights_m[:, :, None]) / volume.truncation_m, -1, 1).astype(np.float32)


def floor_of(volume: TsdfVolume, distance: np.ndarray) -> np.ndarray:
    """Whether each column (x, y) is closed after the cut."""
    kept = keep_floor(distance, volume, whole(volume), SUPPORT_M, 0.002)
    cut = cut_at_height(kept, volume, whole(volume), SUPPORT_M)
    return np.any(cut < 0, axis=2)


def test_a_floor_measured_around_the_support_is_whole(volume):
    shape = volume.distance.shape[:2]
    noisy_m = SUPPORT_M + np.random.default_rng(0).uniform(-0.0018, 0.001, shape)
    distance = solid_below(volume, noisy_m)
    assert floor_of(volume, distance).all()
    assert not np.any(cut_at_height(distance, volume, whole(volume), SUPPORT_M) < 0, axis=2).all()


def test_where_the_table_was_seen_there_is_no_floor(volume):
    shape = volume.distance.shape[:2]
    heights_m = np.full(shape, SUPPORT_M)
    heights_m[5:10, 5:10] = 0.085  # seen through: free down to there
    is_closed = floor_of(volume, solid_below(volume, heights_m))
    assert not is_closed[5:10, 5:10].any()
    assert is_closed[12:, 12:].all()


def test_a_thick_floor_stays_as_it_is(volume):
    shape = volume.distance.shape[:2]
    distance = solid_below(volume, np.full(shape, SUPPORT_M + 0.01))
    kept = keep_floor(distance, volume, whole(volume), SUPPORT_M, 0.002)
    above = volume.origin_m[2] + VOXEL_M * np.arange(distance.shape[2]) > SUPPORT_M + FLOOR_VOXELS * VOXEL_M
    assert np.array_equal(kept[:, :, above], distance[:, :, above])
