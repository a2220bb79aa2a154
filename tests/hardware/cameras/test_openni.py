"""The real OpenNI package, library and its dummy device; no camera."""

from __future__ import annotations

import ctypes
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from core.scan.model import Intrinsics
from hardware.cameras.openni import INSTALL, OpenNICamera
from hardware.cameras.timing import FRAMES_IN_FLIGHT
from hardware.errors import CameraLost, DriverMissing

ROOT = Path(__file__).resolve().parents[3]


def _run(what: str) -> Any:
    pytest.importorskip("openni.openni2", reason=f"needs OpenNI: {INSTALL}")
    try:
        ctypes.CDLL("libOpenNI2.so.0")
    except OSError:
        pytest.skip(f"needs OpenNI's library: {INSTALL}")
    command = [sys.executable, "-m", "tests.hardware.cameras.openni_dummy", what]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_no_camera_is_a_sentence() -> None:
    found = _run("no device")
    if found["kind"] == "none":
        pytest.skip("an OpenNI camera is connected")
    assert found["kind"] == "CameraLost"
    assert found["sentence"].startswith("No PrimeSense or other OpenNI camera is connected; plug it")


def test_a_missing_library_names_what_to_install() -> None:
    found = _run("no library")
    assert found["kind"] == "DriverMissing"
    assert "libNoSuchOpenNI.so.0" in found["sentence"]
    assert "apt-get install libopenni2-0 && .venv/bin/pip install" in found["sentence"]


def test_a_missing_package_names_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "openni.openni2", None)
    with pytest.raises(DriverMissing, match=r"apt-get install libopenni2-0 && .*'\.\[openni\]'"):
        OpenNICamera(Intrinsics(1, 1, 0, 0)).__enter__()


def test_a_camera_that_cannot_register_is_refused() -> None:
    found = _run("refusal")
    assert found["kind"] == "CameraError"
    assert "cannot register its depth to its colour" in found["sentence"]


def test_the_dummy_device_is_read_as_a_camera() -> None:
    found = _run("frames")
    assert found["name"] == "Table Tennis"
    assert found["shapes"] == [[240, 320, 3], [240, 320]]
    assert found["types"] == ["uint8", "float32"]
    assert found["top_row_m"] == [2.0]  # 2000 mm
    assert found["colour_corner"] == [0, 0, 255]  # blue: the order is red, green, blue
    first, second = found["ball"]
    assert second - first >= 0.5 * 30 + FRAMES_IN_FLIGHT
    assert found["times"][1] - found["times"][0] > 0.5


def test_what_is_asked_of_the_device() -> None:
    requests = _run("frames")["requests"]
    assert "DEPTH_TO_COLOR" in requests[0]
    for stream, pixel_format in ((requests[1:3], "DEPTH_1_MM"), (requests[3:5], "RGB888")):
        assert stream[0].startswith("(640, 480, 30, ")
        assert pixel_format in stream[0]
        assert stream[1] == "mirroring False"


def test_silence_and_absence_are_told_apart() -> None:
    found = _run("frames")
    assert found["silent"] == [
        "CameraError",
        "The Table Tennis gave no image (no new image within 0.3 s); try again.",
    ]
    assert found["gone"] == ["CameraLost", "The Table Tennis was unplugged; plug it in and connect again."]


def test_it_must_be_connected_first() -> None:
    with pytest.raises(CameraLost, match="not connected"):
        OpenNICamera(Intrinsics(1, 1, 0, 0)).capture()
