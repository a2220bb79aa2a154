"""Whether the camera still hangs where it was calibrated: one and the same look at a board that stays.

One image of a plane tells the camera's own place badly (it may go around the board and turn to it), so the
corners of several images are averaged on both occasions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.calibration.board import BoardSpec
from core.calibration.detection import FEWEST_CORNERS, Detection, pose_of_corners
from core.calibration.lens import Lens
from core.calibration.rig import log_pose
from core.errors import StageError
from core.geometry import FloatArray, IntArray, invert_pose

N_IMAGES = 16


@dataclass(frozen=True)
class StillLook:
    """What several images from one place have in common.

    Attributes:
        ids: (N,) corners that every image shows.
        corners_px: (N, 2) their mean, as a pinhole sees them.
    """

    ids: IntArray
    corners_px: FloatArray


@dataclass(frozen=True)
class Drift:
    """By how much the camera moved against the board.

    Attributes:
        shift_m: (3,) along its own x, y and z.
        turn_rad: (3,) rotation vector about them.
    """

    shift_m: FloatArray
    turn_rad: FloatArray

    @property
    def position_m(self) -> float:
        """Length of the shift."""
        return float(np.linalg.norm(self.shift_m))

    @property
    def angle_rad(self) -> float:
        """Angle of the turn."""
        return float(np.linalg.norm(self.turn_rad))

    @property
    def sentence(self) -> str:
        """For people."""
        x, y, z = 1000 * self.shift_m
        return (
            f"{1000 * self.position_m:.1f} mm ({x:+.1f}, {y:+.1f}, {z:+.1f} along the camera's x, y, z) and "
            f"{np.degrees(self.angle_rad):.2f} degrees"
        )


def still_look(detections: Sequence[Detection]) -> StillLook:
    """Average what images (at least one) from one place show.

    Raises:
        StageError: they have too few corners in common.
    """
    common = set(detections[0].ids.tolist()).intersection(*(one.ids.tolist() for one in detections))
    ids = np.array(sorted(common), dtype=np.int64)
    if len(ids) < FEWEST_CORNERS:
        raise StageError(
            "The images from one place do not show the same board; see that nothing moves there."
        )
    corners = [one.corners_px[np.searchsorted(one.ids, ids)] for one in detections]
    return StillLook(ids, np.mean(corners, axis=0))


def measure_drift(before: StillLook, now: StillLook, board: BoardSpec, lens: Lens) -> Drift:
    """Compare two looks that should be the same.

    Raises:
        StageError: they have too few corners in common.
    """
    ids = np.intersect1d(before.ids, now.ids)
    if len(ids) < FEWEST_CORNERS:
        raise StageError(
            "The board of the reference view is hardly in sight any more; see that nothing covers it."
        )
    pinhole = Lens(lens.intrinsics)
    poses = [
        pose_of_corners(board, pinhole, ids, look.corners_px[np.searchsorted(look.ids, ids)])[0]
        for look in (before, now)
    ]
    change = log_pose(poses[0] @ invert_pose(poses[1]))
    return Drift(change[3:], change[:3])
