"""The model that is fitted: a camera at the flange, a board that does not move, and their small changes.

A change of a pose T is six numbers, rotation before translation, in the frame on its right:
`T Exp(w, p) = T [R(w) p; 0 1]`. The fit's unknowns are the change of the hand-eye pose (0 to 5, in the camera
frame), that of the board (6 to 11, in the board frame), and, if they are free, those of the intrinsics (12 to
15: fx and fy as shares of themselves, cx and cy in pixels).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from core.calibration.board import BoardSpec
from core.calibration.lens import project
from core.calibration.views import BoardView
from core.geometry import FloatArray, invert_pose, make_pose
from core.scan.model import Intrinsics

N_POSES = 12
N_WITH_INTRINSICS = 16
HAND_EYE, BOARD, INTRINSICS = slice(0, 6), slice(6, 12), slice(12, 16)


@dataclass(frozen=True)
class Rig:
    """What the fit is about.

    Attributes:
        T_flange_camera: (4, 4) the hand-eye pose.
        T_base_board: (4, 4) where the board lies.
        intrinsics: of the camera.
    """

    T_flange_camera: FloatArray
    T_base_board: FloatArray
    intrinsics: Intrinsics

    def changed(self, change: FloatArray) -> Rig:
        """Return the rig after a change (12,) or (16,) of its unknowns."""
        rig = replace(
            self,
            T_flange_camera=self.T_flange_camera @ exp_pose(change[HAND_EYE]),
            T_base_board=self.T_base_board @ exp_pose(change[BOARD]),
        )
        if len(change) == N_POSES:
            return rig
        i, (a, b, du, dv) = self.intrinsics, change[INTRINSICS]
        return replace(rig, intrinsics=Intrinsics(i.fx * (1 + a), i.fy * (1 + b), i.cx + du, i.cy + dv))


@dataclass(frozen=True)
class Derivatives:
    """How the image of one view changes; corners' coordinates are in the order u1, v1, u2, v2, ...

    Attributes:
        residuals_px: (2n,) predicted less seen.
        by_unknowns: (2n, 12) or (2n, 16) by a change of the rig.
        by_flange: (2n, 6) by a change of the arm's pose in this view.
        by_scale: (2n,) by the size of the board's squares, as a share.
    """

    residuals_px: FloatArray
    by_unknowns: FloatArray
    by_flange: FloatArray
    by_scale: FloatArray


def exp_pose(change: FloatArray) -> FloatArray:
    """Return the pose (4, 4) of a change (6,): rotation vector, then translation."""
    from scipy.spatial.transform import Rotation

    return make_pose(Rotation.from_rotvec(change[:3]).as_matrix(), change[3:])


def log_pose(T: FloatArray) -> FloatArray:
    """Return the change (6,) of a pose (4, 4)."""
    from scipy.spatial.transform import Rotation

    return np.concatenate([Rotation.from_matrix(T[:3, :3]).as_rotvec(), T[:3, 3]])


def cross_matrices(vectors: FloatArray) -> FloatArray:
    """Matrices (..., 3, 3) that multiply as the cross product with vectors (..., 3) does."""
    matrices = np.zeros((*vectors.shape, 3))
    x, y, z = np.moveaxis(vectors, -1, 0)
    matrices[..., 0, 1], matrices[..., 0, 2] = -z, y
    matrices[..., 1, 0], matrices[..., 1, 2] = z, -x
    matrices[..., 2, 0], matrices[..., 2, 1] = -y, x
    return matrices


def residuals_px(rig: Rig, board: BoardSpec, view: BoardView) -> FloatArray:
    """Residuals (2n,) of a view: where the rig has the corners, less where they were seen."""
    points = _in_camera(rig, view.T_base_flange, board.corners_m[view.ids])
    return np.asarray((project(rig.intrinsics, points) - view.corners_px).ravel())


def derivatives(rig: Rig, board: BoardSpec, view: BoardView, n_unknowns: int = N_POSES) -> Derivatives:
    """Residuals of a view and their derivatives at no change."""
    corners = board.corners_m[view.ids]
    image, points = image_derivatives(rig, view.T_base_flange[None], corners)
    residuals = project(rig.intrinsics, points[0]) - view.corners_px
    n = len(corners)
    by_points = image.by_points[0]
    by_unknowns = np.concatenate([image.by_hand_eye[0], image.by_board[0]], axis=-1).reshape(2 * n, N_POSES)
    if n_unknowns == N_WITH_INTRINSICS:
        by_unknowns = np.hstack([by_unknowns, _by_intrinsics(rig.intrinsics, points[0])])
    T_camera_board = invert_pose(view.T_base_flange @ rig.T_flange_camera) @ rig.T_base_board
    by_scale = np.einsum("nij,nj->ni", by_points, corners @ T_camera_board[:3, :3].T)
    return Derivatives(residuals.ravel(), by_unknowns, image.by_flange[0].reshape(2 * n, 6), by_scale.ravel())


@dataclass(frozen=True)
class ImageDerivatives:
    """Derivatives of the images (V, n, 2) of n corners from V poses of the arm.

    Attributes:
        by_points: (V, n, 2, 3) by the corners in the camera frame.
        by_hand_eye: (V, n, 2, 6).
        by_board: (V, n, 2, 6).
        by_flange: (V, n, 2, 6) by the arm's pose.
    """

    by_points: FloatArray
    by_hand_eye: FloatArray
    by_board: FloatArray
    by_flange: FloatArray


def image_derivatives(
    rig: Rig, T_base_flange: FloatArray, corners_m: FloatArray
) -> tuple[ImageDerivatives, FloatArray]:
    """Derivatives of corners (n, 3) of the board from poses (V, 4, 4), and the corners in the camera frames.

    Returns:
        the derivatives, and (V, n, 3) points in metres.
    """
    in_base = corners_m @ rig.T_base_board[:3, :3].T + rig.T_base_board[:3, 3]
    in_flange = (in_base - T_base_flange[:, None, :3, 3]) @ T_base_flange[:, :3, :3]
    R_flange_camera = rig.T_flange_camera[:3, :3]
    points = (in_flange - rig.T_flange_camera[:3, 3]) @ R_flange_camera
    by_points = _by_points(rig.intrinsics, points)
    R_camera_board = (
        R_flange_camera.T @ np.swapaxes(T_base_flange[:, :3, :3], -1, -2) @ rig.T_base_board[:3, :3]
    )
    corner_turns = R_camera_board[:, None] @ -cross_matrices(corners_m)
    flange_turns = R_flange_camera.T @ cross_matrices(in_flange)
    same = np.broadcast_to(np.eye(3), (*points.shape, 3))
    return ImageDerivatives(
        by_points=by_points,
        by_hand_eye=np.concatenate([by_points @ cross_matrices(points), -by_points @ same], axis=-1),
        by_board=np.concatenate([by_points @ corner_turns, by_points @ R_camera_board[:, None]], axis=-1),
        by_flange=np.concatenate([by_points @ flange_turns, -by_points @ R_flange_camera.T], axis=-1),
    ), points


def _in_camera(rig: Rig, T_base_flange: FloatArray, corners_m: FloatArray) -> FloatArray:
    T_camera_board = invert_pose(T_base_flange @ rig.T_flange_camera) @ rig.T_base_board
    return np.asarray(corners_m @ T_camera_board[:3, :3].T + T_camera_board[:3, 3])


def _by_points(intrinsics: Intrinsics, points: FloatArray) -> FloatArray:
    x, y, z = np.moveaxis(points, -1, 0)
    by_points = np.zeros((*points.shape[:-1], 2, 3))
    by_points[..., 0, 0], by_points[..., 0, 2] = intrinsics.fx / z, -intrinsics.fx * x / z**2
    by_points[..., 1, 1], by_points[..., 1, 2] = intrinsics.fy / z, -intrinsics.fy * y / z**2
    return by_points


def _by_intrinsics(intrinsics: Intrinsics, points: FloatArray) -> FloatArray:
    by = np.zeros((len(points), 2, 4))
    by[:, 0, 0] = intrinsics.fx * points[:, 0] / points[:, 2]
    by[:, 1, 1] = intrinsics.fy * points[:, 1] / points[:, 2]
    by[:, 0, 2] = by[:, 1, 3] = 1.0
    return by.reshape(-1, 4)


def right_jacobian(change: FloatArray) -> FloatArray:
    """How a further change (6,) in the right-hand frame follows from one of `change` itself: (6, 6).

    For the rotation it is the right Jacobian of SO(3): Chirikjian, "Stochastic Models, Information Theory,
    and Lie Groups", vol. 2, 2012, sec. 10.6.
    """
    rotation, angle = change[:3], float(np.linalg.norm(change[:3]))
    cross = cross_matrices(rotation)
    if angle < 1e-6:
        turn = np.eye(3) - cross / 2
    else:
        turn = (
            np.eye(3)
            - (1 - np.cos(angle)) / angle**2 * cross
            + (angle - np.sin(angle)) / angle**3 * cross @ cross
        )
    jacobian = np.zeros((6, 6))
    jacobian[:3, :3] = turn
    jacobian[3:, 3:] = exp_pose(change)[:3, :3].T
    return jacobian


def all_derivatives(
    rig: Rig, board: BoardSpec, views: Sequence[BoardView], n_unknowns: int = N_POSES
) -> list[Derivatives]:
    """`derivatives` of each view."""
    return [derivatives(rig, board, view, n_unknowns) for view in views]
