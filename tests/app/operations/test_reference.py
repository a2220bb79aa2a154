"""The reference view: what a scan does when the camera did not move, moved a little, or moved far."""

import json
import shutil

import numpy as np
import pytest

from app.operations.calibration import reference, step_names
from app.operations.calibration.cell_file import new_cell
from app.operations.calibration.hand_eye import calibrate_cell
from app.operations.calibration.provenance import RESULT, runs
from app.operations.calibration.reference import read_reference, store_reference
from app.operations.calibration.steps import StepState, enter_board, steps
from app.operations.calibration.undoing import undo
from core.calibration.board import BoardSpec
from core.calibration.rig import exp_pose
from core.errors import InputError, MotionError, SessionError, StageError
from core.motion.joint_path import check_path
from core.progress import Reporter
from hardware.cameras.simulated_board import SimulatedBoardCamera
from hardware.cell import read_cell
from hardware.cell.calibrating import open_calibration_cell
from hardware.cell.scene import motion_scene, object_space

pytestmark = pytest.mark.system
N_VIEWS = 8


def check_drift(path, reporter, operator):
    """As a scan does, in its own cell."""
    with open_calibration_cell(read_cell(path), BoardSpec()) as cell:
        return reference.check_drift(cell, path, reporter, operator)


class Listening(Reporter):
    """Keeps warnings."""

    def __init__(self):
        super().__init__()
        self.said = []

    def warn(self, sentence):
        self.said.append(sentence)


@pytest.fixture(scope="module")
def referred_once(tmp_path_factory):
    """A calibrated cell with a reference view, made once."""
    folder = tmp_path_factory.mktemp("referred")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("POURSIGHT_CELLS", str(folder))
        path = new_cell("bench", is_simulated=True, seed=6)
    assert check_drift(path, Reporter(), None) is None
    enter_board(path, BoardSpec(), "a4", 0.030)
    with pytest.raises(InputError, match="calibrate first"):
        store_reference(path, Reporter(), None, lambda: None)
    calibrate_cell(path, Reporter(), None, n_views=N_VIEWS)
    store_reference(path, Reporter(), None, lambda: None)
    return folder


@pytest.fixture
def referred(referred_once, tmp_path):
    shutil.copytree(referred_once, tmp_path / "cells")
    return tmp_path / "cells" / "bench.toml"


@pytest.fixture
def bump(monkeypatch):
    """Let the camera hang elsewhere from now on, by a change (6,)."""
    plain = SimulatedBoardCamera.__init__

    def move(change):
        def init(camera, world, robot, arm, truth, board, noise):
            rows = tuple(tuple(row) for row in (truth.camera_pose @ exp_pose(np.array(change))).tolist())
            plain(camera, world, robot, arm, truth.model_copy(update={"T_flange_camera": rows}), board, noise)

        monkeypatch.setattr(SimulatedBoardCamera, "__init__", init)

    return move


def step(path):
    return next(step for step in steps(path) if step.name == step_names.REFERENCE)


def test_a_camera_that_did_not_move_is_said_nothing_of(referred):
    reporter = Listening()
    drift = check_drift(referred, reporter, None)
    assert drift.position_m < 0.001
    assert reporter.said == []
    assert step(referred).state is StepState.DONE and "last time" in step(referred).figure
    assert len(runs(referred, step_names.DRIFT)) == 1


def test_one_that_moved_a_little_is_warned_of_with_figure_and_place(referred, bump):
    bump([0, 0, 0, 0.004, 0, 0])
    reporter = Listening()
    drift = check_drift(referred, reporter, None)
    assert drift.shift_m == pytest.approx([0.004, 0, 0], abs=0.0015)
    [sentence] = reporter.said
    assert "mm" in sentence and "camera's x, y, z" in sentence


def test_with_one_that_moved_far_nothing_is_scanned(referred, bump):
    bump([0, 0.04, 0, 0, 0, 0])
    with pytest.raises(StageError, match=r"moved against its board by .* fix it, calibrate anew"):
        check_drift(referred, Reporter(), None)


def test_limits_are_the_cell_file_s(referred, bump):
    bump([0, 0, 0, 0.004, 0, 0])
    text = referred.read_text()
    referred.write_text(text.replace("settle_s = 0.3", "settle_s = 0.3\ndrift_m = 0.009"))
    reporter = Listening()
    check_drift(referred, reporter, None)
    assert reporter.said == []
    referred.write_text(text.replace("settle_s = 0.3", "settle_s = 0.3\nmost_drift_m = 0.003"))
    with pytest.raises(StageError, match="worth nothing"):
        check_drift(referred, reporter, None)


def test_another_calibration_makes_it_stale_and_undo_takes_it_back(referred):
    undo(referred, "hand-eye")
    assert step(referred).state is StepState.STALE
    undo(referred, step_names.REFERENCE)
    assert step(referred).state is StepState.OPEN
    assert check_drift(referred, Reporter(), None) is None


def test_a_damaged_look_is_named(referred):
    [folder] = runs(referred, step_names.REFERENCE)
    (folder / RESULT).write_text((folder / RESULT).read_text().replace('"ids"', '"idz"'))
    with pytest.raises(SessionError, match=r"result\.json is damaged"):
        read_reference(referred)


def test_a_look_is_never_taken_from_where_an_object_may_stand(referred):
    [folder] = runs(referred, step_names.REFERENCE)
    record = json.loads((folder / RESULT).read_text())
    clear = check_path(object_scene(referred), np.array(record["joints_rad"]), 0.02)
    assert clear.problem is None, "a reference view keeps clear of all that may stand on the platform"
    low = read_cell(referred).scan.views_rad[0]
    assert check_path(object_scene(referred), np.array(low), 0.02).problem is not None
    (folder / RESULT).write_text(json.dumps(record | {"joints_rad": low}))
    with pytest.raises(MotionError, match=r"from where an object may stand .* store another one"):
        check_drift(referred, Reporter(), None)
    assert runs(referred, step_names.DRIFT)[-1].is_dir()


def object_scene(path):
    settings = read_cell(path)
    return motion_scene(settings, object_space(settings))
