from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.geometry import invert_pose, make_pose, transform_points
from core.parameters import load_preset
from core.reconstruction.registration import PixelWindow
from core.reconstruction.stage import reconstruct
from core.scan import Scan


def changed(parameters, **settings):
    return type(parameters).model_validate(parameters.model_dump() | settings)


def scatter_m(scan: Scan, true: Scan) -> float:
    """How far (rms) the views place points of the object from where they place them on the average."""
    points = np.array([[0.44, 0.13, 0.08], [0.36, 0.07, 0.13], [0.4, 0.1, 0.1], [0.44, 0.07, 0.1]])
    placed = np.array(
        [
            transform_points(ours.T_base_camera @ invert_pose(theirs.T_base_camera), points)
            for ours, theirs in zip(scan.frames, true.frames, strict=True)
        ]
    )
    return float(np.sqrt(((placed - placed.mean(axis=0)) ** 2).sum(axis=-1).mean()))


def test_an_injected_pose_error_is_taken_out(simulated, bowl_scan, parameters, listener):
    erring = simulated("bowl", translation_error_m=0.001, rotation_error_rad=np.deg2rad(0.25))
    refinement = reconstruct(erring, parameters, listener).refinement
    assert scatter_m(erring, bowl_scan) > 0.003
    assert scatter_m(refinement.applied_to(erring), bowl_scan) < 0.0006
    assert refinement.residual_after_m < 0.5 * refinement.residual_before_m
    assert refinement.table_sd_after_m < 0.5 * refinement.table_sd_before_m
    assert refinement.view_error_m < 0.0005


def test_the_correction_is_what_was_done_to_each_pose(simulated, parameters, listener):
    scan = simulated("bowl", translation_error_m=0.001)
    refinement = reconstruct(scan, parameters, listener).refinement
    for frame, view in zip(scan.frames, refinement.views, strict=True):
        change = invert_pose(frame.T_base_camera) @ view.T_base_camera
        assert view.name == frame.name
        assert view.shift_m == pytest.approx(np.linalg.norm(change[:3, 3]))
        assert np.cos(view.turn_rad) == pytest.approx((np.trace(change[:3, :3]) - 1) / 2)
        assert np.allclose(view.T_base_camera[:3, :3] @ view.T_base_camera[:3, :3].T, np.eye(3))


def test_right_poses_stay_nearly_where_they_are(bowl_scan, parameters, listener):
    refinement = reconstruct(bowl_scan, parameters, listener).refinement
    assert scatter_m(refinement.applied_to(bowl_scan), bowl_scan) < 0.0003
    assert max(view.shift_m for view in refinement.views) < 0.001


def test_the_scene_as_a_whole_stays(simulated, parameters, listener):
    scan = simulated("bowl", translation_error_m=0.002)
    refinement = reconstruct(scan, parameters, listener).refinement
    shifts = [
        view.T_base_camera[:3, 3] - frame.T_base_camera[:3, 3]
        for frame, view in zip(scan.frames, refinement.views, strict=True)
    ]
    assert np.linalg.norm(np.mean(shifts, axis=0)) < 0.001


def test_a_stray_view_is_brought_back_and_moves_no_other(bowl_scan, parameters, listener):
    frames = list(bowl_scan.frames)
    frames[3] = replace(frames[3], T_base_camera=make_pose(np.eye(3), [0, 0, 0.02]) @ frames[3].T_base_camera)
    scan = replace(bowl_scan, frames=tuple(frames))
    refined = reconstruct(scan, parameters, listener).refinement.applied_to(scan)
    off_m = [
        np.linalg.norm(ours.T_base_camera[:3, 3] - true.T_base_camera[:3, 3])
        for ours, true in zip(refined.frames, bowl_scan.frames, strict=True)
    ]
    assert max(off_m) < 0.004


def test_without_a_table_the_object_alone_aligns_the_views(simulated, bowl_scan, parameters, listener):
    erring = simulated("bowl", translation_error_m=0.001, table=False)
    refined = reconstruct(erring, parameters, listener).refinement
    assert refined.table_sd_before_m is None
    assert scatter_m(refined.applied_to(erring), bowl_scan) < 0.5 * scatter_m(erring, bowl_scan)


def test_switched_off_the_poses_are_taken_as_recorded(bowl_scan, parameters, listener):
    assert reconstruct(bowl_scan, changed(parameters, refine_poses=False), listener).refinement is None
    for name in ("authors", "paper"):
        assert not load_preset(name).reconstruction.refine_poses


def test_a_set_truncation_may_be_refined_too(simulated, parameters, listener):
    scan = simulated("bowl", translation_error_m=0.001)
    result = reconstruct(scan, changed(parameters, truncation_m=0.012), listener)
    assert result.truncation_m == 0.012
    assert result.refinement.residual_after_m < result.refinement.residual_before_m


def test_one_view_alone_is_not_corrected(bowl_scan, parameters, listener):
    alone = replace(bowl_scan, frames=bowl_scan.frames[:1])
    refinement = reconstruct(alone, parameters, listener).refinement
    assert refinement.residual_after_m is None and refinement.view_error_m is None
    assert refinement.views[0].shift_m < 1e-6


def test_planes_beside_the_object_change_nothing(simulated, parameters, listener, monkeypatch):
    scan = simulated("thin_cup", translation_error_m=0.001, rotation_error_rad=0.003)
    found = reconstruct(scan, parameters, listener)
    monkeypatch.setattr(PixelWindow, "of_box", lambda _, frame, __: PixelWindow.whole(frame.depth_m.shape))
    whole = reconstruct(scan, parameters, listener)
    np.testing.assert_array_equal(found.mesh.vertices_m, whole.mesh.vertices_m)
    assert found.refinement.residual_after_m == whole.refinement.residual_after_m
