"""What noise does to a floor that lies on the support."""

import numpy as np
import pytest

from core.mesh import TriangleMesh
from core.mesh_topology import topology
from core.reconstruction.floor import FLOOR_VOXELS, THINNEST_M, keep_floor, seen_floor
from core.reconstruction.segmentation import cut_at_height, whole
from core.reconstruction.tsdf import TsdfVolume, extract_surface

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


def surface_of(volume: TsdfVolume, true_m: np.ndarray) -> tuple[TriangleMesh, TriangleMesh]:
    """The surface over a floor whose inside was measured at `true_m` (x, y): as kept, and as lowered."""
    volume.distance[:] = solid_below(volume, true_m)
    volume.weight[:] = 1
    kept = keep_floor(volume.distance, volume, whole(volume), SUPPORT_M, 0.002)
    cut = cut_at_height(kept, volume, whole(volume), SUPPORT_M)
    mesh = extract_surface(cut, volume.origin_m, VOXEL_M)
    return mesh, seen_floor(volume, whole(volume), SUPPORT_M, 0.002).lowered(mesh)


def thickness_m(mesh: TriangleMesh) -> np.ndarray:
    """Of the floor in its middle."""
    middle = (np.abs(mesh.vertices_m[:, :2] - 0.02) < 0.012).all(axis=1)
    heights_m = mesh.vertices_m[middle, 2] - SUPPORT_M
    return heights_m[heights_m > VOXEL_M / 4]


@pytest.mark.parametrize("true_m", [0.0013, 0.0016, 0.0022])
def test_a_floor_thinner_than_its_voxels_is_as_thick_as_it_was_seen(volume, true_m):
    noise_m = np.random.default_rng(1).normal(0.0, 0.0002, volume.distance.shape[:2])
    kept, lowered = surface_of(volume, SUPPORT_M + true_m + noise_m)
    assert np.median(thickness_m(kept)) > 0.0026
    assert thickness_m(lowered) == pytest.approx(true_m, abs=0.0004)
    assert topology(lowered).n_open == 0
    assert lowered.volume_m3 < kept.volume_m3


def test_a_floor_seen_below_the_support_keeps_a_least_thickness(volume):
    _, lowered = surface_of(volume, np.full(volume.distance.shape[:2], SUPPORT_M - 0.001))
    assert thickness_m(lowered) == pytest.approx(THINNEST_M, abs=1e-6)


def test_a_floor_that_no_view_saw_is_not_lowered(volume):
    shape = volume.distance.shape[:2]
    volume.distance[:] = solid_below(volume, np.full(shape, SUPPORT_M + 0.0015))
    volume.weight[:] = 0
    assert np.isnan(seen_floor(volume, whole(volume), SUPPORT_M, 0.002).heights_m).all()
