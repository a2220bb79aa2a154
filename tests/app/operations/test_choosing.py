"""A person's pour instead of the program's: from the command to the run's log and the report."""

import numpy as np
import pytest

from app.cli import arm_commands
from app.cli.arm_commands import plan_lines
from app.operations.pouring import prepare
from app.operations.session import SessionTask, working_on
from core.errors import InputError, MotionError, SessionError
from core.motion.pour.feasibility import PourMotions
from core.progress import Reporter
from core.report.tables import run_rows
from core.session import Session
from core.session.operator_choice import read_operator_choice
from core.session.pour_runs import PourRun
from core.workers import WorkerPool
from hardware.cell import Arm, read_cell
from hardware.cell.scene import motion_scene
from hardware.cell.settings import ARMS
from hardware.grippers.simulated import SimulatedGripper
from hardware.interfaces import Kinematics
from hardware.pouring.pouring import Pouring
from hardware.robots.kinematic import KinematicRobot
from tests.app.sessions import quick_parameters

WHY = "the handle is in the way"


@pytest.fixture
def session(mug_session):
    """A mug, scanned, imagined, and its pours judged for the simulated cell's arm."""
    return mug_session


@pytest.fixture
def motions(session):
    return PourMotions.load(session / "motion")


def prepared(session):
    with (
        WorkerPool(1) as pool,
        working_on(SessionTask(session, quick_parameters(), "default"), pool, Reporter()) as pipeline,
    ):
        return prepare(pipeline, read_cell())


def another(motions, is_feasible):
    """A pour that the program does not choose."""
    choice = motions.choice
    return next(
        pour
        for pour in motions.pours
        if pour.is_feasible is is_feasible and (pour.i, pour.j) != (choice.i, choice.j)
    )


def test_the_operators_pour_is_the_target_and_everything_says_so(session, motions, capsys):
    wanted = another(motions, is_feasible=True)
    arm_commands.choose(session, wanted.i, wanted.j, f" {WHY} ")
    assert f"is chosen ({WHY})" in capsys.readouterr().out
    task = prepared(session)
    target = task.target
    assert (target.i, target.j) == (wanted.i, wanted.j)
    assert target.theta_rad == task.grid.theta_rad[wanted.i]
    assert np.array_equal(target.pivot_m, task.grid.pivot_m[wanted.i, wanted.j])
    program = motions.choice
    assert target.note.startswith("Chosen by the operator, from ")
    assert f"{WHY} (the program would choose " in target.note
    assert f"at {1000 * task.grid.indent_m[program.j]:.0f} mm)" in target.note

    tool = task.settings.gripper.grasp_pose
    robot = KinematicRobot(
        Kinematics(ARMS[task.settings.robot.model]), task.settings.robot.home_rad, True, tool
    )
    arm = Arm(task.settings, robot, SimulatedGripper(), motion_scene(task.settings))
    pouring = Pouring(arm, task.cell, target, session, Reporter())
    fresh = pouring.plan()
    assert plan_lines(fresh.plan, target.note)[0] == target.note
    run = PourRun.load(pouring.carry_out(fresh))
    assert run.events[0]["kind"] == "confirmed" and run.events[0]["note"] == target.note
    assert run_rows([run])[0][1] == f"The pour was made. {target.note}"


def test_a_withdrawn_choice_leaves_it_to_the_program(session, motions):
    wanted = another(motions, is_feasible=True)
    arm_commands.choose(session, wanted.i, wanted.j, WHY)
    arm_commands.withdraw(session)
    target = prepared(session).target
    assert (target.i, target.j, target.note) == (motions.choice.i, motions.choice.j, "")


def test_a_pour_that_the_arm_cannot_make_is_refused_with_the_reason(session, motions):
    wanted = another(motions, is_feasible=False)
    arm_commands.choose(session, wanted.i, wanted.j, WHY)
    with pytest.raises(MotionError, match="the operator chose, from ") as refusal:
        prepared(session)
    assert wanted.reason in str(refusal.value)
    assert str(refusal.value).endswith("Choose another one, or withdraw the choice.")


@pytest.mark.system
def test_what_was_chosen_among_other_pours_does_not_count(session, motions):
    wanted = another(motions, is_feasible=True)
    arm_commands.choose(session, wanted.i, wanted.j, WHY)
    digest = Session.open(session).record("pouring").digest
    assert read_operator_choice(session, digest) is not None
    record = session / "pouring" / "record.json"
    record.write_text(record.read_text().replace(digest, "f" * 64))
    target = prepared(session).target
    assert target.note == ""


@pytest.mark.parametrize(("i", "j"), [(8, 0), (0, 3), (-1, 0)])
def test_a_pour_that_is_not_there(session, i, j):
    with pytest.raises(InputError, match="directions go from 0 to 7, distances from 0 to 2"):
        arm_commands.choose(session, i, j, WHY)


def test_no_choice_without_pours(tmp_path):
    Session.create_or_open(tmp_path / "empty")
    with pytest.raises(SessionError, match="imagine first"):
        arm_commands.choose(tmp_path / "empty", 0, 0, WHY)
