"""The box of what a few views saw on the platform."""

from __future__ import annotations

import numpy as np
import pytest

from core.quality.object_box import ObjectBox, find_object_box
from core.reconstruction.tsdf import TsdfVolume
from core.scan.model import CropBox

VOXEL_M = 0.004
LOW_M = np.array([-0.34, -0.59, 0.03])
SPACE = CropBox((-0.30, -0.55, 0.03), (0.18, -0.15, 0.50))
PLATFORM_M = 0.08


def volume_with(*boxes_m: tuple[tuple[float, float, float], tuple[float, float, float]]) -> TsdfVolume:
    """A volume whose surface voxels fill boxes."""
    volume = TsdfVolume(LOW_M, (0.22, -0.11, 0.54), VOXEL_M, 4 * VOXEL_M)
    for low_m, high_m in boxes_m:
        low, high = (np.round((np.array(corner) - LOW_M) / VOXEL_M).astype(int) for corner in (low_m, high_m))
        block = tuple(slice(a, b + 1) for a, b in zip(low, high, strict=True))
        volume.distance[block] = 0.0
        volume.weight[block] = 1
    return volume


def found(volume: TsdfVolume) -> ObjectBox:
    box = find_object_box(volume, PLATFORM_M, SPACE)
    assert box is not None
    return box


CUBE = ((-0.10, -0.40, 0.10), (0.00, -0.30, 0.20))


def test_the_box_reaches_from_the_platform_to_the_highest_surface():
    box = found(volume_with(CUBE))
    assert box.min_m == pytest.approx([-0.10, -0.40, PLATFORM_M], abs=1.1 * VOXEL_M)
    assert box.max_m == pytest.approx([0.00, -0.30, 0.20], abs=1.1 * VOXEL_M)


def test_isolated_points_and_what_is_below_the_platform_do_not_count():
    speck = ((0.10, -0.20, 0.40), (0.11, -0.19, 0.41))
    table = ((-0.34, -0.59, 0.034), (0.20, -0.12, 0.042))
    assert found(volume_with(CUBE, speck, table)).max_m == pytest.approx(
        [0.00, -0.30, 0.20], abs=1.1 * VOXEL_M
    )


def test_all_things_on_the_platform_count():
    post = ((0.06, -0.24, 0.10), (0.08, -0.22, 0.30))
    assert found(volume_with(CUBE, post)).max_m == pytest.approx([0.08, -0.22, 0.30], abs=1.1 * VOXEL_M)


def test_what_reaches_beyond_the_space_is_seen_and_what_stands_beside_it_is_not():
    beam = ((-0.10, -0.40, 0.10), (0.21, -0.36, 0.14))
    assert not found(volume_with(beam)).is_within(SPACE)
    neighbour = ((-0.10, -0.135, 0.10), (0.10, -0.12, 0.30))
    assert found(volume_with(CUBE, neighbour)).is_within(SPACE)


def test_an_empty_platform_has_no_box():
    assert find_object_box(volume_with(), PLATFORM_M, SPACE) is None
