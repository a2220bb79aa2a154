from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from core.errors import InputError
from core.geometry import make_pose
from core.scan.authors_layout import write_scan
from core.scan.model import Intrinsics, RgbdFrame, Scan
from hardware.cameras.replay import ReplayCamera
from hardware.errors import CameraLost

INTRINSICS = Intrinsics(50.0, 51.0, 15.5, 11.5)
VIEWS = 4


def _frame(number: int) -> RgbdFrame:
    color = np.full((24, 32, 3), 10 * number, np.uint8)
    depth_m = np.full((24, 32), 0.5 + number / 100, np.float32)
    return RgbdFrame(f"frame-{number:06d}", color, depth_m, make_pose(np.eye(3), [number / 10, 0.0, 0.4]))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_scan(Scan(tuple(map(_frame, range(1, VIEWS + 1))), INTRINSICS), tmp_path / "scan")
    return tmp_path


@pytest.mark.parametrize("inside", ["", "scan", "scan/rgbd"], ids=["session", "scan", "images"])
def test_the_views_come_in_order_with_their_poses(folder: Path, inside: str) -> None:
    camera = ReplayCamera(folder / inside)
    times = []
    with camera:
        assert camera.T_base_camera is None
        for number in range(1, VIEWS + 1):
            image, expected = camera.capture(), _frame(number)
            np.testing.assert_array_equal(image.color, expected.color)
            np.testing.assert_allclose(image.depth_m, expected.depth_m, atol=1e-6)
            np.testing.assert_allclose(camera.T_base_camera, expected.T_base_camera)
            assert image.intrinsics == INTRINSICS
            times.append(image.time_s)
    assert (np.diff(times) > 0).all()


def test_the_end_is_a_sentence_and_entering_again_starts_anew(folder: Path) -> None:
    camera = ReplayCamera(folder)
    for _ in range(2):
        with camera:
            shades = [int(camera.capture().color[0, 0, 0]) for _ in range(VIEWS)]
            assert shades == [10, 20, 30, 40]
            with pytest.raises(CameraLost, match="has ended; connect it again"):
                camera.capture()
    with pytest.raises(CameraLost, match="not running"):
        camera.capture()


def test_the_authors_data_is_played(shared_data: Path) -> None:
    folder = next(path.parent for path in sorted(shared_data.rglob("camera-intrinsics.txt")))
    with ReplayCamera(folder) as camera:
        image = camera.capture()
        assert image.color.shape == (*image.depth_m.shape, 3)
        assert image.depth_m.max() > 0.2
        assert camera.T_base_camera is not None


def test_a_folder_without_a_scan_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no views"):
        ReplayCamera(tmp_path).__enter__()
