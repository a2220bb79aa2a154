"""Finding the board in an image, and saying why it is not found."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from core.calibration.board import DICTIONARIES, BoardSpec
from core.calibration.lens import Lens, project
from core.errors import StageError
from core.geometry import FloatArray, IntArray, make_pose
from core.scan.model import ColorImage

GrayImage = npt.NDArray[np.uint8]
FEWEST_CORNERS = 8
_OUTLIER_PX = 1.5
"""A corner this far from where the flat board puts it was not the corner."""
_MOST_OUTLIERS = 0.2


@dataclass(frozen=True)
class Detection:
    """The board in one image.

    Attributes:
        ids: (N,) which of the board's corners, ascending.
        corners_px: (N, 2) where a pinhole would see them: the lens's distortion is removed.
        T_camera_board: (4, 4) the board's pose by this image alone.
        rms_px: root mean square of what is left between corners and that pose, per coordinate.
    """

    ids: IntArray
    corners_px: FloatArray
    T_camera_board: FloatArray
    rms_px: float


def gray(color: ColorImage) -> GrayImage:
    """Return the brightness (H, W) of an RGB image (H, W, 3)."""
    import cv2

    return np.asarray(cv2.cvtColor(color, cv2.COLOR_RGB2GRAY), dtype=np.uint8)


def detect_board(image: GrayImage, board: BoardSpec, lens: Lens) -> Detection:
    """Find the board.

    Args:
        image: (H, W).
        board: as printed.
        lens: of the camera.

    Raises:
        StageError: it is not found, only in part, mirrored, of other markers, or bent; the sentence says so.
    """
    ids, corners_px = _corners(image, board)
    if len(ids) < FEWEST_CORNERS:
        raise StageError(_why_not(image, board, len(ids)))
    pinhole_px = lens.undistorted(corners_px)
    pose, residual_px = pose_of_corners(board, lens, ids, pinhole_px)
    fits = np.linalg.norm(residual_px, axis=1) <= _OUTLIER_PX
    if (~fits).sum() > _MOST_OUTLIERS * len(fits) or fits.sum() < FEWEST_CORNERS:
        rms = float(np.sqrt((residual_px**2).mean()))
        raise StageError(
            f"The corners that were found do not lie on a flat board of {board.columns} x {board.rows} "
            "squares "
            ""
            f"({rms:.1f} px); glue the sheet flat onto something stiff, and see that no other board is "
            "in sight."
        )
    if not fits.all():
        ids, pinhole_px = ids[fits], pinhole_px[fits]
        pose, residual_px = pose_of_corners(board, lens, ids, pinhole_px)
    return Detection(ids, pinhole_px, pose, float(np.sqrt((residual_px**2).mean())))


def _corners(image: GrayImage, board: BoardSpec) -> tuple[IntArray, FloatArray]:
    from cv2 import aruco

    corners, ids, _, _ = aruco.CharucoDetector(board.cv_board()).detectBoard(image)
    if ids is None or corners is None or len(ids) == 0:
        return np.zeros(0, dtype=np.int64), np.zeros((0, 2))
    order = np.argsort(ids.ravel())
    return ids.ravel()[order].astype(np.int64), corners.reshape(-1, 2)[order].astype(float)


def pose_of_corners(
    board: BoardSpec, lens: Lens, ids: IntArray, pinhole_px: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return `T_camera_board` (4, 4) and the residuals (N, 2) of seen corners.

    Of the two poses that an image of a plane allows, it is the better one.

    Args:
        board: as printed.
        lens: of the camera.
        ids: (N,) which corners were seen.
        pinhole_px: (N, 2) where a pinhole sees them.

    Raises:
        StageError: they determine no pose.
    """
    import cv2

    points = board.corners_m[ids]
    n, turns, shifts, _ = cv2.solvePnPGeneric(
        points, pinhole_px, lens.intrinsics.matrix, None, flags=cv2.SOLVEPNP_IPPE
    )
    best: tuple[FloatArray, FloatArray] | None = None
    for k in range(n):
        turn, shift = cv2.solvePnPRefineLM(
            points, pinhole_px, lens.intrinsics.matrix, None, turns[k].copy(), shifts[k].copy()
        )
        pose = make_pose(cv2.Rodrigues(turn)[0], shift.ravel())
        seen = project(lens.intrinsics, points @ pose[:3, :3].T + pose[:3, 3])
        if best is None or ((seen - pinhole_px) ** 2).sum() < (best[1] ** 2).sum():
            best = pose, seen - pinhole_px
    if best is None:
        raise StageError("The corners of the board lie on one line; show more of it to the camera.")
    return best


def _why_not(image: GrayImage, board: BoardSpec, n_found: int) -> str:
    """One sentence; each suspicion is tried."""
    mirrored = len(_corners(np.ascontiguousarray(image[:, ::-1]), board)[0])
    if mirrored >= max(FEWEST_CORNERS, 2 * n_found):
        return (
            "The board is mirrored; print it without mirroring, and not on the back of a transparent sheet."
        )
    others = {
        name: _n_markers(image, name) for name in DICTIONARIES if _family(name) != _family(board.dictionary)
    }
    best = max(others, key=lambda name: others[name])
    if others[best] >= max(FEWEST_CORNERS // 2, 2 * _n_markers(image, board.dictionary)):
        return (
            f"The markers in the image are of dictionary {best}, and the board of this cell of "
            f"{board.dictionary}; enter the board that was printed, or print the one that was entered."
        )
    n_markers = _n_markers(image, board.dictionary)
    if n_markers >= FEWEST_CORNERS // 2:
        return (
            f"{n_markers} markers were found, but only {n_found} of the board's {board.n_corners} corners; "
            f"show the whole board, sharp, and check that it has {board.columns} x {board.rows} squares."
        )
    return (
        "No board was found in the image; see that it is in sight, sharp, and neither too dark nor glaring."
    )


def _family(dictionary: str) -> str:
    return dictionary.split("_")[0]


def _n_markers(image: GrayImage, dictionary: str) -> int:
    from cv2 import aruco

    known = aruco.getPredefinedDictionary(getattr(aruco, f"DICT_{dictionary}"))
    _, ids, _ = aruco.ArucoDetector(known).detectMarkers(image)
    return 0 if ids is None else len(ids)


def measured_square_m(
    detection: Detection, board: BoardSpec, lens: Lens, depth_m: npt.NDArray[np.float32]
) -> float | None:
    """Return the side of a square as the depth image (H, W) has it; none where it shows too little.

    The image alone cannot tell a small board nearby from a large one far away; the depth of its corners can.
    """
    pose = detection.T_camera_board
    points = board.corners_m[detection.ids] @ pose[:3, :3].T + pose[:3, 3]
    columns, rows = np.round(lens.distorted(points)).astype(int).T
    inside = (columns >= 0) & (rows >= 0) & (columns < depth_m.shape[1]) & (rows < depth_m.shape[0])
    depth = depth_m[rows[inside], columns[inside]]
    known = depth > 0
    if known.sum() < FEWEST_CORNERS:
        return None
    return board.square_m * float(np.median(depth[known] / points[inside, 2][known]))


def with_square(board: BoardSpec, square_m: float) -> BoardSpec:
    """Return the same board with squares as they were measured."""
    return replace(board, square_m=square_m)
