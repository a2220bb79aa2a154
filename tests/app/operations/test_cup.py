"""The cup of a cell: entered, taught, judged at once; and the dry run with it, through the real driver."""

from __future__ import annotations

import random

import numpy as np
import pytest

from app.operations.calibration import step_names
from app.operations.calibration.cell_file import new_cell, write_place
from app.operations.calibration.cup import enter_cup
from app.operations.calibration.cup_entry import (
    CupEntry,
    base_diameter_m,
    changed_cup,
    measured_cup,
    read_taught_station,
)
from app.operations.calibration.dry_run import SHARE, dry_run
from app.operations.calibration.provenance import calibration_folder
from app.operations.calibration.steps import StepState, steps
from app.operations.calibration.table import is_in_file
from app.operations.calibration.undoing import undo
from app.operations.pouring import prepare
from core.errors import Cancelled, InputError, MotionError
from core.motion.kinematics import inverse_kinematics
from core.motion.pour.plan import PourPlan
from core.parameters import Parameters
from core.pipeline.pipeline import Pipeline
from core.progress import Reporter
from core.session import Session
from core.session.pour_runs import pour_runs
from core.workers import RunHere
from hardware.cell import read_cell
from hardware.cell.scene import pour_cell
from hardware.pouring.pouring import PLAN_FOLDER
from hardware.simulation.ur_controller.process import ControllerProcess

CUP = measured_cup(0.10, 0.07, 0.06, 0.002)
STATION_M = (-0.48, 0.08, 0.015)


@pytest.fixture(autouse=True)
def cells(tmp_path, monkeypatch):
    monkeypatch.setenv("POURSIGHT_CELLS", str(tmp_path / "cells"))
    return tmp_path / "cells"


@pytest.fixture
def path():
    return new_cell("bench", is_simulated=True)


def step(path, name):
    return next(step for step in steps(path) if step.name == name)


def entered(path, **changes):
    values = {"station_m": STATION_M, "cup": CUP, "payload_kg": 1.0, "cup_kg": 0.2} | changes
    return enter_cup(path, CupEntry(**values), Reporter())


def test_a_cup_is_measured_by_its_diameters():
    assert CUP.mouth_radius_m == pytest.approx(0.035)
    assert base_diameter_m(CUP) == pytest.approx(0.06)
    longer = changed_cup(CUP, (120.0, None, None, None))
    assert (longer.length_m, base_diameter_m(longer)) == (pytest.approx(0.12), pytest.approx(0.06))
    assert changed_cup(CUP, (None, None, None, None)) is CUP


@pytest.mark.parametrize(
    "measures",
    [(0.1, 0.05, 0.06, 0.002), (0.0, 0.07, 0.06, 0.002), (0.1, 0.07, 0.003, 0.002), (9, 0.07, 0.06, 0.002)],
)
def test_what_is_no_cup_is_refused(measures):
    with pytest.raises(InputError, match="measure"):
        measured_cup(*measures)


def test_a_cup_is_entered_judged_kept_and_taken_back(path):
    assert step(path, step_names.CUP).state is StepState.OPEN
    text, before = path.read_text(), read_cell(path)
    found = entered(path)
    assert "of 8 sides" in found.sentence
    after = read_cell(path)
    assert after.place.cup_station_m == pytest.approx(STATION_M)
    assert (after.gripper.payload_kg, after.gripper.cup_kg) == (1.0, 0.2)
    assert after.cup == CUP
    assert step(path, step_names.CUP).state is StepState.DONE
    assert [line for line in path.read_text().splitlines() if line.startswith("#")] == [
        line for line in text.splitlines() if line.startswith("#")
    ]
    assert is_in_file(after.place, before.place.model_dump(mode="json")), (
        "platform and table stay as measured"
    )

    write_place(path, {"table_height_m": 0.014})
    assert step(path, step_names.CUP).state is StepState.STALE
    write_place(path, {"table_height_m": 0.015})
    undo(path, step_names.CUP)
    assert read_cell(path).cup is None
    assert read_cell(path).place == before.place
    assert read_cell(path).gripper.payload_kg == before.gripper.payload_kg
    assert step(path, step_names.CUP).state is StepState.OPEN


@pytest.mark.parametrize(
    ("changes", "kind", "said"),
    [
        ({"station_m": (0.9, 0.9, 0.015)}, MotionError, "cannot reach the cup"),
        ({"station_m": (-0.06, -0.35, 0.015)}, MotionError, "stand in the platform"),
        ({"payload_kg": 0.1}, InputError, "weigh both"),
        ({"payload_kg": 9.0}, InputError, "payload_kg"),
    ],
)
def test_a_cup_that_cannot_be_is_refused_at_once_and_the_file_stays(path, changes, kind, said):
    before = path.read_bytes()
    with pytest.raises(kind, match=said):
        entered(path, **changes)
    assert path.read_bytes() == before
    assert step(path, step_names.CUP).state is StepState.OPEN


def test_pours_that_were_imagined_with_another_cup_are_not_made_in_the_cell(path, tmp_path):
    entered(path)
    with Session.create_or_open(tmp_path / "session") as session:
        pipeline = Pipeline(session, Parameters(), RunHere(), Reporter())
        with pytest.raises(InputError, match=r"imagine again with pouring\.cup\.length_m = 0\.1,"):
            prepare(pipeline, read_cell(path))


def test_without_a_cup_there_is_no_dry_run_and_nobody_guides_a_simulated_arm(path):
    with pytest.raises(InputError, match="No cup was entered"):
        dry_run(path, Reporter(), None)
    with pytest.raises(InputError, match="nobody can guide"):
        read_taught_station(path)


class Person:
    """Says yes, and no to one move; keeps what was asked."""

    is_present = True

    def __init__(self, refused=None):
        self.refused, self.asked, self.moves, self.is_back = refused, [], [], False

    def confirm_pour(self, plan, note, robot, cup):
        self.asked.append("pour")

    def confirm_move(self, move):
        self.moves.append(move.name.value)
        if move.name.value == self.refused:
            self.refused = None
            raise Cancelled("Not confirmed.")

    def confirm_step(self, step, why):
        self.asked.append(step.value)

    def confirm_recovery(self, error, is_repeated):
        self.asked.append("recover")

    def is_cup_in_hand(self, known):
        self.asked.append("cup in hand")
        return True

    def confirm_opening(self, gripper, known):
        self.asked.append("opening")

    def confirm_back_off(self, moves):
        self.asked.append("back off")

    def backed_off(self):
        self.is_back = True


@pytest.fixture
def real(cells):
    """A cell whose arm is driven as a real one is, and the controller at its address."""
    pick = random.Random()
    address = ".".join(["127", *(str(pick.randint(2, 250)) for _ in range(3))])
    path = new_cell("real", is_simulated=True)
    text = path.read_text()
    text = text.replace('name = "real"', 'name = "real"\nis_rehearsal = true', 1)
    text = text.replace('[robot]\nkind = "simulated"', f'[robot]\nkind = "ur5"\naddress = "{address}"', 1)
    text = text.replace('[gripper]\nkind = "simulated"', '[gripper]\nkind = "ur5"', 1)
    path.write_text(text)
    settings = read_cell(path)
    with ControllerProcess("UR5", "3.15", address, list(settings.robot.home_rad), 6.0):
        yield path


@pytest.mark.system
def test_a_station_is_read_from_the_joints_of_an_arm_that_was_guided_there(cells):
    pick = random.Random()
    address = ".".join(["127", *(str(pick.randint(2, 250)) for _ in range(3))])
    path = new_cell("real", is_simulated=False, address=address)
    cell = pour_cell(read_cell(path))
    grasp = np.eye(4)
    grasp[:3, 3] = np.add(STATION_M, (0, 0, cell.grip_height_m + 0.004))
    found = inverse_kinematics(cell.arm, (grasp @ np.linalg.inv(cell.T_flange_grasp))[None])
    joints_rad = found.joints_rad[found.found][0]
    with ControllerProcess("UR5", "3.15", address, joints_rad.tolist(), 1.0):
        x, y, z = read_taught_station(path)
    assert (x, y) == pytest.approx(STATION_M[:2], abs=2e-4)
    assert z == read_cell(path).place.table_height_m, "4 mm above the table is on it"
    home_rad = list(read_cell(path).robot.home_rad)
    elsewhere = ControllerProcess("UR5", "3.15", address, home_rad, 1.0)
    with elsewhere, pytest.raises(MotionError, match="would lean"):
        read_taught_station(path)


@pytest.mark.system
@pytest.mark.punctual
def test_a_dry_run_is_the_whole_pour_slowly_each_move_confirmed_and_a_no_brings_the_cup_back(real):
    entered(real)
    person = Person(refused="lay")
    found = dry_run(real, Reporter(), person)
    assert person.is_back and "back off" in person.asked
    assert person.moves.count("lay") == 2, "said no once, and yes afterwards"
    assert person.moves[-1] == "home" and person.asked.count("pour") == 2
    assert step(real, step_names.DRY_RUN).state is StepState.DONE
    plan = PourPlan.load(found.run / PLAN_FOLDER)
    limits = read_cell(real).motion
    for move in plan.moves:
        speeds = np.abs(np.diff(move.trajectory.joints_rad, axis=0)).max() / 0.008
        assert speeds <= SHARE * max(limits.joint_speed_rad_s, limits.pour_joint_speed_rad_s) * 1.001
    runs = pour_runs(calibration_folder(real) / step_names.DRY_RUN)
    assert [run.is_done for run in runs][-1] and len(runs) == 3
    undo(real, step_names.DRY_RUN)
    assert step(real, step_names.DRY_RUN).state is StepState.OPEN


class Leaving(Person):
    """Says no to one move, and leaves."""

    def confirm_recovery(self, error, is_repeated):
        raise Cancelled("Nobody is there any more.")


@pytest.mark.system
@pytest.mark.punctual
def test_the_cup_that_a_dry_run_left_in_the_hand_is_brought_back_by_the_next_one(real):
    entered(real)
    with pytest.raises(Cancelled):
        dry_run(real, Reporter(), Leaving(refused="lay"))
    assert step(real, step_names.DRY_RUN).state is StepState.OPEN
    person = Person()
    dry_run(real, Reporter(), person)
    assert person.asked == ["cup in hand", "back off", "pour"]
    assert person.is_back and step(real, step_names.DRY_RUN).state is StepState.DONE


@pytest.mark.system
def test_a_real_arm_makes_no_dry_run_without_somebody(real):
    entered(real)
    with pytest.raises(InputError, match="with somebody"):
        dry_run(real, Reporter(), None)
