"""Views chosen for a box: what they see of it, and that the arm can take them in any order."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.geometry import look_at
from core.motion.box_views import box_patches, choose_box_views, patch_quality
from core.motion.clearance import MotionScene, axis_aligned_obstacle
from core.motion.joint_path import check_path
from core.motion.views import Dome
from tests.core.motion.cell import TASK, simulated_cell

LOW_M, HIGH_M = np.array([-0.16, -0.45, 0.08]), np.array([0.04, -0.25, 0.38])
MIDDLE_M = (LOW_M + HIGH_M) / 2
OF_BOX = replace(TASK, box_min_m=LOW_M, box_max_m=HIGH_M)
BASELINE_M = 0.075
COARSE = Dome((30, 60, 80), tuple(range(-180, 180, 60)), (0.5, 0.7), (-180, -90, 0, 90))
N_VIEWS = 8


def quality_from(eye_m):
    patches = box_patches(LOW_M, HIGH_M)
    pose = look_at(eye_m, MIDDLE_M)
    return patches, patch_quality(patches, pose[None], OF_BOX, BASELINE_M)[0]


def test_from_above_the_mouth_shows_the_floor_and_no_outer_side():
    patches, quality = quality_from(MIDDLE_M + np.array([0, 0, 0.7]))
    floor = patches.is_inside & (patches.normals[:, 2] > 0)
    sides = ~patches.is_inside & (patches.normals[:, 2] == 0)
    assert (quality[floor] > 0.9).all()
    assert (quality[sides] == 0).all()


def test_from_the_side_only_the_outside_that_faces_the_camera_is_seen():
    patches, quality = quality_from(MIDDLE_M + np.array([0, 0.6, 0]))
    seen = quality > 0
    assert seen.any()
    assert not patches.is_inside[seen].any()
    np.testing.assert_array_equal(np.unique(patches.normals[seen], axis=0), [[0, 1, 0]])


def test_from_an_oblique_angle_the_inner_wall_across_is_seen_and_the_near_one_is_not():
    patches, quality = quality_from(MIDDLE_M + np.array([0.35, 0, 0.5]))
    across = patches.is_inside & (patches.normals[:, 0] > 0)
    near = patches.is_inside & (patches.normals[:, 0] < 0)
    assert (quality[across] > 0).any()
    assert (quality[near] == 0).all()


def test_nothing_nearer_than_the_camera_measures_counts():
    patches, quality = quality_from(np.array([MIDDLE_M[0], MIDDLE_M[1], HIGH_M[2] + 0.2]))
    assert (quality[patches.points_m[:, 2] > HIGH_M[2] - 0.1] == 0).all()


@pytest.fixture(scope="module")
def scene():
    known = simulated_cell()
    around = axis_aligned_obstacle("object's box", LOW_M - 0.02, HIGH_M + 0.02)
    return MotionScene(known.arm, known.shape, [*known.obstacles[:2], around])


@pytest.fixture(scope="module")
def views(scene):
    return choose_box_views(scene, OF_BOX, BASELINE_M, N_VIEWS, COARSE)


def test_the_chosen_views_are_clear_and_reached_straight_from_home(scene, views):
    assert len(views) == N_VIEWS
    for view in views:
        path = [OF_BOX.home_rad, view.joints_rad]
        assert check_path(scene, path, OF_BOX.min_clearance_m).is_clear


def test_the_chosen_views_see_the_rim_and_the_floor_from_several_sides(views):
    patches = box_patches(LOW_M, HIGH_M)
    poses = np.array([view.T_base_camera for view in views])
    n_seen = (patch_quality(patches, poses, OF_BOX, BASELINE_M) > 0).sum(axis=0)
    upwards = patches.normals[:, 2] > 0
    assert (n_seen[upwards] >= 2).all()
    assert (n_seen > 0).mean() > 0.9


def test_where_the_arm_reaches_nothing_no_view_is_chosen():
    far = replace(OF_BOX, box_min_m=LOW_M - [0, 2, 0], box_max_m=HIGH_M - [0, 2, 0])
    assert choose_box_views(simulated_cell(), far, BASELINE_M, N_VIEWS, COARSE) == ()
