from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.geometry import make_pose
from core.parameters.reconstruction import ReconstructionParameters
from core.reconstruction.fusion import Truncation, choose_truncation, view_error_m
from core.reconstruction.pose_health import PoseHealth, find_tables, pose_health_of
from core.reconstruction.stage import reconstruct
from core.scan import Scan, crop_box_of

TABLE_M = 0.02


def measure_pose_health(scan: Scan, parameters: ReconstructionParameters) -> PoseHealth:
    return pose_health_of(scan, find_tables(scan, parameters), crop_box_of(scan, parameters))


def test_right_poses_see_one_level_table(block_scan, parameters):
    health = measure_pose_health(block_scan, parameters)
    assert len(health.views) == len(block_scan.frames)
    assert health.mean_height_m == pytest.approx(TABLE_M, abs=5e-4)
    assert health.sd_height_m < 5e-4
    assert np.rad2deg(health.largest_tilt_rad) < 0.2


def test_a_lifted_and_tilted_view_is_found(block_scan, parameters, listener):
    frames = list(block_scan.frames)
    error = make_pose(np.eye(3), [0, 0, 0.03])
    frames[3] = replace(frames[3], T_base_camera=error @ frames[3].T_base_camera)
    scan = replace(block_scan, frames=tuple(frames))
    health = measure_pose_health(scan, parameters)
    assert health.views[3].height_m == pytest.approx(TABLE_M + 0.03, abs=1e-3)
    reconstruct(scan, parameters, listener)
    assert "frame-000003 by 30 mm" in listener.warnings[0]


def test_the_truncation_follows_the_pose_error(simulated, parameters):
    chosen = []
    for error_m in (0.0, 0.002, 0.005):
        scan = simulated("block", translation_error_m=error_m)
        told_m = view_error_m(measure_pose_health(scan, parameters), None)
        chosen.append(choose_truncation(parameters, parameters.voxel_m, told_m))
    assert chosen[0].front_m == pytest.approx(4 * parameters.voxel_m, abs=0.002)
    assert chosen[0].falloff_m == pytest.approx(0.8 * parameters.voxel_m, abs=0.001)
    assert chosen[0].front_m < chosen[1].front_m < chosen[2].front_m <= 0.03
    assert chosen[0].falloff_m < chosen[1].falloff_m < chosen[2].falloff_m
    assert all(each.falloff_m < each.behind_m <= each.front_m for each in chosen)


def test_without_a_table_nothing_is_said_and_the_truncation_is_the_released_codes(simulated, parameters):
    scan = simulated("block", table=False)
    health = measure_pose_health(scan, parameters)
    assert health.mean_height_m is None and health.sd_height_m is None and health.largest_tilt_rad is None
    chosen = choose_truncation(parameters, 0.004, view_error_m(health, None))
    assert chosen == Truncation(0.02, 0.02)


def test_a_set_truncation_stays(parameters):
    fixed = parameters.model_copy(update={"truncation_m": 0.017})
    assert choose_truncation(fixed, 0.004, 0.001) == Truncation(0.017, 0.017)
