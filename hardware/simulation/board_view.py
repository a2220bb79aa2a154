"""What a camera sees of a calibration board: perspective, distortion, blur and noise, from its exact pose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.calibration.board import BoardSpec
from core.calibration.lens import Lens
from core.geometry import AnyArray, BoolArray, FloatArray, invert_pose, make_pose
from core.scan.model import ColorImage

_FINE = 3
"""Rays along a pixel's side: their mean is what the pixel sees."""
_QUIET_SQUARES = 0.4
"""White paper around the squares."""
_PAPER, _INK = 235.0, 25.0


@dataclass(frozen=True)
class BoardLook:
    """How sharp and clean a board is seen.

    Attributes:
        blur_px: standard deviation of the blur.
        noise_levels: standard deviation of a pixel's brightness, of 255.
        motion_px: (2,) by how much the image moves during the exposure.
        is_mirrored: whether the board was printed the wrong way round.
    """

    blur_px: float = 0.6
    noise_levels: float = 2.0
    motion_px: tuple[float, float] = (0.0, 0.0)
    is_mirrored: bool = False


class BoardPainter:
    """Paints a board into colour images of a lens."""

    def __init__(self, board: BoardSpec, lens: Lens, size_px: tuple[int, int]) -> None:
        """Prepare the rays of an image of so many columns and rows."""
        self.board = board
        self._lens = lens
        width, height = size_px
        step = (np.arange(_FINE) + 0.5) / _FINE - 0.5
        columns = (np.arange(width)[:, None] + step).ravel()
        rows = (np.arange(height)[:, None] + step).ravel()
        grid = np.stack(np.meshgrid(columns, rows), axis=-1).reshape(-1, 2)
        self._rays = lens.rays(grid).reshape(len(rows), len(columns), 3)
        pixels = np.stack(np.meshgrid(np.arange(width, dtype=float), np.arange(height)), axis=-1)
        self._depth_rays = Lens(lens.intrinsics).rays(pixels.reshape(-1, 2)).reshape(height, width, 3)
        cells = board.cells()
        self._ink = np.where(cells, _INK, _PAPER).astype(np.float32)
        self._cells_per_m = cells.shape[1] / board.size_m[0]

    def paint(
        self,
        background: ColorImage,
        T_camera_board: FloatArray,
        look: BoardLook,
        random: np.random.Generator,
    ) -> tuple[ColorImage, FloatArray]:
        """Paint the board over a background (H, W, 3).

        Args:
            background: what is seen where the board is not.
            T_camera_board: (4, 4) where it really is.
            look: how it is seen.
            random: of the noise.

        Returns:
            the image (H, W, 3) as the lens shows it, and the board's depth (H, W) in metres, as drivers give
            it: where a pinhole sees it, infinite elsewhere.
        """
        import cv2

        height, width = background.shape[:2]
        _, on_board, u, v = self._hits(T_camera_board, self._rays)
        if look.is_mirrored:
            u = self._ink.shape[1] - 1 - u
        seen = cv2.remap(
            self._ink, u.astype(np.float32), v.astype(np.float32), cv2.INTER_NEAREST,
            borderMode=cv2.BORDER_CONSTANT, borderValue=_PAPER,
        )  # fmt: skip
        cover = on_board.astype(np.float32)
        ink, share = (
            cv2.resize(_blurred(fine, look), (width, height), interpolation=cv2.INTER_AREA)[..., None]
            for fine in (seen * cover, cover)
        )
        small = background * (1 - share) + ink
        noise = random.standard_normal((height, width, 3), dtype=np.float32) * look.noise_levels
        depth_m = self._hits(T_camera_board, self._depth_rays)[0]
        return np.clip(small + noise, 0, 255).astype(np.uint8), depth_m

    def _hits(
        self, T_camera_board: FloatArray, rays: FloatArray
    ) -> tuple[FloatArray, BoolArray, FloatArray, FloatArray]:
        """Depth, whether the paper is met, and the place in cells, of rays (H, W, 3) from the camera."""
        T_board_camera = invert_pose(T_camera_board)
        origin, rays = T_board_camera[:3, 3], rays @ T_board_camera[:3, :3].T
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = -origin[2] / rays[..., 2]
            x = origin[0] + reach * rays[..., 0]
            y = origin[1] + reach * rays[..., 1]
        quiet_m = _QUIET_SQUARES * self.board.square_m
        width_m, height_m = self.board.size_m
        on_board = (reach > 0) & (x > -quiet_m) & (x < width_m + quiet_m)
        on_board &= (y > -quiet_m) & (y < height_m + quiet_m)
        on_board &= bool(origin[2] < 0)  # its back is blank, and not modelled
        reach = np.where(on_board, reach, np.inf)
        scale = self._cells_per_m
        return (
            reach,
            on_board,
            np.where(on_board, x * scale - 0.5, -1.0),
            np.where(on_board, y * scale - 0.5, -1.0),
        )


def _blurred(fine: AnyArray, look: BoardLook) -> AnyArray:
    import cv2

    if look.blur_px > 0:
        fine = cv2.GaussianBlur(fine, (0, 0), look.blur_px * _FINE)
    length = round(float(np.hypot(*look.motion_px)) * _FINE)
    if length < 2:
        return fine
    size = length | 1
    kernel = np.zeros((size, size), dtype=np.float32)
    middle = size // 2
    across = np.array(look.motion_px) / np.hypot(*look.motion_px) * middle
    ends = [(round(middle + s * across[0]), round(middle + s * across[1])) for s in (-1, 1)]
    cv2.line(kernel, ends[0], ends[1], 1.0)
    return np.asarray(cv2.filter2D(fine, -1, kernel / kernel.sum()))


def lying_board(board: BoardSpec, middle_m: FloatArray, yaw_rad: float) -> FloatArray:
    """Return `T_base_board` (4, 4) of a board that lies face up, its middle at a point (3,)."""
    c, s = np.cos(yaw_rad), np.sin(yaw_rad)
    turn = np.array([[c, s, 0], [s, -c, 0], [0, 0, -1]])
    return make_pose(turn, middle_m) @ make_pose(np.eye(3), -board.center_m)
