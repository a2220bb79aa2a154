"""The steps of a cell besides its calibration: devices, platform and table, views."""

import json
import shutil

import numpy as np
import pytest

from app.operations.calibration.cell_file import known_cells, new_cell, write_place
from app.operations.calibration.crop import enter_crop_box
from app.operations.calibration.devices import examine_device
from app.operations.calibration.hand_eye import calibrate_cell
from app.operations.calibration.provenance import RESULT, calibration_folder, runs
from app.operations.calibration.steps import StepState, enter_board, steps
from app.operations.calibration.table import is_in_file, measure_table, write_former_place
from app.operations.calibration.undoing import undo
from app.operations.calibration.views import choose_views
from core.calibration.board import BoardSpec
from core.errors import InputError, StageError
from core.motion.kinematics import flange_pose
from core.progress import Reporter
from hardware.cell import read_cell
from hardware.cell.scene import motion_scene
from hardware.cell.settings import ARMS

N_VIEWS = 8


@pytest.fixture(autouse=True)
def cells(tmp_path, monkeypatch):
    monkeypatch.setenv("POURSIGHT_CELLS", str(tmp_path / "cells"))
    return tmp_path / "cells"


@pytest.fixture(scope="module")
def calibrated_once(tmp_path_factory):
    """A calibrated cell, made once."""
    folder = tmp_path_factory.mktemp("calibrated")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("POURSIGHT_CELLS", str(folder))
        path = new_cell("bench", is_simulated=True, seed=5)
    enter_board(path, BoardSpec(), "a4", 0.030)
    calibrate_cell(path, Reporter(), None, n_views=N_VIEWS)
    return folder


@pytest.fixture
def calibrated(calibrated_once, cells):
    shutil.copytree(calibrated_once, cells)
    return cells / "bench.toml"


def step(path, name):
    return next(step for step in steps(path) if step.name == name)


def measured(path):
    return measure_table(path, Reporter(), None, lambda: None)


def test_known_cells_are_those_in_the_folder(cells):
    assert known_cells() == ()
    paths = [new_cell(name, is_simulated=True) for name in ("one", "two")]
    assert known_cells() == tuple(paths)


@pytest.mark.parametrize("name", ["arm", "camera"])
def test_a_device_is_tried_and_what_was_found_is_kept_until_the_file_has_another(name):
    path = new_cell("bench", is_simulated=True)
    assert step(path, name).state is StepState.OPEN
    finding = examine_device(path, name)
    assert finding.problem is None
    found = step(path, name)
    assert found.state is StepState.DONE and found.figure == finding.value and found.time
    text = path.read_text()
    path.write_text(text.replace('model = "UR5"', 'model = "UR5e"').replace("0.35\n", "0.30\n"))
    assert step(path, name).state is StepState.STALE
    path.write_text(text)
    undo(path, name)
    assert step(path, name).state is StepState.OPEN
    with pytest.raises(InputError, match="nothing to undo"):
        undo(path, name)


def test_an_arm_that_is_not_there_fails_with_its_remedy():
    path = new_cell("bench", is_simulated=False, address="127.1.2.3")
    finding = examine_device(path, "arm")
    found = step(path, "arm")
    assert found.state is StepState.FAILED
    assert found.figure == finding.problem and "127.1.2.3" in found.figure


@pytest.mark.system
def test_a_platform_that_is_elsewhere_than_in_the_file_is_measured_and_what_stands_on_it_follows(calibrated):
    truth = read_cell(calibrated).place
    wrong = {"platform_height_m": truth.platform_height_m + 0.011}
    write_place(calibrated, wrong)
    before = read_cell(calibrated).place
    text = calibrated.read_text()

    found = measured(calibrated)
    after = read_cell(calibrated).place
    assert after.platform_height_m == pytest.approx(truth.platform_height_m, abs=0.001)
    assert found.moved_m[2] == pytest.approx(-0.011, abs=0.001)
    assert found.tilt_rad < np.radians(0.3)
    for name in ("table_height_m", "crop_min_m", "crop_max_m", "cup_station_m"):
        moved = np.atleast_1d(getattr(after, name)) - np.atleast_1d(getattr(before, name))
        assert moved[-1] == pytest.approx(found.moved_m[2], abs=1e-9), name
    assert after.cup_station_m[:2] == before.cup_station_m[:2]
    assert np.subtract(after.crop_max_m, after.crop_min_m) == pytest.approx(
        np.subtract(before.crop_max_m, before.crop_min_m)
    )
    assert step(calibrated, "table").state is StepState.DONE
    assert [line for line in calibrated.read_text().splitlines() if "#" in line] == [
        line for line in text.splitlines() if "#" in line
    ]

    write_place(calibrated, {"table_height_m": after.table_height_m - 0.01})
    assert step(calibrated, "table").state is StepState.STALE
    with pytest.raises(InputError, match="were changed since"):
        undo(calibrated, "table")
    write_place(calibrated, {"table_height_m": after.table_height_m})
    undo(calibrated, "table")
    assert read_cell(calibrated).place == before
    assert step(calibrated, "table").state is StepState.OPEN


def test_a_crop_box_entered_since_does_not_undo_the_platform_and_moves_along_when_that_is_undone():
    path = new_cell("bench", is_simulated=True)
    names = ("platform_min_m", "platform_max_m", "crop_min_m", "crop_max_m", "platform_height_m")
    before = read_cell(path).place.model_dump(mode="json", include={*names, "cup_station_m"})
    measured_as = {name: (np.array(before[name]) - 0.011).tolist() for name in names}
    write_place(path, measured_as)
    low, high = np.array(measured_as["crop_min_m"]) - 0.02, np.array(measured_as["crop_max_m"]) + 0.03
    enter_crop_box(path, low, high)
    assert is_in_file(read_cell(path).place, measured_as)
    write_former_place(path, before)
    place = read_cell(path).place
    assert place.platform_height_m == pytest.approx(before["platform_height_m"])
    assert np.allclose(place.crop_min_m, low + 0.011) and np.allclose(place.crop_max_m, high + 0.011)


@pytest.mark.system
def test_a_tilted_platform_is_refused_and_the_file_stays(calibrated, monkeypatch):
    from core.calibration.rig import exp_pose
    from hardware.cameras.simulated_board import SimulatedBoardCamera

    plain = SimulatedBoardCamera.lying
    tilt = exp_pose(np.array([np.radians(2.5), 0, 0, 0, 0, 0]))
    monkeypatch.setattr(SimulatedBoardCamera, "lying", lambda *a: plain(*a) @ tilt)
    before = calibrated.read_bytes()
    with pytest.raises(StageError, match=r"tilted by 2\.\d degrees"):
        measured(calibrated)
    assert calibrated.read_bytes() == before
    assert step(calibrated, "table").state is StepState.OPEN


def test_the_platform_is_measured_by_a_calibrated_camera_only():
    path = new_cell("bench", is_simulated=True)
    enter_board(path, BoardSpec(), "a4", 0.030)
    with pytest.raises(InputError, match="calibrate first"):
        measured(path)


def test_views_are_chosen_for_the_cell_all_around_and_can_be_undone():
    path = new_cell("bench", is_simulated=True)
    before = read_cell(path)
    found = choose_views(path, Reporter(), 10)
    after = read_cell(path)
    views_rad = np.array(after.scan.views_rad)
    assert len(views_rad) == len(found.views) == 10
    assert motion_scene(after).clearance(views_rad).distance_m.min() > 0.95 * after.scan.min_clearance_m
    eyes = (flange_pose(ARMS["UR5"], views_rad) @ after.camera.pose)[:, :3, 3]
    assert (eyes[:, 2] > after.place.platform_height_m + 0.1).all()
    around = np.arctan2(*(eyes - after.place.platform_center_m).T[1::-1])
    assert len({int(quarter) for quarter in np.floor(around / (np.pi / 2))}) >= 3
    assert step(path, "views").state is StepState.DONE

    place = after.place.model_dump(mode="json")
    write_place(path, {"crop_max_m": [*place["crop_max_m"][:2], place["crop_max_m"][2] - 0.05]})
    assert step(path, "views").state is StepState.STALE
    undo(path, "views")
    assert read_cell(path).scan.views_rad == before.scan.views_rad
    assert step(path, "views").state is StepState.OPEN


def test_a_scan_s_views_that_the_arm_does_not_reach_are_not_written():
    path = new_cell("bench", is_simulated=True)
    far = {"platform_min_m": [3.0, 3.0], "platform_max_m": [3.4, 3.4]}
    write_place(path, far | {"crop_min_m": [3.0, 3.0, 0.03], "crop_max_m": [3.4, 3.4, 0.35]})
    before = path.read_bytes()
    with pytest.raises(Exception, match="reaches only 0 views"):
        choose_views(path, Reporter())
    assert path.read_bytes() == before


def test_a_damaged_result_is_named(cells):
    path = new_cell("bench", is_simulated=True)
    examine_device(path, "arm")
    [folder] = runs(path, "arm")
    table = json.loads((folder / RESULT).read_text())
    (folder / RESULT).write_text(json.dumps({key: table[key] for key in table if key != "device"}))
    with pytest.raises(Exception, match="damaged"):
        steps(path)
    assert calibration_folder(path).is_dir()
