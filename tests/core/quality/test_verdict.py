from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.errors import SessionError
from core.geometry import make_pose
from core.parameters.reconstruction import ReconstructionParameters
from core.progress import Reporter
from core.quality.measures import HiddenCavity, ScanQuality
from core.quality.plain_fusion import coarse_volume
from core.quality.verdict import (
    HIDDEN_AREA_USABLE_M2,
    RESIDUAL_AGAIN_M,
    RESIDUAL_USABLE_M,
    TABLE_SD_AGAIN_M,
    TABLE_SD_USABLE_M,
    UNSEEN_USABLE,
    assess,
    judge,
)
from core.quality.view_quality import ViewQuality
from core.reconstruction.pose_health import PoseHealth
from core.reconstruction.result import Reconstruction
from core.reconstruction.stage import reconstruct
from tests.core.quality.studio import BOX, PLATFORM_M, TABLE_M

COARSE = ReconstructionParameters(voxel_m=0.003, refine_poses=False)
NOTHING = HiddenCavity(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))


def views(sd_m: float = 0.0, residual_m: float = 0.0, n: int = 24) -> tuple[ViewQuality, ...]:
    """Views whose tables scatter by `sd_m`."""
    offsets = np.resize([1.0, -1.0], n) * sd_m * np.sqrt((n - 1) / n)
    return tuple(
        ViewQuality(f"frame-{k:06d}", 0.9, table_height_m=0.1 + offset, residual_rms_m=residual_m)
        for k, offset in enumerate(offsets)
    )


def reconstruction_of(mesh) -> Reconstruction:
    return Reconstruction(mesh, PLATFORM_M, 0.012, PoseHealth(()))


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (0.9 * TABLE_SD_USABLE_M, "good"),
        (1.1 * TABLE_SD_USABLE_M, "usable"),
        (1.1 * TABLE_SD_AGAIN_M, "scan again"),
    ],
)
def test_the_table_decides(value, expected):
    verdict, reasons = judge(views(sd_m=value), NOTHING, 0.0)
    assert verdict == expected and reasons[0].startswith(f"{expected}: ")
    if expected != "good":
        assert "disagree about the table by" in reasons[0] and "calibrate" in reasons[0]


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (0.9 * RESIDUAL_USABLE_M, "good"),
        (1.1 * RESIDUAL_USABLE_M, "usable"),
        (1.1 * RESIDUAL_AGAIN_M, "scan again"),
    ],
)
def test_the_residual_decides(value, expected):
    assert judge(views(residual_m=value), NOTHING, 0.0)[0] == expected


@pytest.mark.parametrize(
    ("value", "expected"),
    [(0.9 * UNSEEN_USABLE, "good"), (1.1 * UNSEEN_USABLE, "usable"), (0.9, "usable")],
)
def test_the_unseen_surface_decides(value, expected):
    assert judge(views(), NOTHING, value)[0] == expected


def test_a_hidden_cavity_is_told_with_its_measures():
    cavity = replace(NOTHING, area_m2=1.1 * HIDDEN_AREA_USABLE_M2, width_m=0.042, depth_m=0.035)
    verdict, reasons = judge(views(), cavity, 0.0)
    assert verdict == "usable"
    assert "an opening 42 mm wide was not seen below 35 mm" in reasons[0]


def test_a_table_beside_its_known_place_is_told():
    shifted = tuple(replace(view, table_offset_m=-0.005) for view in views())
    verdict, reasons = judge(shifted, NOTHING, 0.0)
    assert verdict == "usable" and "5.0 mm below its known height" in reasons[0]


def test_the_worst_reason_comes_first():
    _, reasons = judge(views(sd_m=2 * TABLE_SD_AGAIN_M), replace(NOTHING, area_m2=0.01), 0.0)
    assert [reason.split(":")[0] for reason in reasons] == ["scan again", "usable"]


def test_too_few_useful_views_are_scanned_again():
    blank = replace(views()[0], valid_share=0.0)
    assert judge((*views(n=11), *[blank] * 13), NOTHING, 0.0)[0] == "scan again"
    verdict, reasons = judge((*views(n=23), blank), NOTHING, 0.0)
    assert verdict == "usable" and "no depth at all" in reasons[0]


def test_a_mug_well_scanned_is_good(mug_scan, tmp_path):
    result = reconstruct(mug_scan, COARSE.model_copy(update={"refine_poses": True}), Reporter())
    quality = assess(mug_scan, coarse_volume(mug_scan, BOX), result, table_height_m=TABLE_M)
    assert quality.verdict == "good", quality.reasons
    assert len(quality.views) == 24 and len(quality.n_views) == len(result.mesh.vertices_m)
    quality.save(tmp_path)
    again = ScanQuality.load(tmp_path)
    assert (again.views, again.verdict, again.reasons) == (quality.views, quality.verdict, quality.reasons)
    assert np.array_equal(again.n_views, quality.n_views)
    assert (again.table_sd_m, again.residual_m) == (quality.table_sd_m, quality.residual_m)


def test_a_vase_asks_for_another_look(vase_scan, tmp_path):
    quality = assess(vase_scan, coarse_volume(vase_scan, BOX), reconstruct(vase_scan, COARSE, Reporter()))
    assert quality.verdict == "usable"
    assert any("look again" in reason for reason in quality.reasons)
    quality.save(tmp_path)
    again = ScanQuality.load(tmp_path).cavity
    assert np.array_equal(again.frontier_m, quality.cavity.frontier_m)
    assert again.volume_ml == quality.cavity.volume_ml


def test_poses_that_disagree_are_scanned_again(mug, mug_scan):
    random = np.random.default_rng(0)
    frames = []
    for frame in mug_scan.frames:
        shift = make_pose(np.eye(3), random.normal(scale=0.012, size=3))
        frames.append(replace(frame, T_base_camera=shift @ frame.T_base_camera))
    scan = replace(mug_scan, frames=tuple(frames))
    quality = assess(scan, coarse_volume(mug_scan, BOX), reconstruction_of(mug.mesh))
    assert quality.verdict == "scan again"
    for part in ("disagree about the table", "off the model", "more problems of single views"):
        assert part in " ".join(quality.reasons)


def test_damaged_files_are_named(tmp_path):
    with pytest.raises(SessionError, match=r"quality\.json"):
        ScanQuality.load(tmp_path)
    (tmp_path / "quality.json").write_text("{}")
    np.savez(tmp_path / "quality.npz", n_views=np.zeros(1))
    with pytest.raises(SessionError, match="damaged"):
        ScanQuality.load(tmp_path)
