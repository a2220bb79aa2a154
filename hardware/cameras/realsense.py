"""Intel RealSense depth cameras, and recordings of them, through librealsense."""

from __future__ import annotations

import importlib
import time
from pathlib import Path
from threading import Thread
from typing import Any

import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray
from core.scan.model import ColorImage, DepthImage, Intrinsics
from hardware.cameras.timing import FRAMES_IN_FLIGHT, SETTLING_FRAMES, WAIT_S
from hardware.errors import CameraError, CameraLost, DriverMissing
from hardware.interfaces import CameraImage

INSTALL = ".venv/bin/pip install -e '.[realsense]' -c constraints.txt"
FRAMES_PER_SECOND = 30
_POLL_S = 0.002


class RealSenseCamera:
    """A RealSense with depth and colour (D400 family), or a recording that librealsense made of one.

    Depth is registered to the colour and converted to metres along the colour camera's axis; a lens
    distortion the device declares is taken out. A recording gives each of its image pairs once,
    however slowly they are requested, at the size it was recorded with. Tested with recordings of
    librealsense's software device, played back and played as a live device; not with a physical camera.

    Attributes:
        name: the model with its serial number, once connected; before that what was requested.
    """

    def __init__(
        self,
        serial: str | None = None,
        playback: Path | None = None,
        width: int = 640,
        height: int = 480,
    ) -> None:
        """Choose a camera; entering connects it.

        Args:
            serial: the device's serial number; none: the first that is found.
            playback: a recording (.db3 or .bag) to play instead of a device.
            width: of the colour and the depth stream of a device, in pixels.
            height: of both, in pixels.
        """
        self.name = f"RealSense {playback or serial or 'camera'}"
        self._serial = serial
        self._playback = playback
        self._size = (width, height)
        self._link: _Link | None = None

    def __enter__(self) -> RealSenseCamera:
        """Connect, and wait until a device's exposure has settled.

        Raises:
            DriverMissing: pyrealsense2 is not installed or does not load.
            CameraLost: the device is not connected, or the recording cannot be played.
            CameraError: the device does not know the mode, or sends nothing.
        """
        driver = _load_driver()
        link = self._play(driver, self._playback) if self._playback else self._connect(driver)
        try:
            self.name = link.describe()
            if self._playback is None:
                link.settle()
        except BaseException as error:
            link.close()
            if isinstance(error, _Silence):
                raise self._explain_silence(link) from error
            raise
        self._link = link
        return self

    def __exit__(self, *exception: object) -> None:
        """Disconnect."""
        if self._link is not None:
            self._link.close()
            self._link = None

    def capture(self) -> CameraImage:
        """Return an image exposed after the call, of a recording the next one.

        `time_s` counts on the computer's monotonic clock at arrival; in a recording, on its own clock.

        Raises:
            CameraError: no new image came in time.
            CameraLost: the device is not there any more, or the recording has ended.
        """
        if self._link is None:
            raise CameraLost(f"The camera {self.name} is not connected; connect it first.")
        try:
            return self._link.capture()
        except _Silence as error:
            raise self._explain_silence(self._link) from error

    def _play(self, driver: Any, recording: Path) -> _Link:
        if not recording.is_file():
            raise CameraLost(
                f"There is no recording {recording}; give a .db3 or .bag file made by librealsense."
            )
        config = driver.config()
        config.enable_device_from_file(str(recording), repeat_playback=False)
        config.enable_stream(driver.stream.depth, driver.format.z16, 0)
        config.enable_stream(driver.stream.color, driver.format.rgb8, 0)
        try:
            link = _Link(driver, driver.context(), config, is_recording=True)
        except RuntimeError as error:
            reason = str(error).rpartition("Reason: ")[2]
            raise CameraLost(
                f"The recording {recording} cannot be played ({reason}); copy it again, or record depth "
                "(z16) and colour (rgb8) together."
            ) from error
        return link

    def _connect(self, driver: Any) -> _Link:
        context = driver.context()
        serial = self._find(_connected_serials(driver, context))
        width, height = self._size
        config = driver.config()
        config.enable_device(serial)
        config.enable_stream(driver.stream.depth, width, height, driver.format.z16, FRAMES_PER_SECOND)
        config.enable_stream(driver.stream.color, width, height, driver.format.rgb8, FRAMES_PER_SECOND)
        try:
            return _Link(driver, context, config, is_recording=False)
        except RuntimeError as error:
            raise CameraError(
                f"The RealSense {serial} does not start with {width} x {height} at {FRAMES_PER_SECOND} Hz "
                f"({error}); use a USB 3 port, or close other programs that use it."
            ) from error

    def _find(self, connected: list[str]) -> str:
        if not connected:
            raise CameraLost("No RealSense camera is connected; plug it into a USB 3 port and try again.")
        if self._serial is None:
            return connected[0]
        if self._serial not in connected:
            raise CameraLost(
                f"The RealSense {self._serial} is not connected; there is {', '.join(connected)}: "
                "plug it in or correct the serial number."
            )
        return self._serial

    def _explain_silence(self, link: _Link) -> CameraError:
        if self._playback is not None:
            if link.recording_has_ended():
                return CameraLost(f"The recording {self._playback} has ended; connect again to play it anew.")
            return CameraError(
                f"The recording {self._playback} gave no image within {WAIT_S:g} s; try again."
            )
        if not link.is_connected():
            return CameraLost(f"The camera {self.name} was unplugged; plug it in and connect again.")
        return CameraError(
            f"The camera {self.name} sent no new image within {WAIT_S:g} s; try again, and check its cable "
            "if this happens often."
        )


class _Silence(Exception):
    """No image came in time."""


class _Link:
    """A pipeline that runs, with what is needed to read its images."""

    def __init__(self, driver: Any, context: Any, config: Any, *, is_recording: bool) -> None:
        """Start it; librealsense raises RuntimeError when it cannot."""
        self._driver = driver
        self._context = context
        self._is_recording = is_recording
        self._last = (-1, -1)
        self._align = driver.align(driver.stream.color)
        self._pipeline = driver.pipeline(context)
        profile = config.resolve(driver.pipeline_wrapper(self._pipeline))
        self._device = profile.get_device()
        color = profile.get_stream(driver.stream.color).as_video_stream_profile()
        depth_to_color = profile.get_stream(driver.stream.depth).get_extrinsics_to(color)
        self._rate = color.fps()
        self._optics = ColorOptics(driver, color.get_intrinsics(), depth_to_color)
        self._depth_scale_m = self._device.first_depth_sensor().get_depth_scale()
        if is_recording:
            self._start_recording(config)
        else:
            self._pipeline.start(config)

    def describe(self) -> str:
        """Return the model and its serial number."""
        info = self._driver.camera_info
        parts = [self._device.get_info(kind) for kind in (info.name, info.serial_number) if self._has(kind)]
        return " ".join(parts)

    def settle(self) -> None:
        """Let the first frames go."""
        self._frames_after(SETTLING_FRAMES, WAIT_S + SETTLING_FRAMES / self._rate)

    def capture(self) -> CameraImage:
        """Return the next image that counts; `_Silence` when none comes."""
        frames = self._unseen_frames() if self._is_recording else self._frames_after(FRAMES_IN_FLIGHT, WAIT_S)
        seconds = frames.get_timestamp() / 1000 if self._is_recording else time.monotonic()
        color = np.asanyarray(frames.get_color_frame().get_data())
        depth = np.asanyarray(self._align.process(frames).get_depth_frame().get_data())
        return CameraImage(
            self._optics.color(color),
            self._optics.depth_m(depth, self._depth_scale_m),
            self._optics.intrinsics,
            seconds,
        )

    def recording_has_ended(self) -> bool:
        """Whether all of it was played."""
        return bool(self._device.as_playback().current_status() == self._driver.playback_status.stopped)

    def is_connected(self) -> bool:
        """Whether the device is still plugged in."""
        serial = self._device.get_info(self._driver.camera_info.serial_number)
        return serial in _connected_serials(self._driver, self._context)

    def close(self) -> None:
        """Stop the streams."""
        self._pipeline.stop()

    def _start_recording(self, config: Any) -> None:
        """Start so that no image is lost.

        The streams start one after the other; without the pause the first would run while the others cannot
        take their images yet. Resuming waits until somebody takes images, so it must not hold up the caller.
        """
        playback = self._device.as_playback()
        playback.set_real_time(False)
        playback.pause()
        self._pipeline.start(config)
        Thread(target=playback.resume, daemon=True).start()

    def _unseen_frames(self) -> Any:
        """Return depth and colour of a recording that were both not returned yet."""
        frames = self._frames_beyond(self._last, time.monotonic() + WAIT_S)
        self._last = _numbers(frames)
        return frames

    def _frames_after(self, count: int, wait_s: float) -> Any:
        """Let `count` frames of each stream go; the first to be had may have waited for the call, too."""
        deadline = time.monotonic() + wait_s
        depth, color = _numbers(self._next_frames(deadline))
        return self._frames_beyond((depth + count, color + count), deadline)

    def _frames_beyond(self, last: tuple[int, int], deadline: float) -> Any:
        """Return depth and colour that both have higher numbers: librealsense repeats the slower stream."""
        while True:
            frames = self._next_frames(deadline)
            if all(new > old for new, old in zip(_numbers(frames), last, strict=True)):
                return frames

    def _next_frames(self, deadline: float) -> Any:
        """Return depth and colour as they come; waiting in librealsense would restart a lost device."""
        while time.monotonic() < deadline:
            frames = self._pipeline.poll_for_frames()
            if frames and frames.get_depth_frame() and frames.get_color_frame():
                return frames
            time.sleep(_POLL_S)
        raise _Silence

    def _has(self, kind: Any) -> bool:
        return bool(self._device.supports(kind))


def _load_driver() -> Any:
    try:
        return importlib.import_module("pyrealsense2")
    except ModuleNotFoundError as error:
        raise DriverMissing(f"The RealSense driver is missing; install it with: {INSTALL}") from error
    except ImportError as error:
        raise DriverMissing(
            f"The RealSense driver does not load ({error}); install what it names, or the driver anew: "
            f"{INSTALL}"
        ) from error


def _numbers(frames: Any) -> tuple[int, int]:
    return frames.get_depth_frame().get_frame_number(), frames.get_color_frame().get_frame_number()


def _connected_serials(driver: Any, context: Any) -> list[str]:
    return [device.get_info(driver.camera_info.serial_number) for device in context.query_devices()]


class ColorOptics:
    """What a RealSense's colour camera needs so that the plain pinhole formula holds for its images.

    `rs.align` (as measured with 2.59 on x86-64) puts each depth where a colour camera without distortion
    would see it. Two things are left to do: the colour image itself is still distorted, and the depths are
    still distances along the depth camera's axis, which differ by millimetres when the two cameras are turned
    against each other.

    Attributes:
        intrinsics: of the images after `color` and `depth_m`.
    """

    def __init__(self, driver: Any, lens: Any, depth_to_color: Any) -> None:
        """Prepare for one stream.

        Args:
            driver: the module pyrealsense2.
            lens: `rs.intrinsics` of the colour stream.
            depth_to_color: `rs.extrinsics` from the depth to the colour camera.

        Raises:
            CameraError: the lens is declared with a distortion for which `rs.align` is wrong.
        """
        self.intrinsics = Intrinsics(fx=lens.fx, fy=lens.fy, cx=lens.ppx, cy=lens.ppy)
        columns, rows = np.meshgrid(np.arange(lens.width), np.arange(lens.height))
        x = (columns - lens.ppx) / lens.fx
        y = (rows - lens.ppy) / lens.fy
        self._source: FloatArray | None = None
        if any(lens.coeffs):
            _check_model(driver, lens)
            self._source = _distorted_pixels(driver, lens, x, y)
        # librealsense keeps its matrices column by column: the last three are the depth camera's axis.
        axis = np.array(depth_to_color.rotation[6:9])
        self._axis_shift_m = float(axis @ np.array(depth_to_color.translation))
        self._axis_share: FloatArray = axis[0] * x + axis[1] * y + axis[2]

    def color(self, image: ColorImage) -> ColorImage:
        """Return (H, W, 3) without distortion, as a copy."""
        if self._source is None:
            return image.copy()
        from scipy.ndimage import map_coordinates  # late: it costs the window memory

        channels = [
            map_coordinates(image[..., channel], self._source, order=1, mode="nearest")
            for channel in range(3)
        ]
        return np.stack(channels, axis=-1)

    def depth_m(self, image: npt.NDArray[np.uint16], scale_m: float) -> DepthImage:
        """Return (H, W) metres along the colour camera's axis; 0 stays 0.

        Args:
            image: (H, W) depth aligned to the colour.
            scale_m: what one unit of it is.
        """
        along_colour = (image * scale_m + self._axis_shift_m) / self._axis_share
        return np.where(image > 0, along_colour, 0).astype(np.float32)


def _check_model(driver: Any, lens: Any) -> None:
    if lens.model not in (driver.distortion.inverse_brown_conrady, driver.distortion.brown_conrady):
        raise CameraError(
            f"The camera declares a lens distortion of the kind {lens.model.name}, for which librealsense "
            "does not register depth to colour rightly; use another RealSense or another colour resolution."
        )


def _distorted_pixels(driver: Any, lens: Any, x: FloatArray, y: FloatArray) -> FloatArray:
    """Return (2, H, W): row and column in the distorted image that each pixel without distortion shows."""
    project = driver.rs2_project_point_to_pixel
    pixels = [project(lens, [a, b, 1.0]) for a, b in zip(x.flat, y.flat, strict=True)]
    return np.array(pixels).T[::-1].reshape(2, *x.shape)
