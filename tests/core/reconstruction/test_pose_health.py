from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.geometry import make_pose
from core.reconstruction import measure_pose_health, reconstruct
from core.reconstruction.truncation import choose_truncation_m

TABLE_M = 0.02


def test_right_poses_see_one_level_table(block_scan, parameters):
    health = measure_pose_health(block_scan.frames, block_scan.intrinsics, parameters)
    assert len(health.views) == len(block_scan.frames)
    assert health.mean_height_m == pytest.approx(TABLE_M, abs=5e-4)
    assert health.sd_height_m < 5e-4
    assert np.rad2deg(health.largest_tilt_rad) < 0.2


def test_a_lifted_and_tilted_view_is_found(block_scan, parameters, listener):
    frames = list(block_scan.frames)
    error = make_pose(np.eye(3), [0, 0, 0.03])
    frames[3] = replace(frames[3], T_base_camera=error @ frames[3].T_base_camera)
    scan = replace(block_scan, frames=tuple(frames))
    health = measure_pose_health(scan.frames, scan.intrinsics, parameters)
    assert health.views[3].height_m == pytest.approx(TABLE_M + 0.03, abs=1e-3)
    reconstruct(scan, parameters, listener)
    assert "frame-000003 by 30 mm" in listener.warnings[0]


def test_the_truncation_follows_the_pose_error(simulated, parameters):
    chosen = []
    for error_m in (0.0, 0.002, 0.005):
        scan = simulated("block", translation_error_m=error_m)
        health = measure_pose_health(scan.frames, scan.intrinsics, parameters)
        chosen.append(choose_truncation_m(parameters, health))
    fronts, behinds = zip(*chosen, strict=True)
    assert fronts[0] == pytest.approx(4 * parameters.voxel_m, abs=0.002)
    assert behinds[0] == pytest.approx(2.5 * parameters.voxel_m, abs=0.002)
    assert fronts[0] < fronts[1] < fronts[2] <= 0.03
    assert behinds[0] < behinds[1] < behinds[2]
    assert all(behind <= front for front, behind in chosen)


def test_without_a_table_nothing_is_said_and_the_truncation_is_the_released_codes(simulated, parameters):
    scan = simulated("block", table=False)
    health = measure_pose_health(scan.frames, scan.intrinsics, parameters)
    assert health.mean_height_m is None and health.sd_height_m is None and health.largest_tilt_rad is None
    assert choose_truncation_m(parameters, health) == pytest.approx([5 * parameters.voxel_m] * 2)


def test_a_set_truncation_stays(block_scan, parameters):
    fixed = parameters.model_copy(update={"truncation_m": 0.017})
    health = measure_pose_health(block_scan.frames, block_scan.intrinsics, fixed)
    assert choose_truncation_m(fixed, health) == (0.017, 0.017)
