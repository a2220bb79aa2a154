"""Cameras that speak OpenNI 2: the PrimeSense Carmine 1.09 and its kin (Asus Xtion, first Kinect)."""

from __future__ import annotations

import importlib
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import numpy.typing as npt

from core.scan.model import Intrinsics
from hardware.cameras.timing import FRAMES_IN_FLIGHT, SETTLING_FRAMES, WAIT_S
from hardware.errors import CameraError, CameraLost, DriverMissing
from hardware.interfaces import CameraImage

INSTALL = "sudo apt-get install libopenni2-0 && .venv/bin/pip install -e '.[openni]' -c constraints.txt"
WIDTH, HEIGHT, FRAMES_PER_SECOND = 640, 480, 30
_LIBRARY = "libOpenNI2.so.0"
_MILLIMETRE_M = np.float32(0.001)


class OpenNICamera:
    """A PrimeSense Carmine 1.09: 640 x 480 at 30 Hz, its depth registered to the colour by the device.

    Tested with libopenni2 and its own dummy device: loading, finding, reading and converting frames,
    freshness, time-out, refusal of a device that cannot register. Not tested, for want of a camera: that a
    Carmine accepts the mode, the registration and the mirroring as they are requested here, and what it does
    when it is unplugged.

    Attributes:
        name: maker and model, once connected.
    """

    def __init__(self, intrinsics: Intrinsics, uri: str | None = None) -> None:
        """Choose a camera; entering connects it.

        Args:
            intrinsics: of the colour camera at 640 x 480, by calibration: the device knows only its field of
                view.
            uri: the device's OpenNI address; none: the first that is found.
        """
        self.name = f"OpenNI camera {uri or ''}".rstrip()
        self._intrinsics = intrinsics
        self._uri = uri
        self._link: _Link | None = None

    def __enter__(self) -> OpenNICamera:
        """Connect, and wait until exposure has settled.

        Raises:
            DriverMissing: the Python package or the system's library is not installed.
            CameraLost: the device is not connected.
            CameraError: it cannot do what is needed, or sends nothing.
        """
        driver = _load_driver()
        self._link = _Link(driver, self._open(driver))
        try:
            self.name = self._link.describe() or self.name
            with self._explained(driver):
                self._link.start()
        except BaseException:
            self.__exit__(None, None, None)
            raise
        return self

    def __exit__(self, *exception: object) -> None:
        """Disconnect. The library stays loaded: other cameras may be using it."""
        if self._link is not None:
            self._link.close()
            self._link = None

    def capture(self) -> CameraImage:
        """Return an image whose colour and depth were both exposed after the call.

        `time_s` counts on the computer's monotonic clock, at arrival.

        Raises:
            CameraError: no new image came in time.
            CameraLost: the device is not there any more.
        """
        if self._link is None:
            raise CameraLost(f"The camera {self.name} is not connected; connect it first.")
        with self._explained(self._link.driver):
            depth_mm, color = self._link.fresh_images()
        depth_m = depth_mm * _MILLIMETRE_M
        return CameraImage(color, depth_m, self._intrinsics, time.monotonic())

    def _open(self, driver: Any) -> Any:
        try:
            return driver.Device(None if self._uri is None else self._uri.encode())
        except driver.OpenNIError as error:
            wanted = "No PrimeSense or other OpenNI camera" if self._uri is None else f"No camera {self._uri}"
            raise CameraLost(f"{wanted} is connected; plug it into a USB port and try again.") from error

    @contextmanager
    def _explained(self, driver: Any) -> Iterator[None]:
        """Turn silence and the driver's own errors into a sentence."""
        try:
            yield
        except (TimeoutError, driver.OpenNIError) as error:
            assert self._link is not None
            if not self._link.is_connected():
                raise CameraLost(f"The {self.name} was unplugged; plug it in and connect again.") from error
            reason = f"no new image within {WAIT_S:g} s" if isinstance(error, TimeoutError) else error.args[1]
            raise CameraError(f"The {self.name} gave no image ({reason}); try again.") from error


class _Link:
    """An open device with its two streams."""

    def __init__(self, driver: Any, device: Any) -> None:
        self.driver = driver
        self._device = device
        self._streams: list[Any] = []  # depth, colour

    def describe(self) -> str:
        """Return maker and model."""
        info = self._device.get_device_info()
        return f"{info.vendor.decode()} {info.name.decode()}".strip()

    def start(self) -> None:
        """Configure and start both streams, and let the first frames go."""
        driver = self.driver
        registered = driver.IMAGE_REGISTRATION_DEPTH_TO_COLOR
        if not self._device.is_image_registration_mode_supported(registered):
            raise CameraError(
                f"The {self.describe()} cannot register its depth to its colour; use a camera that can, "
                "such as the Carmine 1.09."
            )
        self._device.set_image_registration_mode(registered)
        formats = {
            driver.SENSOR_DEPTH: driver.PIXEL_FORMAT_DEPTH_1_MM,
            driver.SENSOR_COLOR: driver.PIXEL_FORMAT_RGB888,
        }
        for sensor, pixel_format in formats.items():
            stream = self._device.create_stream(sensor)
            self._streams.append(stream)
            stream.configure_mode(WIDTH, HEIGHT, FRAMES_PER_SECOND, pixel_format)
            stream.set_mirroring_enabled(False)
            stream.start()
        for _ in range(SETTLING_FRAMES * len(self._streams)):
            self._next_frame(time.monotonic() + WAIT_S)[1].close()

    def fresh_images(self) -> tuple[npt.NDArray[np.uint16], npt.NDArray[np.uint8]]:
        """Return depth (H, W) in millimetres and colour (H, W, 3); TimeoutError when they do not come.

        The first frame of a stream may have waited for the call and some more were in flight; only what is
        newer than these was exposed after the call.
        """
        deadline = time.monotonic() + WAIT_S
        oldest: dict[int, int] = {}
        images: dict[int, Any] = {}
        while len(images) < len(self._streams):
            index, frame = self._next_frame(deadline)
            if frame.frameIndex > oldest.setdefault(index, frame.frameIndex + FRAMES_IN_FLIGHT):
                images[index] = _pixels(frame, is_depth=index == 0)
            frame.close()
        return images[0], images[1]

    def is_connected(self) -> bool:
        """Whether the device is still plugged in."""
        return self._device.uri in self.driver.Device.enumerate_uris()

    def close(self) -> None:
        """Close the streams before the device, as OpenNI wants it."""
        for stream in self._streams:
            stream.close()
        self._device.close()

    def _next_frame(self, deadline: float) -> tuple[int, Any]:
        """Return which stream had a frame, and the frame. Asking for it without waiting may hang for ever."""
        stream = self.driver.wait_for_any_stream(self._streams, max(deadline - time.monotonic(), 0))
        if stream is None:
            raise TimeoutError
        return self._streams.index(stream), stream.read_frame()


def _pixels(frame: Any, *, is_depth: bool) -> Any:
    """Copy what lies in OpenNI's memory, which it uses again."""
    if is_depth:
        return np.array(frame.get_buffer_as_uint16(), np.uint16).reshape(frame.height, frame.width)
    return np.array(frame.get_buffer_as_uint8(), np.uint8).reshape(frame.height, frame.width, 3)


def _load_driver() -> Any:
    try:
        driver: Any = importlib.import_module("openni.openni2")
        if driver.loaded_dll_directory is None:
            # The package looks for the file without a version number, which Debian has for developers only;
            # a library that is loaded already it takes as it is.
            importlib.import_module("openni._openni2").load_dll(_LIBRARY)
            driver.loaded_dll_directory = _LIBRARY
    except (ImportError, OSError) as error:
        raise DriverMissing(f"The OpenNI driver is missing ({error}); install it with: {INSTALL}") from error
    try:
        driver.initialize()
    except driver.OpenNIError as error:
        raise DriverMissing(f"OpenNI does not start ({error.args[1]}); install it anew: {INSTALL}") from error
    return driver
