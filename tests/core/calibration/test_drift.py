import numpy as np
import pytest

from core.calibration.board import BoardSpec
from core.calibration.detection import Detection
from core.calibration.drift import N_IMAGES, measure_drift, still_look
from core.calibration.lens import Lens, project
from core.calibration.rig import exp_pose
from core.errors import StageError
from core.geometry import invert_pose, make_pose, rotation_x, transform_points
from core.scan.model import Intrinsics

BOARD = BoardSpec()
LENS = Lens(Intrinsics(530.0, 530.0, 320.0, 240.0))
T_CAMERA_BOARD = make_pose(rotation_x(np.radians(40)), [-0.1, -0.05, 0.45])


def look(change=None, noise_px=0.0, ids=None, seed=0):
    """What a camera sees that moved by a change (6,) in its own frame."""
    random = np.random.default_rng(seed)
    pose = invert_pose(exp_pose(np.zeros(6) if change is None else np.array(change))) @ T_CAMERA_BOARD
    ids = np.arange(BOARD.n_corners) if ids is None else np.array(ids)
    exact = project(LENS.intrinsics, transform_points(pose, BOARD.corners_m[ids]))
    return still_look(
        [Detection(ids, exact + random.normal(0, noise_px, exact.shape), pose, 0.0) for _ in range(N_IMAGES)]
    )


@pytest.mark.parametrize(
    "change", [[0, 0, 0, 0.003, 0, 0], [0, 0, 0, 0, -0.002, 0.001], [0.009, 0, 0, 0, 0, 0]]
)
def test_without_noise_the_change_is_what_is_measured(change):
    drift = measure_drift(look(), look(change), BOARD, LENS)
    assert np.concatenate([drift.turn_rad, drift.shift_m]) == pytest.approx(change, abs=1e-6)
    assert drift.position_m == pytest.approx(np.linalg.norm(change[3:]), abs=1e-6)


def test_noise_alone_stays_below_what_is_warned_of():
    found = [
        measure_drift(look(None, 0.2, seed=k), look(None, 0.2, seed=99 + k), BOARD, LENS) for k in range(20)
    ]
    assert max(drift.position_m for drift in found) < 0.002
    assert max(drift.angle_rad for drift in found) < np.radians(0.3)


def test_corners_that_both_looks_have_are_enough():
    few = look([0, 0, 0, 0.004, 0, 0], ids=range(5, 20))
    assert measure_drift(look(), few, BOARD, LENS).shift_m == pytest.approx([0.004, 0, 0], abs=1e-6)
    with pytest.raises(StageError, match="hardly in sight"):
        measure_drift(look(ids=range(12)), look(ids=range(10, 28)), BOARD, LENS)


def test_the_sentence_has_figure_and_direction():
    said = measure_drift(look(), look([0, 0, 0, 0.003, -0.001, 0.002]), BOARD, LENS).sentence
    assert said == "3.7 mm (+3.0, -1.0, +2.0 along the camera's x, y, z) and 0.00 degrees"
