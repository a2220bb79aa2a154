from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.errors import StageError
from core.geometry import look_at
from core.reconstruction import tsdf
from core.reconstruction.tsdf import TsdfVolume
from core.scan import Intrinsics, RgbdFrame

CAMERA = Intrinsics(200.0, 200.0, 49.5, 39.5)


def wall(distance_m: float, name: str = "frame-000000") -> RgbdFrame:
    """A wall that fills the image, seen from the origin along +x."""
    depth_m = np.full((80, 100), distance_m, dtype=np.float32)
    return RgbdFrame(name, np.zeros((80, 100, 3), np.uint8), depth_m, look_at([0, 0, 0], [1, 0, 0]))


@pytest.fixture
def volume() -> TsdfVolume:
    return TsdfVolume((0.4, -0.05, -0.05), (0.6, 0.05, 0.05), 0.005, 0.02)


def test_distance_rises_linearly_towards_the_camera_within_the_truncation(volume):
    volume.integrate(wall(0.499), CAMERA, 6.0)
    x_m = 0.4 + 0.005 * np.arange(40)
    seen = x_m < 0.519
    expected = np.where(seen, np.clip((0.499 - x_m) / 0.02, -1, 1), 1.0)
    assert volume.distance[:, 10, 10] == pytest.approx(expected, abs=1e-4)
    assert (volume.weight[:, 10, 10] > 0).tolist() == seen.tolist()
    assert volume.hidden[:, 10, 10].tolist() == (~seen).tolist()


def test_views_are_averaged(volume):
    for distance_m in (0.498, 0.502, 0.503):
        volume.integrate(wall(distance_m), CAMERA, 6.0)
    assert volume.weight[20, 10, 10] == 3
    assert volume.distance[20, 10, 10] == pytest.approx(0.001 / 0.02, abs=1e-4)


def test_the_mesh_grows_view_by_view_and_starts_empty(volume):
    assert len(volume.mesh().faces) == 0
    volume.integrate(wall(0.5), CAMERA, 6.0)
    first = volume.mesh()
    assert len(first.faces) > 0
    assert first.aabb_min_m[0] == pytest.approx(0.5, abs=1e-3)
    volume.integrate(wall(0.49), CAMERA, 6.0)
    assert volume.mesh().aabb_min_m[0] == pytest.approx(0.495, abs=1e-3)


def test_no_measurement_and_far_depth_say_nothing(volume):
    volume.integrate(wall(0.0), CAMERA, 6.0)
    volume.integrate(wall(0.5), CAMERA, 0.45)
    assert not volume.weight.any()
    assert not volume.hidden.any()


def test_the_order_of_views_changes_rounding_only(volume):
    distances = [0.49, 0.5, 0.505]
    other = TsdfVolume((0.4, -0.05, -0.05), (0.6, 0.05, 0.05), 0.005, 0.02)
    for distance_m in distances:
        volume.integrate(wall(distance_m), CAMERA, 6.0)
    for distance_m in reversed(distances):
        other.integrate(wall(distance_m), CAMERA, 6.0)
    assert np.array_equal(volume.weight, other.weight)
    assert volume.distance == pytest.approx(other.distance, abs=1e-5)


def test_a_grid_that_fits_no_memory_names_the_voxel():
    with pytest.raises(StageError, match=r"1000 million voxels of 1 mm.*reconstruction\.voxel_m"):
        TsdfVolume((0, 0, 0), (1, 1, 1), 0.001, 0.02)


def test_behind_the_surface_a_view_counts_only_as_far_as_it_may(volume):
    short = TsdfVolume((0.4, -0.05, -0.05), (0.6, 0.05, 0.05), 0.005, 0.02, 0.008)
    for each in (volume, short):
        each.integrate(wall(0.499), CAMERA, 6.0)
    x_m = 0.4 + 0.005 * np.arange(40)
    front = x_m < 0.499
    assert (short.distance[front, 10, 10] == volume.distance[front, 10, 10]).all()
    assert (short.weight[:, 10, 10] > 0).tolist() == (x_m < 0.507).tolist()
    assert short.hidden[:, 10, 10].tolist() == (x_m > 0.507).tolist()


def test_however_many_slabs_threads_fuse_the_result_is_the_same(volume, monkeypatch):
    whole = TsdfVolume((0.4, -0.05, -0.05), (0.6, 0.05, 0.05), 0.005, 0.02)
    volume.integrate(wall(0.499), CAMERA, 6.0)
    monkeypatch.setattr(tsdf, "SLABS", 1)
    whole.integrate(wall(0.499), CAMERA, 6.0)
    for name in ("distance", "evidence", "weight", "hidden"):
        assert (getattr(volume, name) == getattr(whole, name)).all()
    assert whole.weight.any()


def seen_from_both_sides(thickness_m: float, falloff_m: float) -> float:
    """How thick a wall comes out that one view sees from -x and one from +x."""
    volume = TsdfVolume((0.44, -0.05, -0.05), (0.56, 0.05, 0.05), 0.002, 0.016, 0.012, falloff_m)
    front = wall(0.5 - thickness_m / 2)
    opposite = look_at([1, 0, 0], [0, 0, 0])
    for frame in (front, replace(front, T_base_camera=opposite)):
        volume.integrate(frame, CAMERA, 6.0)
    x_m, inside = 0.44 + 0.002 * np.arange(60), volume.distance[:, 25, 25] < 0
    return float(np.ptp(x_m[inside])) + 0.002 if inside.any() else 0.0


def test_a_falloff_keeps_a_thin_wall_thin():
    assert seen_from_both_sides(0.003, 0.002) == pytest.approx(0.003, abs=0.0021)
    assert seen_from_both_sides(0.003, np.inf) > 0.01


def test_facing_makes_depth_a_distance_along_the_normal(volume):
    depth_m = wall(0.5)
    volume.integrate(depth_m, CAMERA, 6.0, np.full((80, 100), 0.5, dtype=np.float32))
    assert volume.distance[18, 10, 10] == pytest.approx(0.5 * 0.01 / 0.02, abs=1e-4)
    assert volume.evidence[18, 10, 10] == pytest.approx(0.5)
    assert volume.weight[18, 10, 10] == 1


def test_a_wall_without_thickness_does_not_vanish():
    """Each side's views say "free" where the other's say "solid": between them the wall must win."""
    volume = TsdfVolume((0.44, -0.04, -0.04), (0.56, 0.04, 0.04), 0.002, 0.012, 0.006, 0.0024)
    random = np.random.default_rng(0)
    for view in range(16):
        frame = wall(0.5)
        noisy_m = (frame.depth_m + random.normal(0, 0.001, frame.depth_m.shape)).astype(np.float32)
        pose = frame.T_base_camera if view % 2 else look_at([1, 0, 0], [0, 0, 0])
        volume.integrate(replace(frame, depth_m=noisy_m, T_base_camera=pose), CAMERA, 6.0)
    inside = volume.distance < 0
    assert np.any(inside, axis=0).mean() > 0.99
    assert inside.sum(axis=0).max() * 0.002 < 0.009
