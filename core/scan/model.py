"""What a scan is: colour and depth images with the pose each was taken from (Sec. IV-A)."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan, degrees

import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray, transform_points
from core.parameters.reconstruction import ReconstructionParameters

ColorImage = npt.NDArray[np.uint8]
DepthImage = npt.NDArray[np.float32]


@dataclass(frozen=True)
class Intrinsics:
    """A pinhole camera in pixels, `u = fx x / z + cx`, `v = fy y / z + cy`; z forward, y down."""

    fx: float
    fy: float
    cx: float
    cy: float

    @property
    def matrix(self) -> FloatArray:
        """Camera matrix (3, 3)."""
        return np.array([[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]])

    def field_of_view_deg(self, image_size: tuple[float, float]) -> tuple[float, float]:
        """Angles that an image of this width and height in pixels sees, about its middle."""
        width, height = image_size
        return 2 * degrees(atan(width / 2 / self.fx)), 2 * degrees(atan(height / 2 / self.fy))


@dataclass(frozen=True)
class RgbdFrame:
    """One view.

    Attributes:
        name: what its files are called, such as `frame-000150`.
        color: (H, W, 3) uint8, RGB.
        depth_m: (H, W) float32, distance along the optical axis; 0 where nothing was measured.
        T_base_camera: (4, 4), camera points to the robot's base frame.
    """

    name: str
    color: ColorImage
    depth_m: DepthImage
    T_base_camera: FloatArray

    def points_m(self, intrinsics: Intrinsics, *, max_depth_m: float, stride: int = 1) -> FloatArray:
        """Measured points (N, 3) in the base frame, of every `stride`-th row and column."""
        depth = self.depth_m[::stride, ::stride].astype(float)
        rows, columns = np.nonzero((depth > 0) & (depth <= max_depth_m))
        z = depth[rows, columns]
        x = (columns * stride - intrinsics.cx) / intrinsics.fx * z
        y = (rows * stride - intrinsics.cy) / intrinsics.fy * z
        return transform_points(self.T_base_camera, np.column_stack([x, y, z]))


@dataclass(frozen=True)
class CropBox:
    """The box that holds the object: its lower and upper corner (3,) in the robot's base frame."""

    min_m: tuple[float, float, float]
    max_m: tuple[float, float, float]


def crop_box(min_m: npt.ArrayLike, max_m: npt.ArrayLike) -> CropBox:
    """Make a box of two corners (3,)."""
    low, high = np.asarray(min_m, dtype=float).tolist(), np.asarray(max_m, dtype=float).tolist()
    return CropBox((low[0], low[1], low[2]), (high[0], high[1], high[2]))


@dataclass(frozen=True)
class Scan:
    """All views of one object, and what is known of the place where it stood.

    Attributes:
        frames: the views.
        intrinsics: of the camera that took them.
        platform_height_m: the transparent platform's top in the base frame; none: not known.
        crop_box: where the object stood; none: not known.
    """

    frames: tuple[RgbdFrame, ...]
    intrinsics: Intrinsics
    platform_height_m: float | None = None
    crop_box: CropBox | None = None


RELEASED_BOX = CropBox((-0.30, -0.55, 0.03), (0.18, -0.15, 0.35))
"""The grid of the released code, in the base frame of the authors' robot."""


def crop_box_of(scan: Scan | None, parameters: ReconstructionParameters) -> CropBox:
    """Return the object's box: the parameters' own, else the scan's, else the released code's."""
    if parameters.crop_min_m is not None and parameters.crop_max_m is not None:
        return CropBox(parameters.crop_min_m, parameters.crop_max_m)
    if scan is not None and scan.crop_box is not None:
        return scan.crop_box
    return RELEASED_BOX
