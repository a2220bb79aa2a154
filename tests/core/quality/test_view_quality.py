from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.geometry import make_pose, rotation_x
from core.quality.view_quality import ModelResiduals, check_view
from tests.core.quality.studio import BOX, CARMINE_INTRINSICS, PLATFORM_M, TABLE_M


def check(frame, **known):
    return check_view(frame, CARMINE_INTRINSICS, BOX, **known)


def test_a_good_view_has_no_problems(mug_scan):
    for frame, before in zip(mug_scan.frames[1:], mug_scan.frames, strict=False):
        view = check(frame, before=before, table_height_m=TABLE_M)
        assert view.problems == () and not view.is_useless
        assert view.valid_share > 0.7
        assert view.table_height_m == pytest.approx(TABLE_M, abs=0.008)


def test_a_view_without_depth_says_so(mug_scan):
    view = check(replace(mug_scan.frames[0], depth_m=np.zeros((480, 640), dtype=np.float32)))
    assert view.is_useless and view.table_height_m is None
    assert len(view.problems) == 1 and "no depth at all" in view.problems[0]


def test_little_depth_around_the_object_is_a_problem(mug_scan):
    depth = mug_scan.frames[0].depth_m.copy()
    depth[:, 250:] = 0
    view = check(replace(mug_scan.frames[0], depth_m=depth))
    assert 0 < view.valid_share < 0.4 and "only" in view.problems[0]


def test_a_frozen_image_is_found_only_when_the_camera_moved(mug_scan):
    first, second = mug_scan.frames[:2]
    frozen = replace(first, name="frozen", T_base_camera=second.T_base_camera)
    assert check(frozen, before=first).is_repeated
    assert "frozen repeats" in check(frozen, before=first).problems[0]
    assert not check(first, before=first).is_repeated, "it stood still"
    assert not check(second, before=first).is_repeated
    new_color = replace(frozen, color=second.color)
    assert not check(new_color, before=first).is_repeated


def test_a_lifted_view_and_a_tilted_one_are_found(mug_scan):
    frame = mug_scan.frames[-1]
    lifted = replace(frame, T_base_camera=make_pose(np.eye(3), [0, 0, 0.015]) @ frame.T_base_camera)
    view = check(lifted, table_height_m=TABLE_M)
    assert view.table_offset_m == pytest.approx(0.015, abs=0.004)
    assert any("mm above its place" in problem for problem in view.problems)
    assert check(lifted).table_offset_m is None, "nobody said where the table is"
    about_middle = make_pose(np.eye(3), [0, 0, TABLE_M]) @ make_pose(
        rotation_x(np.radians(5)), [0, 0, -TABLE_M]
    )
    tilted = check(replace(frame, T_base_camera=about_middle @ frame.T_base_camera), table_height_m=TABLE_M)
    assert tilted.table_tilt_rad == pytest.approx(np.radians(5), abs=np.radians(0.8))
    assert any("tilted by" in problem for problem in tilted.problems)


def test_residuals_grow_with_the_distance_to_the_model(mug, mug_scan):
    frame = mug_scan.frames[0]
    at_place, beside = (
        ModelResiduals(mug.mesh.translated(np.array([shift, 0, 0])), PLATFORM_M).add_to(
            check(frame), frame, CARMINE_INTRINSICS
        )
        for shift in (0.0, 0.006)
    )
    assert at_place.residual_median_m < 0.002 and at_place.residual_rms_m < 0.003
    assert beside.residual_median_m > at_place.residual_median_m + 0.001
    away = ModelResiduals(mug.mesh.translated(np.array([5.0, 0, 0])), PLATFORM_M)
    assert away.add_to(check(frame), frame, CARMINE_INTRINSICS).residual_rms_m is None
