"""From the images librealsense aligns to pinhole colour with depth along the same optical axis."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.ndimage import map_coordinates

from core.geometry import FloatArray
from core.scan.model import ColorImage, DepthImage, Intrinsics
from hardware.errors import CameraError


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
