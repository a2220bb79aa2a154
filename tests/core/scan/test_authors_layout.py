from __future__ import annotations

import os
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.errors import Cancelled, SessionError
from core.geometry import AnyArray, make_pose, rotation_error
from core.parameters.reconstruction import ReconstructionParameters
from core.progress import Reporter
from core.scan import CropBox, Scan, crop_box_of, read_scan, stored_scan, write_frame, write_scan


def same(first: Scan, second: Scan) -> bool:
    return (
        first.intrinsics == second.intrinsics
        and first.platform_height_m == second.platform_height_m
        and first.crop_box == second.crop_box
        and len(first.frames) == len(second.frames)
        and all(
            a.name == b.name
            and np.array_equal(a.color, b.color)
            and np.array_equal(a.depth_m, b.depth_m)
            and np.array_equal(a.T_base_camera, b.T_base_camera)
            for a, b in zip(first.frames, second.frames, strict=True)
        )
    )


def test_what_was_written_reads_back_exactly(small_scan, folder):
    assert same(read_scan(folder, Reporter()), small_scan)


def test_frames_may_lie_directly_in_the_folder(small_scan, folder):
    for file in (folder / "rgbd").iterdir():
        file.rename(folder / file.name)
    (folder / "rgbd").rmdir()
    assert same(read_scan(folder, Reporter()), small_scan)


def test_the_rgbd_folder_itself_may_be_given(small_scan, folder):
    assert same(read_scan(folder / "rgbd", Reporter()), small_scan)


def test_without_scan_json_the_platform_is_unknown(folder):
    (folder / "scan.json").unlink()
    scan = read_scan(folder, Reporter())
    assert scan.platform_height_m is None and scan.crop_box is None


@pytest.mark.parametrize("height_m", [None, 0.0815])
@pytest.mark.parametrize("box", [None, CropBox((-0.1, 0.2, 0.03), (0.1, 1 / 3, 0.4))])
def test_height_and_crop_box_are_kept_each_for_itself(small_scan, tmp_path, height_m, box):
    placed = replace(small_scan, platform_height_m=height_m, crop_box=box)
    write_scan(placed, tmp_path)
    assert same(read_scan(tmp_path, Reporter()), placed)


def test_the_parameters_box_goes_before_the_scans_and_that_before_the_released_codes(small_scan):
    scans_own = CropBox((0.0, 0.0, 0.0), (0.1, 0.1, 0.1))
    placed = replace(small_scan, crop_box=scans_own)
    given = ReconstructionParameters(crop_min_m=(1, 1, 1), crop_max_m=(2, 2, 2))
    assert crop_box_of(placed, given) == CropBox((1, 1, 1), (2, 2, 2))
    assert crop_box_of(placed, ReconstructionParameters()) == scans_own
    for unknown in (small_scan, None):
        assert crop_box_of(unknown, ReconstructionParameters()).min_m == (-0.30, -0.55, 0.03)


def test_writing_an_unknown_platform_height_forgets_the_old_one(small_scan, folder):
    write_scan(replace(small_scan, platform_height_m=None), folder)
    assert read_scan(folder, Reporter()).platform_height_m is None


def test_any_number_of_views(small_scan, tmp_path):
    for n_views in (1, 2, 4):
        folder = tmp_path / str(n_views)
        write_scan(replace(small_scan, frames=small_scan.frames[:n_views]), folder)
        assert len(read_scan(folder, Reporter()).frames) == n_views


def test_depth_is_rounded_to_a_millimetre_and_nonsense_is_no_measurement(small_scan, tmp_path):
    depth_m = small_scan.frames[0].depth_m.copy()
    depth_m[0, :5] = [np.nan, np.inf, -0.4, 70.0, 0.70049]
    spoiled = replace(small_scan.frames[0], depth_m=depth_m)
    write_scan(replace(small_scan, frames=(spoiled, *small_scan.frames[1:])), tmp_path)
    assert read_scan(tmp_path, Reporter()).frames[0].depth_m[0, :5].tolist() == pytest.approx(
        [0, 0, 0, 0, 0.7]
    )


def test_other_files_do_not_disturb(small_scan, folder):
    (folder / "rgbd" / "tsdf.ply").write_text("ply")
    (folder / "rgbd" / "frame-000000.jpg").write_text("jpg")
    (folder / "rgbd" / ".frame-000009.depth.png.part").write_text("cut short")
    assert same(read_scan(folder, Reporter()), small_scan)


def test_progress_counts_the_views(folder, listener):
    read_scan(folder, listener)
    assert listener.steps == [("import", done, 4) for done in (1, 2, 3, 4)]


def test_reading_stops_on_request(folder, listener):
    listener.cancel()
    with pytest.raises(Cancelled):
        read_scan(folder, listener)


def test_a_file_that_cannot_be_replaced_leaves_the_old_one_and_no_rest(small_scan, folder, monkeypatch):
    target = folder / "rgbd" / "frame-000000.depth.png"
    before = target.read_bytes()

    def full_disk(_path: Path, _content: bytes) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full_disk)
    with pytest.raises(SessionError, match=r"frame-000000\.color\.png cannot be written \(No space left"):
        write_frame(small_scan.frames[0], folder)
    monkeypatch.undo()
    assert target.read_bytes() == before
    assert not list(folder.rglob("*.part"))


@pytest.mark.skipif(os.geteuid() == 0, reason="root writes everywhere")
def test_a_read_only_folder_is_named(small_scan, tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(SessionError, match=str(tmp_path)):
        write_scan(small_scan, tmp_path)


def test_the_real_scan(shared_data):
    scan = read_scan(shared_data / "real_scan" / "amazon_tray", Reporter())
    assert len(scan.frames) == 24
    assert scan.frames[0].name == "frame-000150"
    assert scan.intrinsics.fx == pytest.approx(532.58)
    for frame in scan.frames:
        depth: AnyArray = frame.depth_m
        assert depth.shape == (480, 640) and depth.dtype == np.float32
        assert 0.2 < depth[depth > 0].min() < depth.max() < 10
        assert rotation_error(frame.T_base_camera[:3, :3]) < 1e-6


def test_points_land_where_the_camera_looks(small_scan):
    frame = small_scan.frames[0]
    depth_m = np.zeros_like(frame.depth_m)
    depth_m[6, 8] = 0.5
    intrinsics = replace(small_scan.intrinsics, cx=8.0, cy=6.0)
    points = replace(frame, depth_m=depth_m).points_m(intrinsics, max_depth_m=6.0)
    assert points == pytest.approx((frame.T_base_camera @ [0, 0, 0.5, 1])[None, :3])
    assert len(replace(frame, depth_m=depth_m).points_m(intrinsics, max_depth_m=0.4)) == 0


def test_a_copy_of_the_folder_is_the_same_scan(small_scan, folder, tmp_path_factory):
    copy = tmp_path_factory.mktemp("copy") / "scan"
    shutil.copytree(folder, copy)
    assert same(read_scan(copy, Reporter()), small_scan)


def test_a_stored_scan_is_decoded_once_until_a_file_changes(small_scan, folder, listener):
    first = stored_scan(folder, listener)
    assert same(first, small_scan)
    assert stored_scan(folder, listener) is first
    assert len(listener.steps) == len(first.frames)
    shifted = replace(small_scan.frames[0], T_base_camera=make_pose(np.eye(3), [0.1, 0.2, 0.3]))
    write_frame(shifted, folder)
    assert stored_scan(folder, listener).frames[0].T_base_camera[0, 3] == 0.1
