"""A corner of the checked board, touched with the hand's tip: read, kept, and said with the check."""

import json

import numpy as np
import pytest

from app.operations.calibration.cell_file import new_cell
from app.operations.calibration.check import check_cell, simulated_place
from app.operations.calibration.hand_eye import calibrate_cell
from app.operations.calibration.provenance import RESULT, latest_result
from app.operations.calibration.steps import StepState, enter_board, steps
from app.operations.calibration.table import measure_table
from app.operations.calibration.touch import TOUCHES, read_touch, read_touches
from app.operations.calibration.undoing import undo
from core.calibration.board import BoardSpec
from core.calibration.touching import MOST_OFF_M
from core.errors import InputError, SessionError, StageError
from core.geometry import transform_points
from core.motion.kinematics import flange_pose
from core.progress import Reporter
from hardware.cell import read_cell
from hardware.cell.calibrating import simulated_set_up
from hardware.simulation.board_view import lying_board
from hardware.simulation.touching import joints_on_point
from tests.app.sessions import copied

TIP_M = np.array([0.01, 0.0, 0.21])


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory):
    """A calibrated cell, made once, and its camera's truth."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("POURSIGHT_CELLS", str(tmp_path_factory.mktemp("cells")))
        path = new_cell("bench", is_simulated=True, seed=2)
    enter_board(path, BoardSpec(), "a4", 0.030)
    calibrate_cell(path, Reporter(), None, n_views=10)
    return path


@pytest.fixture(scope="module")
def checked_once(calibrated, tmp_path_factory):
    """The calibrated cell with its check, which takes a while; every test has a copy."""
    path = copied(calibrated.parent, tmp_path_factory.mktemp("checked") / "cells") / calibrated.name
    check_cell(path, Reporter(), None, lambda: None)
    return path


@pytest.fixture
def checked(checked_once, tmp_path):
    path = copied(checked_once.parent, tmp_path / "cells") / checked_once.name
    return path, latest_result(path, "check")[0]


def check_step(path):
    return next(step for step in steps(path) if step.name == "check")


def test_a_touch_needs_a_check_of_the_present_calibration(calibrated):
    with pytest.raises(InputError, match="do the step 'check' first"):
        read_touch(calibrated)


def test_touches_are_kept_with_the_check_and_the_worst_one_is_said(checked):
    path, folder = checked
    before = path.read_bytes()
    found = [read_touch(path, TIP_M), *(read_touch(path) for _ in range(4))]
    assert path.read_bytes() == before
    assert len({one.touch.corner for one in found}) == 5
    assert all(0 < one.touch.distance_m < 0.0015 for one in found)
    kept = read_touches(folder)
    assert [touch["corner"] for touch in kept] == [one.touch.corner for one in found]
    assert all(np.allclose(touch["tip_m"], TIP_M) for touch in kept), "the last tip is the usual one"
    worst_mm = 1000 * max(one.touch.distance_m for one in found)
    assert check_step(path).figure.endswith(f"touch check: 5 corners within {worst_mm:.1f} mm")
    assert check_step(path).state is StepState.DONE


@pytest.mark.parametrize("off_m", [0.002, 0.005])
def test_a_camera_that_is_elsewhere_than_calibrated_is_found_by_a_touch_alone(checked, off_m):
    """The board is seen from all sides alike by a camera whose file is off with the arm's own base."""
    path, folder = checked
    table = json.loads((folder / RESULT).read_text())
    table["T_base_board"][2][3] += off_m
    (folder / RESULT).write_text(json.dumps(table))
    touch = read_touch(path, TIP_M).touch
    assert touch.off_m[2] == pytest.approx(-off_m, abs=0.0012)
    assert touch.is_good == (off_m < MOST_OFF_M)
    assert check_step(path).state is (StepState.DONE if touch.is_good else StepState.FAILED)


def test_a_tip_that_is_measured_wrong_is_refused_and_nothing_is_kept(checked, monkeypatch):
    path, folder = checked
    joints_rad = [0.3, -1.5, 1.5, -1.6, -1.6, 0.0]
    guided = "app.operations.calibration.touch.joints_on_point"
    monkeypatch.setattr(guided, lambda *_: np.array(joints_rad))
    with pytest.raises(StageError, match="from the nearest corner"):
        read_touch(path, TIP_M)
    assert read_touches(folder) == []


def test_a_board_that_was_laid_elsewhere_since_is_not_touched_any_more(checked):
    path, folder = checked
    measure_table(path, Reporter(), None, lambda: None)
    with pytest.raises(InputError, match="laid elsewhere for the step 'table'"):
        read_touch(path)
    assert read_touches(folder) == []
    undo(path, "table")
    assert read_touch(path).touch.is_good


@pytest.mark.parametrize("tip_m", [(0.0, 0.0, 0.6), (np.nan, 0.0, 0.2)])
def test_a_tip_that_is_nowhere_near_the_flange_is_refused(checked, tip_m):
    path, folder = checked
    with pytest.raises(InputError, match="at most 500 mm from the flange"):
        read_touch(path, np.array(tip_m))
    assert read_touches(folder) == []


@pytest.mark.parametrize("content", ["[1]", '{"touches": [{"corner": 1}]}', '{"touches": 3}', "{"])
def test_a_damaged_record_is_a_sentence(checked, content):
    path, folder = checked
    (folder / TOUCHES).write_text(content)
    for use in (check_step, read_touch):
        with pytest.raises(SessionError, match=TOUCHES):
            use(path)


def test_a_simulated_hand_has_its_tip_where_the_corner_really_is(calibrated):
    settings = read_cell(calibrated)
    set_up = simulated_set_up(settings).model_copy(update={"link_error_m": 0.001, "link_error_rad": 0.001})
    corners_m = transform_points(lying_board(BoardSpec(), *simulated_place(settings)), BoardSpec().corners_m)
    for corner, point_m in enumerate(corners_m):
        joints_rad = joints_on_point(
            settings.robot.arm, set_up, TIP_M, point_m, np.random.default_rng(corner)
        )
        own = set_up.own_arm(settings.robot.arm)
        flange = set_up.flexed(flange_pose(own, joints_rad), np.random.default_rng(corner))
        np.testing.assert_allclose(transform_points(flange, TIP_M), point_m, atol=1e-5)
