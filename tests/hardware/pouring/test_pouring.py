"""What is refused before anything moves, and the whole pour with the kinematic twin."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest

from core.errors import Cancelled, MotionError
from core.motion.pour.plan import PourPlan
from core.progress import Reporter
from core.session.pour_runs import PourRun, pour_runs
from hardware.cell import Arm
from hardware.cell.scene import motion_scene, pour_cell
from hardware.cell.settings import ARMS
from hardware.driving import refuse_deviation, slowness
from hardware.errors import DeviceError, OutputChanged, TrackingLost
from hardware.grippers.simulated import SimulatedGripper
from hardware.interfaces import Kinematics
from hardware.modes import SafetyMode
from hardware.pouring.pouring import Pouring
from hardware.robots.kinematic import KinematicRobot
from tests.hardware.pouring.rig import a_target, quick_cell

SETTINGS = quick_cell(1.0, "3.15")
HOME = np.array(SETTINGS.robot.home_rad)


@pytest.fixture(scope="module")
def fresh_plan(tmp_path_factory):
    return a_pouring(an_arm(), tmp_path_factory.mktemp("planning")).plan()


def an_arm(gripper=None):
    tool = SETTINGS.gripper.grasp_pose
    robot = KinematicRobot(Kinematics(ARMS[SETTINGS.robot.model]), SETTINGS.robot.home_rad, True, tool)
    return Arm(SETTINGS, robot, gripper or SimulatedGripper(), motion_scene(SETTINGS))


def a_pouring(arm, session, target=None):
    return Pouring(arm, pour_cell(SETTINGS), target or a_target(SETTINGS), session, Reporter())


def nothing_moved(arm, session):
    return np.array_equal(arm.robot.state().joints_rad, HOME) and not pour_runs(session)


def test_a_whole_pour(fresh_plan, tmp_path):
    arm = an_arm()
    run = a_pouring(arm, tmp_path).carry_out(fresh_plan)
    logged = PourRun.load(run)
    assert logged.is_done
    assert [event["name"] for event in logged.events if event["kind"] == "move"] == [
        move.name for move in fresh_plan.plan.moves
    ]
    grips = [event["is_closed"] for event in logged.events if event["kind"] == "gripper"]
    assert grips == [True, False]
    assert PourPlan.load(run / "plan").digest == fresh_plan.plan.digest
    assert arm.robot.state().joints_rad == pytest.approx(HOME)


def test_a_plan_expires(fresh_plan, tmp_path):
    arm = an_arm()
    old = replace(fresh_plan, made_s=time.monotonic() - SETTINGS.motion.expires_s - 1)
    with pytest.raises(MotionError, match="expired; plan again"):
        a_pouring(arm, tmp_path).carry_out(old)
    assert nothing_moved(arm, tmp_path)


def test_a_closed_gripper_may_hold_a_cup_that_no_plan_knows_of(tmp_path):
    arm = an_arm()
    arm.gripper.close()
    with pytest.raises(MotionError, match="take it out"):
        a_pouring(arm, tmp_path).plan()
    assert nothing_moved(arm, tmp_path)


def test_a_plan_for_another_imagination_is_refused(fresh_plan, tmp_path):
    arm = an_arm()
    other = replace(a_target(SETTINGS), digest="another imagination")
    with pytest.raises(MotionError, match="imagined again"):
        a_pouring(arm, tmp_path, other).carry_out(fresh_plan)
    assert nothing_moved(arm, tmp_path)


def test_a_plan_from_elsewhere_is_refused(fresh_plan, tmp_path):
    arm = an_arm()
    away_rad = HOME + np.array([0.05, 0, 0, 0, 0, 0])
    arm.robot.move_joints([HOME, away_rad], 1.0, 1.0)
    with pytest.raises(MotionError, match="moved since this plan"):
        a_pouring(arm, tmp_path).carry_out(fresh_plan)
    assert not pour_runs(tmp_path)


def test_a_taller_object_than_planned_for_is_noticed(fresh_plan, tmp_path):
    arm, target = an_arm(), a_target(SETTINGS)
    taller_m = target.object_aabb_m + np.array([[0, 0, 0], [0, 0, 0.05]])
    pouring = a_pouring(arm, tmp_path, replace(target, object_aabb_m=taller_m))
    with pytest.raises(MotionError):
        pouring.carry_out(fresh_plan)
    assert nothing_moved(arm, tmp_path)


def test_a_changed_sample_is_noticed(fresh_plan, tmp_path):
    arm, plan = an_arm(), fresh_plan.plan
    move = plan.moves[3]
    joints_rad = move.trajectory.joints_rad.copy()
    joints_rad[len(joints_rad) // 2, 1] += 0.02
    bent = replace(move, trajectory=replace(move.trajectory, joints_rad=joints_rad))
    moves = (*plan.moves[:3], bent, *plan.moves[4:])
    with pytest.raises(MotionError, match="carry"):
        a_pouring(arm, tmp_path).carry_out(replace(fresh_plan, plan=replace(plan, moves=moves)))
    assert nothing_moved(arm, tmp_path)


def test_a_gripper_that_does_not_close_ends_the_run_and_the_hand_withdraws(fresh_plan, tmp_path):
    class Broken(SimulatedGripper):
        def close(self):
            pass

    arm = an_arm(Broken())
    pouring = a_pouring(arm, tmp_path)
    with pytest.raises(DeviceError, match="did not confirm"):
        pouring.carry_out(fresh_plan)
    assert PourRun.load(pouring.last_run).sentence.startswith("Stopped during 'grasp'")
    with pytest.raises(MotionError, match="back off"):
        pouring.plan()
    pouring.recover()
    names = [move.name for move in pouring.plan_back_off()]
    assert names == ["let go of the cup", "retreat", "home"], "it may have closed all the same"
    back = PourRun.load(pouring.back_off(pouring.plan_back_off()))
    assert back.is_back_off
    assert back.sentence == "The arm backed off."
    assert arm.robot.state().joints_rad == pytest.approx(HOME)


def test_a_gripper_that_opens_in_the_carry_ends_the_run_and_the_hand_goes_home_empty(fresh_plan, tmp_path):
    class Slipping(SimulatedGripper):
        @property
        def is_closed(self):
            was_asked, self._asked = self._asked, self._asked + 1
            return self._is_closed and was_asked < 4

        _asked = 0

    arm = an_arm(Slipping())
    pouring = a_pouring(arm, tmp_path)
    with pytest.raises(OutputChanged, match="open while it should hold the cup"):
        pouring.carry_out(fresh_plan)
    pouring.recover()
    assert not any(move.holds_cup for move in pouring.plan_back_off())
    pouring.back_off(pouring.plan_back_off())
    assert arm.robot.state().joints_rad == pytest.approx(HOME)


def test_an_arm_that_was_pushed_after_a_stop_is_not_driven_back(fresh_plan, tmp_path):
    class Broken(SimulatedGripper):
        def close(self):
            raise DeviceError("The gripper has no air; open the valve.")

    arm = an_arm(Broken())
    pouring = a_pouring(arm, tmp_path)
    with pytest.raises(DeviceError, match="valve"):
        pouring.carry_out(fresh_plan)
    pouring.recover()
    here_rad = arm.robot.state().joints_rad
    arm.robot.move_joints([here_rad, here_rad + np.array([0, 0, 0, 0, 0, 0.5])], 1.0, 1.0)
    with pytest.raises(MotionError, match="by hand"):
        pouring.plan_back_off()


def test_an_arm_off_its_path_is_stopped(fresh_plan):
    trajectory = fresh_plan.plan.moves[3].trajectory
    state = an_arm().robot.state()
    refuse_deviation(replace(state, joints_rad=trajectory.joints_rad[50] + 0.03), trajectory)
    with pytest.raises(TrackingLost, match="off its planned path"):
        refuse_deviation(replace(state, joints_rad=trajectory.joints_rad[50] + 0.3), trajectory)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({}, ""),
        ({"speed_scaling": 0.4}, "slider is at 40%"),
        ({"speed_scaling": 0.0}, "slider is at 0: nothing moves"),
        ({"safety_mode": SafetyMode.REDUCED}, "reduced mode"),
    ],
)
def test_what_makes_the_arm_slow_is_said(changes, said):
    assert said in slowness(replace(an_arm().robot.state(), **changes))
    assert bool(slowness(replace(an_arm().robot.state(), **changes))) is bool(said)


def test_a_cancelled_pour_and_its_recovery_are_in_the_log(fresh_plan, tmp_path):
    pouring = a_pouring(an_arm(), tmp_path)
    pouring._reporter.cancel()
    robot = pouring.robot
    robot._is_instant = False
    with pytest.raises(Cancelled, match="at rest where it was stopped") as stopped:
        pouring.carry_out(fresh_plan)
    assert stopped.value.remedy is None, "the same command would be refused"
    pouring.recover()
    kinds = [event["kind"] for event in PourRun.load(pouring.last_run).events]
    assert kinds[-2:] == ["stopped", "recovered"]
