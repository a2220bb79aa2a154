"""One view of the board from a known pose of the arm, and the reasons not to use one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from core.calibration.board import BoardSpec
from core.calibration.detection import Detection
from core.calibration.lens import Lens
from core.geometry import FloatArray, IntArray, invert_pose

FEWEST_SHARE = 0.6
"""Of the board's corners, a view must show."""
MOST_BLUR_PX = 1.2
"""Standard deviation of the blur: beyond it corners move with the light's direction."""
LEAST_TILT_RAD = np.radians(10.0)
"""Nearer to frontal, a small tilt cannot be told from its mirror image."""
MOST_TILT_RAD = np.radians(65.0)
SAME_VIEW_M, SAME_VIEW_RAD = 0.010, np.radians(3.0)
_EDGE_SAMPLES = 13
_RIM_SHARE = 0.11
"""Of a square's side, on either side of its edge there is nothing else (`board.MARKER_SHARE`)."""


@dataclass(frozen=True)
class BoardView:
    """What the fit takes of one view.

    Attributes:
        name: of the view.
        T_base_flange: (4, 4) where the arm says its flange was.
        ids: (N,) which corners of the board were seen.
        corners_px: (N, 2) where, as a pinhole sees them.
        T_camera_board: (4, 4) the board's pose by this image alone.
    """

    name: str
    T_base_flange: FloatArray
    ids: IntArray
    corners_px: FloatArray
    T_camera_board: FloatArray


def board_view(name: str, T_base_flange: FloatArray, detection: Detection) -> BoardView:
    """Put together where the arm was and what the camera saw."""
    return BoardView(name, T_base_flange, detection.ids, detection.corners_px, detection.T_camera_board)


def why_unusable(
    detection: Detection,
    image: npt.NDArray[np.uint8],
    board: BoardSpec,
    lens: Lens,
    T_base_flange: FloatArray,
    taken: Sequence[BoardView],
) -> str | None:
    """Return why a view had better not be used, in a sentence that says what to do; none if it is good.

    Args:
        detection: of the board in it.
        image: (H, W) brightness.
        board: as printed.
        lens: of the camera.
        T_base_flange: (4, 4) where the arm was.
        taken: the views that are used already.
    """
    height, width = image.shape
    if len(detection.ids) < FEWEST_SHARE * board.n_corners:
        return _why_few(detection, board, lens, (width, height))
    blur_px = edge_blur_px(detection, image, board, lens)
    if blur_px > MOST_BLUR_PX:
        return f"The image is blurred ({blur_px:.1f} px); wait until the arm is still, or give more light."
    tilt_rad = board_tilt_rad(detection.T_camera_board, board)
    if tilt_rad < LEAST_TILT_RAD:
        return f"The board is seen from the front ({np.degrees(tilt_rad):.0f} degrees); tilt the camera."
    if tilt_rad > MOST_TILT_RAD:
        return (
            f"The board is seen too flat ({np.degrees(tilt_rad):.0f} degrees); look at it from further above."
        )
    for other in taken:
        if is_same_pose(T_base_flange, other.T_base_flange):
            return f"The view repeats {other.name}; turn the camera to where it has not been."
    return None


def is_same_pose(T_first: FloatArray, T_second: FloatArray) -> bool:
    """Whether two poses (4, 4) of the flange are too near to each other to tell anything new."""
    between = invert_pose(T_first) @ T_second
    return bool(np.linalg.norm(between[:3, 3]) < SAME_VIEW_M and rotation_angle_rad(between) < SAME_VIEW_RAD)


def rotation_angle_rad(T: FloatArray) -> float:
    """Return by what angle a pose (4, 4) rotates."""
    return float(np.arccos(np.clip((np.trace(T[:3, :3]) - 1) / 2, -1, 1)))


def board_tilt_rad(T_camera_board: FloatArray, board: BoardSpec) -> float:
    """Return the angle between the board's normal and the line of sight to its middle."""
    middle = T_camera_board[:3, :3] @ board.center_m + T_camera_board[:3, 3]
    return float(np.arccos(np.clip(abs(T_camera_board[:3, 2] @ middle) / np.linalg.norm(middle), 0, 1)))


def _why_few(detection: Detection, board: BoardSpec, lens: Lens, size_px: tuple[int, int]) -> str:
    pose = detection.T_camera_board
    outline_px = lens.distorted(board.outline_m @ pose[:3, :3].T + pose[:3, 3])
    sides = {
        "left": outline_px[:, 0].min() < 0,
        "right": outline_px[:, 0].max() > size_px[0] - 1,
        "top": outline_px[:, 1].min() < 0,
        "bottom": outline_px[:, 1].max() > size_px[1] - 1,
    }
    seen = f"{len(detection.ids)} of {board.n_corners} corners"
    cut = " and ".join(side for side, is_cut in sides.items() if is_cut)
    if cut:
        return f"The board is cut off at the {cut} ({seen}); show all of it."
    return f"Only {seen} of the board were found; see that nothing covers it, and that nothing glares."


def edge_blur_px(detection: Detection, image: npt.NDArray[np.uint8], board: BoardSpec, lens: Lens) -> float:
    """Return how blurred the squares' edges are, as the standard deviation of a Gaussian in pixels.

    Edges along both directions of the board are measured, and the worse is returned: a camera that moves
    blurs one more than the other. An edge of contrast c that is blurred by s
    has the slope c / (s sqrt(2 pi)).
    """
    starts, ends, along = _edges(detection, board)
    if not len(starts):
        return 0.0
    pose = detection.T_camera_board
    bright = image.astype(np.float32)
    blurs = np.array(
        [_blur_of(bright, lens, a @ pose[:3, :3].T + pose[:3, 3], b @ pose[:3, :3].T + pose[:3, 3])
         for a, b in zip(starts, ends, strict=True)]
    )  # fmt: skip
    worst = [np.median(blurs[along == k]) for k in (0, 1) if (along == k).any()]
    return float(max(worst))


def _edges(detection: Detection, board: BoardSpec) -> tuple[FloatArray, FloatArray, IntArray]:
    """Lines across the middles of edges between seen corners: starts and ends (E, 3), direction (E,)."""
    seen = set(detection.ids.tolist())
    per_row = board.columns - 1
    starts, ends, along = [], [], []
    for number in sorted(seen):
        corner = board.corners_m[number]
        for k, step in ((0, 1), (1, per_row)):
            is_last = (number + 1) % per_row == 0 if k == 0 else number + per_row >= board.n_corners
            if is_last or number + step not in seen:
                continue
            middle = (corner + board.corners_m[number + step]) / 2
            across = np.array([k == 1, k == 0, False], dtype=float) * _RIM_SHARE * board.square_m
            starts.append(middle - across)
            ends.append(middle + across)
            along.append(k)
    return np.array(starts), np.array(ends), np.array(along, dtype=np.int64)


def _blur_of(image: npt.NDArray[np.float32], lens: Lens, start_m: FloatArray, end_m: FloatArray) -> float:
    from scipy.ndimage import map_coordinates

    ends_px = lens.distorted(np.array([start_m, end_m]))
    # Beyond the rim, the line reaches to where black and white are pure; only its middle tells the slope.
    points = ends_px[0] + np.linspace(0, 1, _EDGE_SAMPLES)[:, None] * (ends_px[1] - ends_px[0])
    profile = map_coordinates(image, points.T[::-1], order=1, mode="nearest")
    step_px = np.linalg.norm(ends_px[1] - ends_px[0]) / (_EDGE_SAMPLES - 1)
    slope = np.abs(profile[2:] - profile[:-2]).max() / (2 * step_px)
    contrast = float(profile.max() - profile.min())
    return float(contrast / (max(slope, 1e-6) * np.sqrt(2 * np.pi)))
