"""A scan judged by its colour images alone, view by view (Sec. V-A)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from core.appearance.crops import Square, cropped, object_square, quarter_turns
from core.appearance.network import Look, Network
from core.geometry import BoolArray
from core.scan.model import ColorImage, CropBox, Intrinsics, RgbdFrame, Scan

CONTAINS = 0.5
"""A score above this is an open container; a cell above it contains."""
_OVERLAY = np.array([40.0, 220.0, 90.0])
_OVERLAY_SHARE = 0.55


@dataclass(frozen=True)
class ViewLook:
    """What a view looks like.

    Attributes:
        square: of the image that was looked at.
        look: what the network says of it.
    """

    square: Square
    look: Look

    @property
    def has_contain(self) -> bool:
        """Whether any of it contains."""
        return bool((self.look.contain > CONTAINS).any())

    def contain_map(self, shape: tuple[int, ...]) -> npt.NDArray[np.float32]:
        """Return the map at the image's size (H, W): how surely each pixel contains, 0 outside the square."""
        cells = self.look.contain
        rows, columns = np.mgrid[: shape[0], : shape[1]]
        row = np.floor((rows + 0.5 - self.square.top_px) * len(cells) / self.square.side_px).astype(int)
        column = np.floor((columns + 0.5 - self.square.left_px) * len(cells) / self.square.side_px).astype(
            int
        )
        is_inside = (np.minimum(row, column) >= 0) & (np.maximum(row, column) < len(cells))
        found = np.zeros(shape[:2], dtype=np.float32)
        found[is_inside] = cells[row[is_inside], column[is_inside]]
        return found

    def overlaid(self, color: ColorImage) -> ColorImage:
        """Return the image (H, W, 3) with the map in green, the surer the stronger, in its frame."""
        share = _OVERLAY_SHARE * self.contain_map(color.shape)[..., None]
        share[self._frame(color.shape)] = 1.0
        mixed: ColorImage = (color * (1 - share) + _OVERLAY * share).astype(np.uint8)
        return mixed

    def _frame(self, shape: tuple[int, ...]) -> BoolArray:
        on_frame = np.zeros(shape[:2], dtype=np.bool_)
        left, top = round(self.square.left_px), round(self.square.top_px)
        right, bottom = left + round(self.square.side_px), top + round(self.square.side_px)
        rows = slice(max(top, 0), max(bottom, 0))
        columns = slice(max(left, 0), max(right, 0))
        for row in (top, bottom):
            if 0 <= row < shape[0]:
                on_frame[row, columns] = True
        for column in (left, right):
            if 0 <= column < shape[1]:
                on_frame[rows, column] = True
        return on_frame


def look_at_view(network: Network, frame: RgbdFrame, intrinsics: Intrinsics, box: CropBox) -> ViewLook | None:
    """Look at the object in a view; none if the view does not show it.

    The paper's authors cropped it by hand; here what was measured within its box tells where it is. The
    network sees it upright; its map is turned back to the image.
    """
    square = object_square(frame, intrinsics, box)
    if square is None:
        return None
    turns = quarter_turns(frame.T_base_camera)
    upright = network.look(np.rot90(cropped(frame.color, square), turns))
    return ViewLook(square, replace(upright, contain=np.rot90(upright.contain, -turns)))


def look_at_scan(network: Network, scan: Scan, box: CropBox) -> tuple[ViewLook | None, ...]:
    """Look at every view of a scan, in their order."""
    return tuple(look_at_view(network, frame, scan.intrinsics, box) for frame in scan.frames)


def top_down_view(scan: Scan) -> int:
    """Return the index of the view that looks most steeply down."""
    return int(np.argmin([frame.T_base_camera[2, 2] for frame in scan.frames]))
