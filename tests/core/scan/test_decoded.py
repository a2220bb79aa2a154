"""Views are decoded once in a process, whoever asks and wherever their files have gone meanwhile."""

from __future__ import annotations

import os
import shutil

import numpy as np
import pytest

from core.progress import Reporter
from core.scan import decoded, read_scan, views_so_far, write_camera, write_frame


@pytest.fixture(autouse=True)
def nothing_kept(monkeypatch):
    monkeypatch.setattr(decoded, "_kept", type(decoded._kept)())


@pytest.fixture
def n_decoded(monkeypatch):
    """How many views were decoded."""
    names: list[str] = []
    real = decoded._decode
    monkeypatch.setattr(decoded, "_decode", lambda folder, name: names.append(name) or real(folder, name))
    return lambda: len(names)


def test_views_that_come_one_by_one_are_decoded_once(small_scan, tmp_path, n_decoded):
    assert views_so_far(tmp_path) is None
    write_camera(small_scan.intrinsics, small_scan.platform_height_m, tmp_path, small_scan.crop_box)
    for n, frame in enumerate(small_scan.frames, 1):
        write_frame(frame, tmp_path)
        assert len(views_so_far(tmp_path).frames) == n
    finished = tmp_path / "finished"
    shutil.copytree(tmp_path, finished, ignore=shutil.ignore_patterns("finished"))
    scan = read_scan(finished, Reporter())
    assert n_decoded() == len(scan.frames) == len(small_scan.frames)
    assert scan.crop_box == small_scan.crop_box
    for read, written in zip(scan.frames, small_scan.frames, strict=True):
        np.testing.assert_array_equal(read.depth_m, written.depth_m)


def test_a_view_that_is_not_whole_is_left_out(small_scan, folder):
    (folder / "rgbd" / f"{small_scan.frames[-1].name}.pose.txt").unlink()
    assert len(views_so_far(folder).frames) == len(small_scan.frames) - 1


def test_a_view_that_cannot_be_used_is_left_to_who_reads_all(small_scan, folder):
    (folder / "rgbd" / f"{small_scan.frames[0].name}.depth.png").write_bytes(b"no picture")
    assert views_so_far(folder) is None


def test_a_view_that_was_taken_again_is_decoded_anew(small_scan, folder, n_decoded):
    read_scan(folder, Reporter())
    path = folder / "rgbd" / f"{small_scan.frames[1].name}.color.png"
    path.write_bytes((folder / "rgbd" / f"{small_scan.frames[2].name}.color.png").read_bytes())
    os.utime(path, ns=(1, 1))
    scan = read_scan(folder, Reporter())
    assert n_decoded() == len(small_scan.frames) + 1
    np.testing.assert_array_equal(scan.frames[1].color, small_scan.frames[2].color)


def test_only_the_newest_are_kept(small_scan, folder, monkeypatch):
    monkeypatch.setattr(decoded, "MOST_KEPT", 2)
    read_scan(folder, Reporter())
    assert len(decoded._kept) == 2
