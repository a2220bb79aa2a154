"""Every state that faults lead to has a way back inside the program, with the real driver over TCP."""

from __future__ import annotations

import json

import numpy as np
import pytest

from core.errors import MotionError
from core.motion.margin import SHARE_OF_CLEARANCE
from core.motion.pour.margins import plan_margins
from core.motion.pour.scene import PourScene
from core.session.pour_runs import PourRun
from hardware.cell import CellSettings
from hardware.cell.scene import pour_cell
from hardware.driving import slowness
from hardware.errors import MoveRefused, RobotError, RobotNotReady, RobotStopped, TrackingLost
from hardware.pouring.pouring import Pouring
from tests.awake import within
from tests.hardware.pouring.rig import Rig, a_target, quick_cell
from tests.patience import HANG_S, wait_until

pytestmark = [pytest.mark.system, pytest.mark.punctual]

pytest.importorskip("rtde_control")

STOPPED_WITHIN_S = 0.3
SPEED_UP = 2.0


def stopped_in(rig, move, share=0.5):
    thread = rig.pour_until(move, share)
    rig.controller.command("program stop")
    thread.join(HANG_S)
    assert isinstance(thread.error, RobotError), repr(thread.error)
    return thread


def pours(rig):
    assert PourRun.load(rig.pouring.carry_out(rig.pouring.plan())).is_done
    assert rig.is_home


def cup_gap_m(rig):
    """Between the cup in the hand and what is nearest to it, where the arm stands."""
    target, joints_rad = a_target(rig.settings), rig.joints_rad[None]
    scene = PourScene(pour_cell(rig.settings), target.object_aabb_m, target.pouring.cup)
    return float(scene.cup_clearance(scene.held_cups(joints_rad), joints_rad).distance_m[0])


@pytest.mark.parametrize("move", ["carry", "pour", "carry back"])
def test_a_new_program_that_finds_the_gripper_closed_backs_off_along_the_old_path(rig, move):
    stopped_in(rig, move)
    rig.begin_again()  # as after a restart: nothing is remembered
    rig.arm.robot.recover()
    assert not rig.pouring.is_interrupted
    with pytest.raises(MotionError, match="gripper is closed"):
        rig.pouring.plan()
    known = rig.pouring.take_up()
    assert known.startswith("The arm is on the path of run 0")
    assert f"Stopped during '{move}'" in known
    rig.pouring.back_off(rig.pouring.plan_back_off())
    assert rig.is_home
    assert not rig.arm.gripper.is_closed
    pours(rig)


def test_a_run_of_another_object_is_no_way_back(rig):
    stopped_in(rig, "carry")
    rig.arm.robot.recover()
    settings, target = rig.settings, a_target(rig.settings)
    taller = target.object_aabb_m + np.array([[0, 0, 0], [0, 0, 0.1]])
    other = Pouring(
        rig.arm, pour_cell(settings), type(target)(**{**vars(target), "object_aabb_m": taller}),
        rig.session, rig.reporter,
    )  # fmt: skip
    assert other.take_up() == ""
    rig.pouring.back_off(rig.pouring.plan_back_off())


@pytest.mark.parametrize(
    ("move", "jump", "said"),
    [
        ("carry", "jump 3 0.2", "degrees off its planned path; take the cup out"),
        ("pour", "jump 2 -0.03", r"not clear: .* cup and object would touch\. Take the cup out"),
    ],
)
def test_an_arm_that_was_pushed_off_its_path_lets_go_where_it_is_and_plans_from_there(rig, move, jump, said):
    stopped_in(rig, move)
    rig.pouring.recover()
    rig.controller.command(jump)
    wait_until(lambda: rig.arm.robot.stopped_by() is not None)
    with pytest.raises(MotionError, match=said):
        rig.pouring.plan_back_off()
    rig.pouring.recover()  # the driver had noticed, too
    rig.pouring.give_up_way_back()
    assert not rig.arm.gripper.is_closed
    events = PourRun.load(rig.pouring.last_run).events
    assert events[-1]["kind"] == "gripper"
    pours(rig)


def test_an_arm_beside_its_path_joins_it_if_that_is_clear(rig):
    stopped_in(rig, "carry")
    rig.pouring.recover()
    rig.controller.command("jump 4 0.05")
    wait_until(lambda: rig.arm.robot.stopped_by() is not None)
    rig.pouring.recover()
    moves = rig.pouring.plan_back_off()
    assert moves[0].name == "back on the way"
    rig.pouring.back_off(moves)
    assert rig.is_home
    pours(rig)


@pytest.mark.parametrize("move", ["carry", "pour"])  # a shorter one may be over when the jump comes
@pytest.mark.parametrize("angle_rad", [0.03, -0.03])
def test_a_jump_that_the_cups_clearance_does_not_allow_is_noticed(rig, move, angle_rad):
    thread = rig.pour_until(move, 0.4)
    with within(STOPPED_WITHIN_S + 0.2, "the arm stands, and it is said"):
        rig.controller.command(f"jump 2 {angle_rad}")
        thread.join(HANG_S)
    assert isinstance(thread.error, TrackingLost), repr(thread.error)
    assert "mm" in str(thread.error)
    rig.pouring.recover()
    if cup_gap_m(rig) > 0:
        rig.pouring.back_off(rig.pouring.plan_back_off())
    else:  # the driver pulled it back to its path, and it came to rest on the path's other side
        with pytest.raises(MotionError, match=r"would touch\. Take the cup out"):
            rig.pouring.plan_back_off()
        rig.pouring.give_up_way_back()
        pours(rig)
    assert rig.is_home


def test_margins_are_a_share_of_each_moves_own_clearance(rig):
    plan = rig.pouring.plan().plan
    cell = pour_cell(rig.settings)
    margins = plan_margins(cell, a_target(rig.settings), plan)
    least_m = min(plan.clearance_m, plan.cup_clearance_m)
    allowed_m = min(margin.path.allowed_m for margin in margins.values())
    assert allowed_m == pytest.approx(SHARE_OF_CLEARANCE * least_m)
    assert max(margin.path.allowed_m for margin in margins.values()) > allowed_m
    assert (margins["carry"].path.levers_m > 0).all()


def test_kinematics_beyond_the_plans_clearance_are_refused_before_anything_moves(rig):
    rig.controller.command("calibration 4.5")
    try:
        rig.arm.robot.recover()  # within the 5 mm by which it is taken for the right arm
        fresh = rig.pouring.plan()
        with pytest.raises(MotionError, match=r"the plan's clearance leaves \d\.\d mm"):
            rig.pouring.carry_out(fresh)
        assert rig.is_home
    finally:
        rig.controller.command("calibration 0")
    rig.controller.command("calibration 1")
    try:
        pours(rig)
    finally:
        rig.controller.command("calibration 0")


def test_something_that_pushes_at_the_cup_stops_the_arm(rig):
    thread = rig.pour_until("carry", 0.4)
    with within(STOPPED_WITHIN_S + 0.2):
        rig.controller.command("force 80")
        thread.join(HANG_S)
    rig.controller.command("force 0")
    assert type(thread.error) is RobotStopped
    assert "80 N" in str(thread.error)
    rig.pouring.recover()
    rig.pouring.back_off(rig.pouring.plan_back_off())
    assert rig.is_home


def test_a_plan_beyond_the_safety_limits_is_refused_before_anything_moves(rig):
    fresh = rig.pouring.plan()
    lifted = fresh.plan.moves[3].trajectory.joints_rad[:, 0]
    home = rig.settings.robot.home_rad[0]
    low, high = min(home, lifted.min()) - 1, (home + lifted.max()) / 2
    rig.controller.command(f"limit 1 {low} {max(high, home + 0.01)}")
    try:
        if lifted.max() <= max(high, home + 0.01):
            rig.controller.command(f"limit 1 {max(home - 0.01, lifted.min() + 0.01)} {home + 9}")
        with pytest.raises(MoveRefused, match="safety limits"):
            rig.pouring.carry_out(fresh)
        assert rig.is_home
        with pytest.raises(MoveRefused, match="safety limits"):
            rig.pouring.plan()
        rig.pouring.recover()  # what is configured is read on connecting
        with pytest.raises(MoveRefused, match=r"the base joint would be at -?\d+ degrees"):
            rig.pouring.plan()
    finally:
        rig.controller.command("no limits")
    rig.pouring.recover()
    pours(rig)


def test_a_way_back_that_the_controller_does_not_allow_is_refused_before_it_is_confirmed(rig):
    stopped_in(rig, "carry")
    here, station = rig.joints_rad[0], rig.pouring.interrupted_plan.moves[0].trajectory.end_rad[0]
    halfway = (here + station) / 2
    low, high = (halfway, here + 1) if station < here else (here - 1, halfway)
    rig.controller.command(f"limit 1 {low} {high}")
    try:
        rig.pouring.recover()  # what is configured is read on connecting
        with pytest.raises(MoveRefused, match=r"the base joint would be at -?\d+ degrees"):
            rig.pouring.plan_back_off()
        rig.controller.command("no limits")
        rig.controller.command("slider 0")
        rig.pouring.recover()
        wait_until(lambda: rig.arm.robot.state().speed_scaling == 0)
        with pytest.raises(RobotNotReady, match="speed slider is at 0"):
            rig.pouring.plan_back_off()
    finally:
        rig.controller.command("no limits")
        rig.controller.command("slider 1")
    wait_until(lambda: rig.arm.robot.state().speed_scaling == 1)
    rig.pouring.back_off(rig.pouring.plan_back_off())
    assert rig.is_home


def test_every_step_of_a_recovery_is_in_the_log(rig):
    thread = rig.pour_until("carry", 0.5)
    rig.controller.command("safety fault")
    thread.join(HANG_S)
    with pytest.raises(RobotError):
        rig.pouring.recover()
    step, _ = rig.arm.robot.pending_step()
    rig.pouring.take_step(step)
    rig.pouring.recover()
    events = PourRun.load(rig.pouring.last_run).events
    assert [event["kind"] for event in events[-4:]] == ["stopped", "not ready", "step", "recovered"]
    assert events[-2]["step"] == "RESTART_SAFETY"
    rig.pouring.back_off(rig.pouring.plan_back_off())
    assert rig.is_home


@pytest.mark.parametrize(
    ("line", "refused"),
    [
        ("slider 0", "speed slider is at 0, .* raise it at the panel"),
        ("fastest 1 0.1", r"the base joint would turn at .* allows 0\.10"),
    ],
)
def test_what_the_controller_does_not_allow_is_said_before_anything_is_confirmed(rig, line, refused):
    rig.controller.command(line)
    try:
        rig.pouring.recover()  # what is configured is read on connecting
        wait_until(lambda: (rig.arm.robot.state().speed_scaling == 0) == (line == "slider 0"))
        with pytest.raises(RobotError, match=refused):
            rig.pouring.plan()
    finally:
        rig.controller.command("slider 1")
        rig.controller.command("no limits")
    rig.pouring.recover()
    assert rig.pouring.plan() is not None


@pytest.mark.parametrize(
    ("line", "back", "said"), [("slider 0.5", "slider 1", "at 50%"), ("reduced", "normal", "reduced mode")]
)
def test_what_makes_the_arm_slow_is_said_before_anything_is_confirmed(rig, line, back, said):
    warned = []
    rig.reporter.warn = warned.append
    rig.controller.command(line)
    try:
        wait_until(lambda: slowness(rig.arm.robot.state()))
        fresh = rig.pouring.plan()
        assert [said in sentence for sentence in warned] == [True]
        rig.pouring.carry_out(fresh)
    finally:
        rig.controller.command(back)
        wait_until(lambda: not slowness(rig.arm.robot.state()))
    assert len(warned) == 1, "once"


def test_the_controller_is_told_what_the_cup_weighs(tmp_path, monkeypatch):
    def with_cup(speed_up: float, version: str) -> CellSettings:
        settings = quick_cell(speed_up, version)
        return settings.model_copy(update={"gripper": settings.gripper.model_copy(update={"cup_kg": 0.3})})

    monkeypatch.setattr("tests.hardware.pouring.rig.quick_cell", with_cup)
    with Rig(tmp_path, SPEED_UP) as rig:

        def payload_kg():
            return json.loads(rig.controller.command("state"))["payload_kg"]

        assert payload_kg() == pytest.approx(0.9)
        stopped_in(rig, "carry")
        assert payload_kg() == pytest.approx(1.2)
        rig.pouring.recover()
        assert payload_kg() == pytest.approx(1.2), "the cup is still there"
        rig.pouring.back_off(rig.pouring.plan_back_off())
        assert payload_kg() == pytest.approx(0.9)
