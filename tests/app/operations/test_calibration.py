import json

import numpy as np
import pytest

from app.jobs.scan_work import planned_pose
from app.operations.calibration import step_names
from app.operations.calibration.camera_error import camera_error
from app.operations.calibration.capture import CaptureObserver
from app.operations.calibration.cell_file import (
    arm_table,
    cell_path,
    new_cell,
    write_former_hand_eye,
    write_hand_eye,
    write_views,
)
from app.operations.calibration.check import check_cell
from app.operations.calibration.hand_eye import calibrate_cell
from app.operations.calibration.provenance import VIEWS, read_looks, runs
from app.operations.calibration.steps import StepState, enter_board, steps
from app.operations.calibration.undoing import undo
from core.calibration.board import BoardSpec
from core.calibration.collecting import Collection
from core.calibration.detection import detect_board, gray
from core.calibration.lens import Lens
from core.calibration.rig import exp_pose, log_pose
from core.errors import Cancelled, InputError, Remedy, StageError
from core.geometry import invert_pose
from core.motion.arm_models import UR5
from core.motion.factory_calibration import calibrated as calibrated_arm
from core.progress import Reporter
from hardware.cameras.simulated_board import SimulatedBoardCamera
from hardware.cell import SIMULATED_CELL, read_cell
from hardware.cell.scene import motion_scene, pour_cell
from hardware.interfaces import Kinematics
from hardware.robots.joint_motion import JointMotion
from tests.core.motion.measured_arms import measured_arm

N_VIEWS = 10


@pytest.fixture(autouse=True)
def cells(tmp_path, monkeypatch):
    monkeypatch.setenv("POURSIGHT_CELLS", str(tmp_path / "cells"))
    return tmp_path / "cells"


def measured_cell(name="bench", seed=0, **set_up):
    path = new_cell(name, is_simulated=True, seed=seed)
    for key, value in set_up.items():
        path.write_text(path.read_text() + f"{key} = {value}\n")
    enter_board(path, BoardSpec(), "a4", 0.030)
    return path


def states(path, *names):
    found = {step.name: step.state for step in steps(path)}
    return {name: found[name] for name in names or ("board", "hand-eye", "check")}


def calibrated(path, reporter=None, **options):
    return calibrate_cell(path, reporter or Reporter(), None, n_views=N_VIEWS, **options)


def comments(path):
    return [line.split("#")[1] for line in path.read_text().splitlines() if "#" in line]


def test_who_follows_sees_the_corners_where_they_are_said_to_be():
    path = measured_cell(seed=1)
    seen = []

    def taken(look, n_usable, image):
        if look.view is not None:
            seen.append((look.view, image))
            raise Cancelled

    with pytest.raises(Cancelled):
        calibrated(path, observer=CaptureObserver(taken=taken))
    [(view, image)] = seen
    assert any(read_cell(path).simulation.set_up.distortion)
    found = detect_board(gray(image.color), BoardSpec(), Lens(image.intrinsics))
    common, here, there = np.intersect1d(found.ids, view.ids, return_indices=True)
    off_px = np.linalg.norm(found.corners_px[here] - view.corners_px[there], axis=1)
    assert len(common) > 10 and np.median(off_px) < 0.3, off_px.round(2)


@pytest.mark.system
def test_a_bare_cell_becomes_a_calibrated_and_checked_one(cells):
    path = new_cell("Bench one", is_simulated=True, seed=3)
    assert path == cells / "bench-one.toml" == cell_path("bench one")
    assert {step.state for step in steps(path)} == {StepState.OPEN}
    with pytest.raises(InputError, match="No calibration board is entered"):
        calibrated(path)
    pdf = enter_board(path, BoardSpec(), "letter", None)
    assert pdf.read_bytes().startswith(b"%PDF")
    with pytest.raises(InputError, match="not measured"):
        calibrated(path)
    enter_board(path, BoardSpec(), "letter", 0.030)

    before = read_cell(path)
    found = calibrated(path)
    after = read_cell(path)
    truth = after.simulation.set_up.camera_pose
    error = log_pose(invert_pose(after.camera.pose) @ truth)
    assert np.linalg.norm(error[3:]) < max(1.5 * found.bounds.position_m, 0.001)
    assert np.linalg.norm(log_pose(invert_pose(before.camera.pose) @ truth)[3:]) > 0.005
    assert comments(SIMULATED_CELL) == comments(path)[: len(comments(SIMULATED_CELL))]
    assert after.model_copy(update={"camera": before.camera, "robot": before.robot}) == before
    own = after.simulation.set_up.own_arm(UR5)
    assert after.robot.arm == own != UR5, "what its maker measured is in the file"
    assert states(path) == {"board": StepState.DONE, "hand-eye": StepState.DONE, "check": StepState.OPEN}
    _, looks = read_looks(found.folder)
    assert len(list(found.folder.glob("view-*.png"))) == sum(look.view is not None for look in looks)

    error_m, error_rad = camera_error(path, after.camera.pose)
    assert error_m * np.sqrt(3) == pytest.approx(found.bounds.expected_pouring_m)
    assert found.bounds.angle_rad / 4 < error_rad < found.bounds.angle_rad
    assert camera_error(path, before.camera.pose) is None, "nobody calibrated that one"

    checked = check_cell(path, Reporter(), None, lambda: None)
    assert checked.agreement.is_good and checked.agreement.rms_m < 0.002
    assert states(path)["check"] is StepState.DONE

    enter_board(path, BoardSpec(), "a4", 0.0299)
    assert states(path) == {"board": StepState.DONE, "hand-eye": StepState.STALE, "check": StepState.STALE}
    undo(path, "board")
    undo(path, "hand-eye")
    assert np.allclose(read_cell(path).camera.pose, before.camera.pose, atol=1e-8)
    assert states(path)["hand-eye"] is StepState.OPEN and states(path)["check"] is StepState.STALE
    with pytest.raises(InputError, match="there is nothing to undo"):
        undo(path, "hand-eye")


@pytest.mark.system
def test_an_interrupted_calibration_goes_on_with_what_was_taken():
    path = measured_cell(seed=1)
    before = path.read_bytes()
    interrupted_after(path, 4)
    assert path.read_bytes() == before
    n_new = []
    found = calibrated(
        path, observer=CaptureObserver(taken=lambda look, n_usable, image: n_new.append(n_usable))
    )
    assert n_new[0] == 5
    assert found.n_views == N_VIEWS


def test_wrongly_entered_squares_are_refused_at_the_first_look():
    path = measured_cell(square_m=0.026)
    before = path.read_bytes()
    with pytest.raises(StageError, match=r"squares of the board are 2[56]\.\d mm, not 30.0 mm"):
        calibrated(path)
    assert path.read_bytes() == before


@pytest.mark.system
def test_a_board_that_moves_meanwhile_is_noticed_and_nothing_is_lost(monkeypatch):
    path = measured_cell(seed=2)
    before = path.read_bytes()
    plain = SimulatedBoardCamera.capture

    def pushed_once(camera):
        if camera._n_shots == 7:
            camera.T_base_board = camera.T_base_board @ exp_pose(np.array([0, 0, 0.03, 0.01, 0, 0]))
        return plain(camera)

    monkeypatch.setattr(SimulatedBoardCamera, "capture", pushed_once)
    with pytest.raises(StageError, match="The board moved between view"):
        calibrated(path)
    assert path.read_bytes() == before
    _, looks = read_looks(runs(path, step_names.HAND_EYE)[-1])
    assert sum(look.is_used for look in looks) >= N_VIEWS


@pytest.mark.system
def test_a_check_finds_a_camera_that_was_bumped(monkeypatch):
    path = measured_cell(seed=4)
    calibrated(path)
    settings = read_cell(path)
    set_up = settings.simulation.set_up
    bumped = set_up.camera_pose @ exp_pose(np.array([0.02, 0, 0, 0.004, 0, 0]))
    rows = tuple(tuple(row) for row in bumped.tolist())
    plain = SimulatedBoardCamera.__init__

    def bump(camera, world, robot, arm, truth, board, noise):
        plain(camera, world, robot, arm, truth.model_copy(update={"T_flange_camera": rows}), board, noise)

    monkeypatch.setattr(SimulatedBoardCamera, "__init__", bump)
    checked = check_cell(path, Reporter(), None, lambda: None)
    assert not checked.agreement.is_good
    assert states(path)["check"] is StepState.FAILED


def test_a_check_needs_a_calibration():
    with pytest.raises(InputError, match="not one that was calibrated here"):
        check_cell(measured_cell(), Reporter(), None, lambda: None)


def test_another_hand_eye_pose_in_the_file_changes_nothing_else(tmp_path):
    path = tmp_path / "by hand.toml"
    path.write_text(SIMULATED_CELL.read_text().replace("[camera]", "[camera]  # mine"))
    pose = read_cell(path).camera.pose @ exp_pose(np.array([0.1, 0, 0, 0.01, 0, 0]))
    write_hand_eye(path, pose)
    assert np.allclose(read_cell(path).camera.pose, pose, atol=1e-8)
    assert "[camera]  # mine" in path.read_text()
    assert comments(path)[-1] == comments(SIMULATED_CELL)[-1]


@pytest.mark.parametrize("seed", range(3))
def test_an_arms_own_kinematics_are_kept_in_the_file_and_used_everywhere(seed):
    path = new_cell("bench", is_simulated=False, address="192.168.0.7")
    measured = measured_arm(UR5, seed)  # offsets of hundreds of metres among them
    own = calibrated_arm(UR5, measured)
    settings = read_cell(path)
    views = shown_views(settings)
    write_hand_eye(path, settings.camera.pose, Kinematics(own, "0badcafe", measured))
    settings = read_cell(path)
    assert settings.robot.kinematics_checksum == "0badcafe"
    for arm in (settings.robot.arm, motion_scene(settings).arm, pour_cell(settings).arm):
        assert arm == own, "to the last digit"
    apart_m = np.linalg.norm((shown_views(settings) - views)[:, :3, 3], axis=1)
    assert 0.0005 < apart_m.max() < 0.03, "drawn where this arm brings the camera"
    before = read_cell(path)
    write_hand_eye(path, settings.camera.pose)
    assert read_cell(path).robot.arm == UR5
    write_former_hand_eye(path, before.camera.pose, arm_table(before))
    assert read_cell(path) == before


def shown_views(settings):
    """Where a page draws the views of a scan."""
    return np.array([planned_pose(settings, joints) for joints in settings.scan.views_rad])


def test_a_file_that_is_no_cell_stays_as_it_is(tmp_path):
    path = tmp_path / "broken.toml"
    path.write_text("name = 'x'\n")
    with pytest.raises(InputError, match="cannot be changed"):
        write_hand_eye(path, np.eye(4))
    assert path.read_text() == "name = 'x'\n"


@pytest.mark.parametrize("name", ["", "  ", "?!"])
def test_a_cell_needs_a_name(name):
    with pytest.raises(InputError, match="needs a name"):
        new_cell(name, is_simulated=True)


def test_a_cell_is_never_overwritten():
    new_cell("bench", is_simulated=False, address="192.168.0.7")
    assert read_cell(cell_path("bench")).robot.address == "192.168.0.7"
    with pytest.raises(InputError, match="already"):
        new_cell("Bench", is_simulated=True)


def test_damaged_records_are_named(cells):
    path = measured_cell()
    (cells / "bench.calibration" / "board.json").write_text('{"boards": [{"board": {"columns": 1}}]}')
    with pytest.raises(Exception, match=r"board\.json is damaged"):
        steps(path)


@pytest.mark.parametrize(("fact", "device"), [("kinematics", "arm"), ("intrinsics", "camera")])
def test_looks_of_another_arm_or_camera_are_not_gone_on_with(fact, device):
    path = measured_cell(seed=1)
    interrupted_after(path, 2)
    [begun] = runs(path, step_names.HAND_EYE)
    record = json.loads((begun / VIEWS).read_text())
    (begun / VIEWS).write_text(json.dumps(record | {fact: "0badcafe"}))
    before = path.read_bytes()
    n_new = []
    watching = CaptureObserver(taken=lambda look, n_usable, image: n_new.append(n_usable))
    for _ in range(2):  # a refusal does not make them forgotten
        with pytest.raises(StageError, match=f"of another {device} than is connected") as refusal:
            calibrated(path, observer=watching)
        assert refusal.value.remedy is Remedy.RESTART_CALIBRATION
    assert n_new == [] and path.read_bytes() == before
    assert len(read_looks(begun)[1]) >= 2, "they are kept"
    assert runs(path, step_names.HAND_EYE) == [begun], "a refusal leaves no run"
    interrupted_after(path, 1, is_restarted=True)
    assert len(read_looks(runs(path, step_names.HAND_EYE)[-1])[1]) < len(record["views"]), "left aside"


def interrupted_after(path, n_usable, **options):
    """Calibrate until there are so many usable looks."""
    reporter = Reporter()

    def stop(_look, n_now, _image):
        if n_now == n_usable:
            reporter.cancel()

    with pytest.raises(Cancelled):
        calibrated(path, reporter, observer=CaptureObserver(taken=stop), **options)


def test_a_board_that_is_not_there_is_said_and_the_file_stays(monkeypatch):
    path = measured_cell(seed=1)
    write_views(path, read_cell(path).scan.views_rad[:2])
    before = path.read_bytes()
    plain = SimulatedBoardCamera.__init__

    def without_board(camera, *words):
        plain(camera, *words)
        camera.T_base_board = camera.lying(np.array([3.0, 3.0, 0.0]), 0.0)

    monkeypatch.setattr(SimulatedBoardCamera, "__init__", without_board)
    with pytest.raises(StageError, match=r"in sight from none of the scan's views\. No board"):
        calibrated(path)
    assert path.read_bytes() == before


@pytest.mark.system
def test_an_arm_that_is_pushed_during_an_image_costs_that_look_alone(monkeypatch):
    path = measured_cell(seed=1)
    plain = SimulatedBoardCamera.capture

    def pushed_once(camera):
        image = plain(camera)
        if camera._n_shots == 5:
            pushed = camera._robot.state().joints_rad[None] + 0.001
            camera._robot._begin(JointMotion(pushed, 1.0, 1.0))
        return image

    monkeypatch.setattr(SimulatedBoardCamera, "capture", pushed_once)
    found = calibrated(path)
    _, looks = read_looks(found.folder)
    [refused] = [look for look in looks if "arm moved while the image was taken" in look.problem]
    assert refused.view is None and found.n_views == N_VIEWS and found.n_refused >= 1


def test_too_few_poses_are_refused_and_what_was_taken_is_gone_on_with(monkeypatch):
    path = measured_cell(seed=1)
    before = path.read_bytes()
    with monkeypatch.context() as patch:
        patch.setattr(Collection, "next_poses", lambda *_: ())
        with pytest.raises(StageError, match="1 view of the board is too few; take at least 6"):
            calibrated(path)
    assert path.read_bytes() == before
    n_kept = len(read_looks(runs(path, step_names.HAND_EYE)[-1])[1])
    assert n_kept >= 1
    interrupted_after(path, 2)
    assert len(read_looks(runs(path, step_names.HAND_EYE)[-1])[1]) > n_kept
