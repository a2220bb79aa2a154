from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.quality.cavity import find_hidden_cavity
from core.quality.plain_fusion import coarse_volume
from core.scan import CropBox
from hardware.simulation.objects import builtin_object
from tests.core.quality.studio import BOX, FEW_RINGS, PLATFORM_M, VOXEL_M, on_platform, shaft, upside_down


@pytest.mark.parametrize("name", ["block", "plate", "mug", "bowl upside down"])
def test_no_hidden_cavity_where_there_is_none(name, mug_scan):
    mesh = upside_down(builtin_object("bowl")) if "bowl" in name else builtin_object(name)
    scan = mug_scan if name == "mug" else on_platform(mesh).scan(FEW_RINGS)
    cavity = find_hidden_cavity(coarse_volume(scan, BOX), PLATFORM_M)
    assert (len(cavity.frontier_m), len(cavity.region)) == (0, 0)
    assert cavity.area_m2 == cavity.volume_ml == cavity.depth_m == cavity.width_m == 0


def test_a_vase_hides_its_inside(vase, vase_scan):
    cavity = find_hidden_cavity(coarse_volume(vase_scan, BOX), PLATFORM_M)
    low, high = vase.mesh.aabb_min_m, vase.mesh.aabb_max_m
    assert ((cavity.frontier_m > low) & (cavity.frontier_m < high)).all()
    assert cavity.area_m2 > 1e-3 and cavity.volume_ml > 150
    assert cavity.width_m == pytest.approx(0.040, abs=0.008)
    assert 0.02 < cavity.depth_m < 0.15


def test_area_volume_depth_and_width_of_a_shaft():
    cavity = find_hidden_cavity(shaft(), platform_height_m=0.02)
    assert len(cavity.frontier_m) == 11 * 11
    assert cavity.area_m2 == pytest.approx(121 * VOXEL_M**2)
    assert np.allclose(cavity.frontier_m[:, 2], 0.096)
    assert cavity.depth_m == pytest.approx(0.12 - 0.096)
    assert cavity.width_m == pytest.approx(np.sqrt(4 / np.pi) * 0.044)
    layers = (0.096 - 0.024) / VOXEL_M + 1
    assert cavity.volume_ml == pytest.approx(121 * layers * VOXEL_M**3 * 1e6)


def test_what_lies_below_the_platform_does_not_count():
    assert len(find_hidden_cavity(shaft(), platform_height_m=0.1).frontier_m) == 0


def test_a_shaft_open_to_one_side_encloses_nothing():
    volume = shaft()
    volume.distance[15:, 15, :] = 1.0
    assert len(find_hidden_cavity(volume, platform_height_m=0.02).frontier_m) == 0


def test_a_gap_of_the_noise_is_no_cavity():
    volume = shaft(unseen_below_m=0.0)
    volume.weight[14:16, 14:16, 10:11] = 0
    assert len(find_hidden_cavity(volume, platform_height_m=0.02).frontier_m) == 0


def test_a_scan_is_fused_coarsely_once_for_each_box(mug_scan):
    volume = coarse_volume(mug_scan, BOX)
    assert coarse_volume(mug_scan, BOX) is volume
    assert coarse_volume(replace(mug_scan), BOX) is not volume
    smaller = CropBox(BOX.min_m, (BOX.max_m[0], BOX.max_m[1], BOX.max_m[2] - 0.1))
    assert coarse_volume(mug_scan, smaller).weight.shape[2] < volume.weight.shape[2]
