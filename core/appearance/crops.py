"""The square of a view that shows the object, "to subtract the background" (Sec. V-A)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from core.geometry import AnyArray, FloatArray, transform_points
from core.scan.model import ColorImage, CropBox, Intrinsics, RgbdFrame

SIZE_PX = 96
"""Side of what the network is given."""
MARGIN = 1.2
"""Side of the square in lengths of the object's larger extent in the image."""
_TAIL = 0.002
"""Share of the object's pixels that may lie outside on each side: single wrong depths do not matter."""
_FEWEST_PX = 30
_MOST_OUTSIDE = 0.5

Crop = npt.NDArray[np.float32]


@dataclass(frozen=True)
class Square:
    """A square in an image; it may reach beyond it.

    Attributes:
        left_px: of its left edge, from the image's.
        top_px: of its upper edge, from the image's.
        side_px: its length.
    """

    left_px: float
    top_px: float
    side_px: float

    def pixels(self, cells: AnyArray, n: int) -> FloatArray:
        """Return columns and rows (N, 2), in pixels, of cells (N, 2) of a grid of `n` by `n` over it."""
        corner = np.array([self.left_px, self.top_px])
        places: FloatArray = corner + (np.asarray(cells, dtype=float) + 0.5) * self.side_px / n - 0.5
        return places


def square_around(columns_px: AnyArray, rows_px: AnyArray) -> Square:
    """Return the square with a margin around places (N,) in an image."""
    low = np.array([columns_px.min(), rows_px.min()])
    high = np.array([columns_px.max(), rows_px.max()]) + 1
    side = MARGIN * float((high - low).max())
    left, top = ((low + high - side) / 2).tolist()
    return Square(left, top, side)


def object_square(frame: RgbdFrame, intrinsics: Intrinsics, box: CropBox) -> Square | None:
    """Find the object in a view: what was measured within its box; none if that is nearly nothing."""
    rows, columns = np.nonzero(frame.depth_m > 0)
    depth_m = frame.depth_m[rows, columns].astype(float)
    x = (columns - intrinsics.cx) / intrinsics.fx * depth_m
    y = (rows - intrinsics.cy) / intrinsics.fy * depth_m
    points_m = transform_points(frame.T_base_camera, np.column_stack([x, y, depth_m]))
    is_object = ((points_m >= box.min_m) & (points_m <= box.max_m)).all(axis=1)
    if is_object.sum() < _FEWEST_PX:
        return None
    tails = [_TAIL, 1 - _TAIL]
    return square_around(np.quantile(columns[is_object], tails), np.quantile(rows[is_object], tails))


def quarter_turns(T_base_camera: FloatArray) -> int:
    """Return how many quarter turns (`numpy.rot90`) bring a view upright, as a photograph is taken.

    The hand holds the camera at any angle, which says nothing of the object, but makes it harder to know.
    """
    right, down = T_base_camera[2, :2]  # where up is in the image
    return round(float(np.arctan2(right, -down)) / (np.pi / 2)) % 4


def cropped(color: ColorImage, square: Square) -> Crop:
    """Return a square of an image (H, W, 3) at the network's size: (96, 96, 3), from 0 to 1.

    Beyond the image its border is repeated.
    """
    from PIL import Image

    height, width = color.shape[:2]
    reach = int(np.ceil(_MOST_OUTSIDE * max(height, width, square.side_px)))
    padded = np.pad(color, ((reach, reach), (reach, reach), (0, 0)), mode="edge")
    left, top = square.left_px + reach, square.top_px + reach
    box = (left, top, left + square.side_px, top + square.side_px)
    small = Image.fromarray(padded).resize((SIZE_PX, SIZE_PX), Image.Resampling.BILINEAR, box=box)
    crop: Crop = np.asarray(small, dtype=np.float32) / np.float32(255)
    return crop
