"""Runs in a process of its own: the dummy device of libopenni2 ends its process badly when its streams stop.

It knows neither 640 x 480 nor registration nor mirroring. To read frames these three requests are noted
instead of sent; everything else goes through the real package, library and driver.
"""

from __future__ import annotations

import json
import os
import sys
import time
from typing import Any

import numpy as np

from core.scan.model import Intrinsics
from hardware.cameras import openni
from hardware.errors import CameraError

INTRINSICS = Intrinsics(532.6, 532.2, 316.0, 236.0)


def main(what: str) -> dict[str, Any]:
    if what == "no device":
        return _refused(openni.OpenNICamera(INTRINSICS))
    if what == "no library":
        openni._LIBRARY = "libNoSuchOpenNI.so.0"
        return _refused(openni.OpenNICamera(INTRINSICS))
    camera = openni.OpenNICamera(INTRINSICS, "Dummy")
    if what == "refusal":
        return _refused(camera)
    driver = openni._load_driver()
    requests = _note_requests(driver)
    camera.__enter__()
    return {"name": camera.name, "requests": requests, **_captured(camera, driver)}


def _refused(camera: openni.OpenNICamera) -> dict[str, Any]:
    try:
        camera.__enter__()
    except Exception as error:
        return {"kind": type(error).__name__, "sentence": str(error)}
    return {"kind": "none"}


def _note_requests(driver: Any) -> list[str]:
    requests: list[str] = []
    driver.Device.is_image_registration_mode_supported = lambda _, mode: True
    driver.Device.set_image_registration_mode = lambda _, mode: requests.append(f"{mode}")
    driver.VideoStream.configure_mode = lambda _, *mode: requests.append(f"{mode}")
    driver.VideoStream.set_mirroring_enabled = lambda _, on: requests.append(f"mirroring {on}")
    return requests


def _captured(camera: openni.OpenNICamera, driver: Any) -> dict[str, Any]:
    first = camera.capture()
    time.sleep(0.5)
    second = camera.capture()
    openni.WAIT_S = 0.3
    camera._link._streams[1].stop()
    silent = _failure(camera)
    driver.Device.enumerate_uris = list
    return {
        "shapes": [second.color.shape, second.depth_m.shape],
        "types": [str(second.color.dtype), str(second.depth_m.dtype)],
        "top_row_m": np.unique(second.depth_m[0]).tolist(),
        "colour_corner": second.color[0, 0].tolist(),
        "ball": [_ball_column(first.depth_m), _ball_column(second.depth_m)],
        "times": [first.time_s, second.time_s],
        "silent": silent,
        "gone": _failure(camera),
    }


def _ball_column(depth_m: Any) -> int:
    """Where the ball's right edge is: it moves one column a frame."""
    return int(np.nonzero(depth_m[1:].any(axis=0))[0].max())


def _failure(camera: openni.OpenNICamera) -> list[str]:
    try:
        camera.capture()
    except CameraError as error:
        return [type(error).__name__, str(error)]
    return ["none", ""]


if __name__ == "__main__":
    print(json.dumps(main(sys.argv[1])), flush=True)
    os._exit(0)
