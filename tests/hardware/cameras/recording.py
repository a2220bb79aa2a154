"""Recordings by librealsense's software device: a synthetic camera whose optics are known exactly."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

SERIAL = "017322071705"
NAME = "Software D400"
RATE = 30
DEPTH_UNIT_M = 0.0005
FIRST_MS = 5000.0


@dataclass
class Lens:
    fx: float
    cx: float
    cy: float
    coefficients: tuple[float, ...] = (0.0,) * 5
    model: str = "inverse_brown_conrady"


@dataclass
class Optics:
    """Depth and colour camera; `rotation` and `translation_m` take depth points to colour."""

    depth: Lens = field(default_factory=lambda: Lens(190.0, 160.0, 120.0))
    color: Lens = field(default_factory=lambda: Lens(300.0, 158.0, 118.0))
    rotation: npt.NDArray[np.float64] = field(default_factory=lambda: np.eye(3))
    translation_m: tuple[float, float, float] = (0.05, 0.0, 0.0)
    width: int = 320
    height: int = 240


def record(
    path: Path, optics: Optics, shots: list[tuple[npt.NDArray[np.uint16], npt.NDArray[np.uint8]]]
) -> None:
    """Record pairs of depth (H, W) in `DEPTH_UNIT_M` and colour (H, W, 3), at `RATE`."""
    rs = pytest.importorskip("pyrealsense2")
    device = rs.software_device()
    device.register_info(rs.camera_info.serial_number, SERIAL)
    device.register_info(rs.camera_info.name, NAME)
    depth_sensor, color_sensor = device.add_sensor("Stereo Module"), device.add_sensor("RGB Camera")
    depth = depth_sensor.add_video_stream(_stream(rs, optics, optics.depth, "depth", "z16", 2))
    color = color_sensor.add_video_stream(_stream(rs, optics, optics.color, "color", "rgb8", 3))
    depth_sensor.add_read_only_option(rs.option.depth_units, DEPTH_UNIT_M)
    depth.register_extrinsics_to(color, _extrinsics(rs, optics))
    recorder = rs.recorder(str(path), device)
    queue = rs.frame_queue(len(shots) * 2)
    sensors = recorder.query_sensors()
    for sensor, profile in zip(sensors, (depth, color), strict=True):
        sensor.open(profile)
        sensor.start(queue)
    for number, (depth_image, color_image) in enumerate(shots, start=1):
        depth_sensor.on_video_frame(_frame(rs, depth, depth_image, number))
        color_sensor.on_video_frame(_frame(rs, color, color_image, number))
        time.sleep(1 / RATE)  # the recorder also writes down when frames came, and playback keeps that pace
    for sensor in sensors:
        sensor.stop()
        sensor.close()


def lens_as_declared(rs: Any, optics: Optics, lens: Lens) -> Any:
    """Return librealsense's own record of a lens."""
    intrinsics = rs.intrinsics()
    intrinsics.width, intrinsics.height = optics.width, optics.height
    intrinsics.fx = intrinsics.fy = lens.fx
    intrinsics.ppx, intrinsics.ppy = lens.cx, lens.cy
    intrinsics.coeffs = list(lens.coefficients)
    intrinsics.model = getattr(rs.distortion, lens.model)
    return intrinsics


def _stream(rs: Any, optics: Optics, lens: Lens, kind: str, pixel_format: str, bytes_per_pixel: int) -> Any:
    stream = rs.video_stream()
    stream.type, stream.fmt = getattr(rs.stream, kind), getattr(rs.format, pixel_format)
    stream.uid, stream.index, stream.bpp, stream.fps = bytes_per_pixel, 0, bytes_per_pixel, RATE
    stream.width, stream.height = optics.width, optics.height
    stream.intrinsics = lens_as_declared(rs, optics, lens)
    return stream


def _extrinsics(rs: Any, optics: Optics) -> Any:
    extrinsics = rs.extrinsics()
    extrinsics.rotation = optics.rotation.T.ravel().tolist()  # column by column
    extrinsics.translation = list(optics.translation_m)
    return extrinsics


def _frame(rs: Any, profile: Any, image: npt.NDArray[Any], number: int) -> Any:
    frame = rs.software_video_frame()
    frame.pixels = np.ascontiguousarray(image)
    frame.bpp = image.nbytes // (image.shape[0] * image.shape[1])
    frame.stride = image.shape[1] * frame.bpp
    frame.timestamp = FIRST_MS + number * 1000 / RATE
    frame.domain = rs.timestamp_domain.hardware_clock
    frame.frame_number = number
    frame.profile = profile.as_video_stream_profile()
    frame.depth_units = DEPTH_UNIT_M
    return frame
