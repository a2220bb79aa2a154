"""Poses from which views of the board tell most about where the camera hangs.

The arm's kinematics and clearances say which views can be reached (`core.motion.views`). Of those, each next
one is that which most reduces the error that is to be expected at the distance of pouring (A-optimal design,
greedily; Pukelsheim, "Optimal Design of Experiments", 1993). That asks for large rotations about different
axes by itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.calibration.board import BoardSpec
from core.calibration.noise import EXPECTED
from core.calibration.rig import HAND_EYE, N_POSES, Rig, cross_matrices, image_derivatives
from core.calibration.views import LEAST_TILT_RAD, BoardView
from core.geometry import BoolArray, FloatArray, transform_points
from core.motion.clearance import MotionScene
from core.motion.joint_path import MIN_CLEARANCE_M, check_path
from core.motion.kinematics import branch_of, flange_pose
from core.motion.views import Dome, ViewTask, reachable_views
from core.scan.model import Intrinsics

USUAL_VIEWS = 20
_GUESS_SD = np.array([0.2] * 3 + [0.02] * 3 + [0.5] * 3 + [0.1] * 3)
"""What is known without any view: the camera's place to 10 degrees and 20 mm, the board's hardly."""
_POURING_M = 0.55
"""Distance along the camera's z at which its error counts."""
_DOME = Dome(
    elevations_deg=(42, 50, 58, 66, 74, 79),
    azimuths_deg=tuple(range(-180, 180, 20)),
    distances_m=(0.40, 0.48, 0.58),
    rolls_deg=tuple(range(-180, 180, 30)),
)
_FRONTAL_MARGIN_RAD = np.radians(3.0)
_HALF_HEIGHT_M = 0.004
"""Half the height of the box around the flat board that is to be in the image."""


@dataclass(frozen=True)
class Proposal:
    """A configuration of the arm from which to look at the board.

    Attributes:
        joints_rad: (6,).
        T_base_flange: (4, 4) there, by the nominal kinematics.
        clearance_m: of arm and tools there.
    """

    joints_rad: FloatArray
    T_base_flange: FloatArray
    clearance_m: float


@dataclass(frozen=True)
class ProposalTask:
    """What is known when poses are proposed.

    Attributes:
        rig: guessed, or fitted to the views that there are.
        board: as printed.
        image_size_px: width and height.
        home_rad: (6,) poses are taken on its branch of the kinematics, so that no way leads through a
            singularity, with joints within half a turn of it, where possible.
        aim_error_px: how far from where it is expected the board may show up.
        min_range_m: the camera sees nothing sharp closer than this.
        min_clearance_m: around arm and tools.
    """

    rig: Rig
    board: BoardSpec
    image_size_px: tuple[int, int]
    home_rad: FloatArray
    aim_error_px: float = 60.0
    min_range_m: float = 0.35
    min_clearance_m: float = MIN_CLEARANCE_M


def propose_poses(
    scene: MotionScene,
    task: ProposalTask,
    n_poses: int = USUAL_VIEWS,
    taken: Sequence[BoardView] = (),
    refused_rad: Sequence[FloatArray] = (),
) -> tuple[Proposal, ...]:
    """Choose poses, the most telling first; fewer than wanted if the arm cannot reach as many.

    Args:
        scene: the arm and what it must not touch.
        task: what is known.
        n_poses: how many.
        taken: views that there are already.
        refused_rad: configurations (6,) that were tried in vain: they and their neighbours are left out.
    """
    candidates = _candidates(scene, task)
    if not candidates:
        return ()
    flange = np.array([candidate.T_base_flange for candidate in candidates])
    each = _information(task, flange)
    total = np.diag(1 / _GUESS_SD**2)
    for view in taken:
        total = total + _information(task, view.T_base_flange[None])[0]
    allowed = _allowed(candidates, refused_rad)
    chosen: list[Proposal] = []
    errors = _expected_errors(total + each)
    while len(chosen) < n_poses and allowed.any():
        best = int(np.where(allowed, errors, np.inf).argmin())
        joints = candidates[best].joints_rad
        allowed &= ~_is_near(candidates, joints)
        # Straight from home: then there is a way from anywhere to anywhere, at worst by home.
        if check_path(scene, np.array([task.home_rad, joints]), task.min_clearance_m).is_clear:
            chosen.append(candidates[best])
            total = total + each[best]
            errors = _expected_errors(total + each)
    return tuple(chosen)


def in_short_order(poses: Sequence[Proposal], start_rad: FloatArray) -> tuple[Proposal, ...]:
    """Return poses in an order without long ways: from each to the nearest that is left."""
    left, here, ordered = list(poses), start_rad, []
    while left:
        ways = [float(np.abs(pose.joints_rad - here).max()) for pose in left]
        ordered.append(left.pop(int(np.argmin(ways))))
        here = ordered[-1].joints_rad
    return tuple(ordered)


def _candidates(scene: MotionScene, task: ProposalTask) -> list[Proposal]:
    middle = transform_points(task.rig.T_base_board, task.board.center_m)
    outline = transform_points(task.rig.T_base_board, task.board.outline_m)
    height = np.array([0, 0, _HALF_HEIGHT_M])
    views = ViewTask(
        T_flange_camera=task.rig.T_flange_camera,
        target_m=middle,
        box_min_m=outline.min(axis=0) - height,
        box_max_m=outline.max(axis=0) + height,
        home_rad=task.home_rad,
        field_of_view_deg=_field_of_view_deg(task),
        min_range_m=task.min_range_m,
        min_clearance_m=task.min_clearance_m,
    )
    found = [
        Proposal(view.joints_rad, flange_pose(scene.arm, view.joints_rad), view.clearance_m)
        for view in reachable_views(scene, views, _DOME)
    ]
    if not found:
        return []
    branches = branch_of(scene.arm, np.array([proposal.joints_rad for proposal in found]))
    same = branches == branch_of(scene.arm, task.home_rad)
    return [p for p, is_same in zip(found, same, strict=True) if is_same and _is_seen(task, outline, p)]


def _field_of_view_deg(task: ProposalTask) -> tuple[float, float]:
    intrinsics: Intrinsics = task.rig.intrinsics
    width, height = task.image_size_px
    margin = 2 * task.aim_error_px
    return intrinsics.field_of_view_deg((width - margin, height - margin))


def _is_seen(task: ProposalTask, outline_m: FloatArray, proposal: Proposal) -> bool:
    """Whether the whole board is in the image, even if it shows up a little elsewhere, and not frontal."""
    T_base_camera = proposal.T_base_flange @ task.rig.T_flange_camera
    points = (outline_m - T_base_camera[:3, 3]) @ T_base_camera[:3, :3]
    half = np.tan(np.radians(_field_of_view_deg(task)) / 2)
    inside = (points[:, 2] > 0).all() and bool((np.abs(points[:, :2] / points[:, 2:]) <= half).all())
    sight = outline_m.mean(axis=0) - T_base_camera[:3, 3]
    cosine = abs(task.rig.T_base_board[:3, 2] @ sight) / np.linalg.norm(sight)
    return bool(inside and np.arccos(np.clip(cosine, 0, 1)) > LEAST_TILT_RAD + _FRONTAL_MARGIN_RAD)


def _information(task: ProposalTask, T_base_flange: FloatArray) -> FloatArray:
    """What views from poses (N, 4, 4) would tell of the rig: (N, 12, 12)."""
    image, _ = image_derivatives(task.rig, T_base_flange, task.board.corners_m)
    n = len(T_base_flange)
    by_flange = image.by_flange.reshape(n, -1, 6)
    by_unknowns = np.concatenate([image.by_hand_eye, image.by_board], axis=-1).reshape(n, -1, N_POSES)
    shape = np.linalg.inv(np.swapaxes(by_flange, -1, -2) @ by_flange)
    to_pose = shape @ np.swapaxes(by_flange, -1, -2) @ by_unknowns
    covariances = EXPECTED.corner_px**2 * shape + EXPECTED.arm_covariance
    return np.asarray(np.swapaxes(to_pose, -1, -2) @ np.linalg.solve(covariances, to_pose))


def _expected_errors(information: FloatArray) -> FloatArray:
    """Expected squared error (N,) at the distance of pouring, for information (N, 12, 12)."""
    ahead = np.array([0.0, 0.0, _POURING_M])
    by_change = np.hstack([-cross_matrices(ahead), np.eye(3)])
    covariances = np.linalg.inv(information)[:, HAND_EYE, HAND_EYE]
    return np.asarray(np.einsum("ij,njk,ik->n", by_change, covariances, by_change))


_NEIGHBOUR_RAD = np.radians(6.0)


def _is_near(candidates: Sequence[Proposal], joints_rad: FloatArray) -> BoolArray:
    all_rad = np.array([candidate.joints_rad for candidate in candidates])
    return np.asarray(np.abs(all_rad - joints_rad).max(axis=1) < _NEIGHBOUR_RAD)


def _allowed(candidates: Sequence[Proposal], refused_rad: Sequence[FloatArray]) -> BoolArray:
    allowed = np.ones(len(candidates), dtype=bool)
    for joints in refused_rad:
        allowed &= ~_is_near(candidates, joints)
    return allowed
