"""Views of a board that are computed, not rendered, with the noise that is asked for."""

import numpy as np

from core.calibration.board import BoardSpec
from core.calibration.detection import pose_of_corners
from core.calibration.lens import Lens, project
from core.calibration.rig import exp_pose
from core.calibration.views import BoardView
from core.geometry import invert_pose, look_at, make_pose, rotation_x, rotation_z, transform_points
from core.scan.model import Intrinsics

INTRINSICS = Intrinsics(532.58, 532.21, 316.04, 236.03)
BOARD = BoardSpec()
T_FLANGE_CAMERA = make_pose(rotation_x(-0.5), (0.01, -0.09, 0.08))
T_BASE_BOARD = make_pose(rotation_x(np.pi) @ rotation_z(0.3), (-0.06, -0.35, 0.1))
MIDDLE = transform_points(T_BASE_BOARD, BOARD.center_m)


def view_from(T_base_camera, random, name="view", T_base_board=T_BASE_BOARD, arm=(5e-4, 3e-4), corner_px=0.2):
    """See the board from a pose, the arm being wrong by some rad and m per axis."""
    flange = T_base_camera @ invert_pose(T_FLANGE_CAMERA)
    noise = random.normal(size=6) * ([arm[0]] * 3 + [arm[1]] * 3)
    T_camera_board = invert_pose(flange @ exp_pose(noise) @ T_FLANGE_CAMERA) @ T_base_board
    seen = project(INTRINSICS, transform_points(T_camera_board, BOARD.corners_m))
    seen = seen + random.normal(0, corner_px, seen.shape)
    ids = np.arange(BOARD.n_corners)
    pose, _ = pose_of_corners(BOARD, Lens(INTRINSICS), ids, seen)
    return BoardView(name, flange, ids, seen, pose)


def diverse_views(n, seed=0, **options):
    """Views from all around, rolled at will."""
    random = np.random.default_rng(seed)
    views = []
    for k in range(n):
        tilt, around = random.uniform(0.25, 0.7), random.uniform(0, 2 * np.pi)
        direction = [np.sin(tilt) * np.cos(around), np.sin(tilt) * np.sin(around), np.cos(tilt)]
        camera = look_at(MIDDLE + random.uniform(0.4, 0.6) * np.array(direction), MIDDLE)
        camera = camera @ make_pose(rotation_z(random.uniform(-np.pi, np.pi)), (0, 0, 0))
        views.append(view_from(camera, random, f"view {k}", **options))
    return views


def similar_views(n, seed=0, largest_rad=0.1745, axes=(1, 1, 1)):
    """Views that are turned by little about the axes that are 1."""
    random = np.random.default_rng(seed)
    first = look_at(MIDDLE + np.array([0.15, 0.1, 0.45]), MIDDLE)
    views = []
    for k in range(n):
        turn = exp_pose(np.array([*(random.uniform(-largest_rad, largest_rad, 3) * axes), 0, 0, 0]))
        camera = first @ turn
        views.append(view_from(camera, random, f"view {k}"))
    return views
