"""The real librealsense, with recordings of its software device; no part of it is replaced."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.ndimage import binary_erosion
from scipy.spatial.transform import Rotation

from hardware.cameras import realsense
from hardware.cameras.realsense import RealSenseCamera
from hardware.cameras.timing import FRAMES_IN_FLIGHT, SETTLING_FRAMES
from hardware.errors import CameraError, CameraLost, DriverMissing
from tests.awake import within
from tests.hardware.cameras.recording import (
    DEPTH_UNIT_M,
    FIRST_MS,
    RATE,
    SERIAL,
    Lens,
    Optics,
    lens_as_declared,
    record,
)

rs = pytest.importorskip("pyrealsense2", reason=f"needs the RealSense driver: {realsense.INSTALL}")

SHAPE = (240, 320)
NEAR_M, FAR_M = 0.8, 1.6
BARREL = (-0.15, 0.04, -0.0007, 0.0004, -0.01)
TURN = Rotation.from_euler("yx", [1.0, 0.5], degrees=True).as_matrix()


def _shots(count: int) -> list[Any]:
    """Colour and depth that tell the number of the shot: (number, .., ..) and 1 m + number mm."""
    shots = []
    for number in range(1, count + 1):
        color = np.zeros((*SHAPE, 3), np.uint8)
        color[..., 0], color[..., 1] = number, np.arange(SHAPE[1]) % 256
        shots.append((np.full(SHAPE, round((1.0 + number / 1000) / DEPTH_UNIT_M), np.uint16), color))
    return shots


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("realsense") / "short.db3"
    record(path, Optics(), _shots(5))
    return path


@pytest.fixture(scope="module")
def long(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("realsense") / "long.db3"
    record(path, Optics(), _shots(SETTLING_FRAMES + 50))
    return path


Unplug = Callable[[], None]


@pytest.fixture
def plugged_in(long: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Unplug]:
    """Let a recording appear among the connected devices, where it runs in real time like a camera."""
    context = rs.context()
    device = context.load_device(str(long))  # it vanishes when nobody holds it
    monkeypatch.setattr(rs, "context", lambda: context)
    monkeypatch.setattr(realsense, "WAIT_S", 0.5)
    loaded = [str(long)]

    def unplug() -> None:
        while loaded:
            context.unload_device(loaded.pop())

    assert device.is_playback()
    yield unplug
    unplug()


def test_a_recording_gives_every_shot_as_it_was(short: Path) -> None:
    with RealSenseCamera(playback=short) as camera:
        assert SERIAL in camera.name
        for number, (_, color) in enumerate(_shots(5), start=1):
            image = camera.capture()
            np.testing.assert_array_equal(image.color, color)
            assert image.depth_m.dtype == np.float32
            assert image.depth_m.shape == SHAPE
            np.testing.assert_allclose(image.depth_m[image.depth_m > 0], 1 + number / 1000, atol=1e-6)
            assert image.time_s == pytest.approx(FIRST_MS / 1000 + number / RATE, abs=1e-6)
            lens = image.intrinsics
            assert (lens.fx, lens.fy, lens.cx, lens.cy) == (300.0, 300.0, 158.0, 118.0)
            time.sleep(0.1)  # longer than a frame: nothing may be lost meanwhile


def test_an_image_outlives_the_next_one_and_the_camera(short: Path) -> None:
    with RealSenseCamera(playback=short) as camera:
        first = camera.capture()
        camera.capture()
    assert first.color[0, 0, 0] == 1
    assert first.depth_m.max() == pytest.approx(1.001)


def test_every_start_begins_with_the_first_shot(short: Path) -> None:
    for _ in range(20):
        with RealSenseCamera(playback=short) as camera:
            assert camera.capture().color[0, 0, 0] == 1


def test_a_recording_nobody_looks_at_is_left_at_once(short: Path) -> None:
    with within(5):
        for _ in range(5):
            with RealSenseCamera(playback=short):
                time.sleep(0.05)


def test_the_end_of_a_recording_is_a_sentence_and_it_can_be_played_again(
    short: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(realsense, "WAIT_S", 0.5)
    camera = RealSenseCamera(playback=short)
    for _ in range(2):
        with camera:
            numbers = [int(camera.capture().color[0, 0, 0]) for _ in range(5)]
            assert numbers == [1, 2, 3, 4, 5]
            with pytest.raises(CameraLost, match=r"The recording .*short\.db3 has ended"):
                camera.capture()
    with pytest.raises(CameraLost, match="not connected"):
        camera.capture()


@pytest.mark.parametrize(
    ("rotation", "color_lens"),
    [
        (np.eye(3), Lens(300.0, 158.0, 118.0)),
        (TURN, Lens(300.0, 158.0, 118.0)),
        (TURN, Lens(300.0, 158.0, 118.0, BARREL, "inverse_brown_conrady")),
        (TURN, Lens(300.0, 158.0, 118.0, BARREL, "brown_conrady")),
    ],
    ids=["beside", "turned", "turned, inverse distortion", "turned, distortion"],
)
def test_depth_lands_on_the_colour_it_belongs_to(tmp_path: Path, rotation: Any, color_lens: Lens) -> None:
    """A bright near board before a dark far wall, drawn for both cameras from the same geometry."""
    optics = Optics(color=color_lens, rotation=rotation)
    depth_m, _ = _board(_pinhole_rays(optics.depth), np.zeros(3))
    _, bright = _board(*_in_depth_frame(optics, _lens_rays(optics)))
    color = np.where(bright[..., None], 250, 20).astype(np.uint8).repeat(3, axis=2)
    record(tmp_path / "board.db3", optics, [(np.rint(depth_m / DEPTH_UNIT_M).astype(np.uint16), color)])
    with RealSenseCamera(playback=tmp_path / "board.db3") as camera:
        image = camera.capture()

    ideal_rays = _pinhole_rays(optics.color)
    distances, board = _board(*_in_depth_frame(optics, ideal_rays))
    inside, outside = _well_inside(board), _well_inside(~board)
    assert (image.color[inside] > 200).all()
    assert (image.color[outside] < 70).all()
    measured = image.depth_m > 0
    assert measured[inside].all()
    assert np.abs(image.depth_m - distances)[inside].max() < 1e-4
    # The colour camera sees a strip of wall that the board hides from the depth camera.
    assert np.abs(image.depth_m - distances)[outside & measured].max() < 1e-4
    assert measured[outside].mean() > 0.8


def test_a_distortion_that_cannot_be_taken_out_is_refused(tmp_path: Path) -> None:
    optics = Optics(color=Lens(300.0, 158.0, 118.0, BARREL, "modified_brown_conrady"))
    record(tmp_path / "modified.db3", optics, _shots(3))
    with pytest.raises(CameraError, match="lens distortion of the kind modified_brown_conrady"):
        RealSenseCamera(playback=tmp_path / "modified.db3").__enter__()


def test_a_missing_recording_is_named(tmp_path: Path) -> None:
    with pytest.raises(CameraLost, match=r"There is no recording .*none\.db3"):
        RealSenseCamera(playback=tmp_path / "none.db3").__enter__()


@pytest.mark.parametrize("damage", ["cut short", "no recording at all"])
def test_a_damaged_recording_is_named(short: Path, tmp_path: Path, damage: str) -> None:
    path = tmp_path / "damaged.db3"
    content = short.read_bytes()
    path.write_bytes(content[: len(content) // 2] if damage == "cut short" else b"no recording")
    with pytest.raises(CameraLost, match=r"The recording .*damaged\.db3 cannot be played \(.+\); copy it"):
        RealSenseCamera(playback=path).__enter__()


def test_what_was_in_the_queue_or_on_its_way_is_not_returned(plugged_in: Unplug) -> None:
    rest_s = 0.5
    exposed_meanwhile = int(rest_s * RATE)
    for _ in range(3):  # a recording falls behind its clock while the whole machine stands still
        with RealSenseCamera(SERIAL, width=320, height=240) as camera:
            first = camera.capture()
            time.sleep(rest_s)
            second = camera.capture()
        gained = int(second.color[0, 0, 0]) - int(first.color[0, 0, 0])
        if gained >= exposed_meanwhile + FRAMES_IN_FLIGHT:
            break
    assert gained >= exposed_meanwhile + FRAMES_IN_FLIGHT
    assert first.color[0, 0, 0] > SETTLING_FRAMES
    assert second.depth_m.max() == pytest.approx(1 + second.color[0, 0, 0] / 1000, abs=2e-3)
    assert rest_s < second.time_s - first.time_s < rest_s + 0.5


def test_frames_that_stop_are_an_error_that_may_pass(plugged_in: Unplug) -> None:
    with RealSenseCamera(width=320, height=240) as camera:
        error = _capture_until_error(camera)
    assert not isinstance(error, CameraLost)
    assert "sent no new image within 0.5 s" in str(error)


def test_a_camera_that_was_unplugged_is_lost(plugged_in: Unplug) -> None:
    with RealSenseCamera(width=320, height=240) as camera:
        plugged_in()
        error = _capture_until_error(camera)
    assert isinstance(error, CameraLost)
    assert "was unplugged" in str(error)


def test_another_serial_number_is_not_taken(plugged_in: Unplug) -> None:
    with pytest.raises(CameraLost, match=f"RealSense 123 is not connected; there is {SERIAL}"):
        RealSenseCamera("123").__enter__()


def test_a_mode_the_camera_does_not_know_is_a_sentence(plugged_in: Unplug) -> None:
    with pytest.raises(CameraError, match="does not start with 641 x 480 at 30 Hz"):
        RealSenseCamera(width=641).__enter__()


def test_no_camera_is_said_at_once() -> None:
    if len(rs.context().query_devices()):
        pytest.skip("a RealSense is connected")
    with within(5), pytest.raises(CameraLost, match="No RealSense camera is connected"):
        RealSenseCamera().__enter__()


def test_a_missing_driver_names_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyrealsense2", None)
    with pytest.raises(DriverMissing, match=r"missing; install it with: .*pip install -e '\.\[realsense\]'"):
        RealSenseCamera().__enter__()


def _capture_until_error(camera: RealSenseCamera) -> CameraError:
    with pytest.raises(CameraError) as caught:
        for _ in range(100):
            camera.capture()
    return caught.value


def _board(rays: Any, origin: Any) -> tuple[Any, Any]:
    """Distance along each ray, in lengths of it, and whether it meets the near board; in the depth frame."""
    near = (NEAR_M - origin[2]) / rays[..., 2]
    met = origin + rays * near[..., None]
    hit = (np.abs(met[..., :2] - [-0.13, -0.08]) < [0.23, 0.18]).all(axis=-1)
    return np.where(hit, near, (FAR_M - origin[2]) / rays[..., 2]), hit


def _in_depth_frame(optics: Optics, rays: Any) -> tuple[Any, Any]:
    return rays @ optics.rotation, -np.array(optics.translation_m) @ optics.rotation


def _pinhole_rays(lens: Lens) -> Any:
    rows, columns = np.mgrid[: SHAPE[0], : SHAPE[1]]
    return np.stack([(columns - lens.cx) / lens.fx, (rows - lens.cy) / lens.fx, np.ones(SHAPE)], axis=-1)


def _lens_rays(optics: Optics) -> Any:
    """Where the pixels of the real, distorted colour image look."""
    lens = lens_as_declared(rs, optics, optics.color)
    rows, columns = np.mgrid[: SHAPE[0], : SHAPE[1]]
    rays = [
        rs.rs2_deproject_pixel_to_point(lens, [float(u), float(v)], 1.0)
        for u, v in zip(columns.flat, rows.flat, strict=True)
    ]
    return np.reshape(rays, (*SHAPE, 3))


def _well_inside(mask: Any) -> Any:
    """Leave out two pixels at edges and at the border of the image."""
    return binary_erosion(mask, np.ones((5, 5)))
