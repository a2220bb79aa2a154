"""Who is asked what while a cup is poured: with a pour that is stopped, and nothing that moves."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from app.cli.operators import PrintingOperator
from app.operations.pouring import cell_to_pour_in, empty_hand, pour_cup
from core.errors import Cancelled, MotionError
from core.session.cups import Cup
from core.session.pour_runs import next_run_folder
from hardware.cell import read_cell
from hardware.cell.scene import pour_cell
from hardware.errors import MoveRefused, RobotError, RobotNotReady
from hardware.pouring.run_log import RunLog

RUN = Path("0002")
CUP = Cup(1, 1, 20, None)


class StoppedOnce:
    """A pour that is stopped, recovers at the second attempt, backs off, and succeeds."""

    is_interrupted = False
    stops_on_the_way_back = 0
    robot = SimpleNamespace(pending_step=lambda: None)
    gripper = "gripper"
    known = ""
    is_off_its_path = False
    no_way_back: RobotError | None = None

    def __init__(self, stopped_by: Exception, asked: list[str]) -> None:
        self._errors = [stopped_by]
        self._obstacles = [RobotError("The emergency stop is still pressed.")]
        self._asked = asked

    def plan(self):
        self._asked.append("plan")
        return SimpleNamespace(plan=None, target=SimpleNamespace(note=""))

    def carry_out(self, fresh):
        if self._errors:
            self.is_interrupted = True
            raise self._errors.pop()
        self._asked.append("pour")
        return RUN

    def recover(self):
        if self._obstacles:
            raise self._obstacles.pop()
        self._asked.append("recover")

    def plan_back_off(self):
        if self.is_off_its_path:
            raise MotionError("The arm is 12 degrees off its planned path.")
        error, self.no_way_back = self.no_way_back, None
        if error is not None:
            raise error
        return ()

    def take_up(self):
        self.is_interrupted = bool(self.known)
        return self.known

    def give_up_way_back(self):
        self.is_interrupted = False
        self._asked.append("let go")

    def back_off(self, moves):
        if self.stops_on_the_way_back:
            self.stops_on_the_way_back -= 1
            raise RobotError("A second protective stop.")
        self.is_interrupted = False
        self._asked.append("back off")


class Scripted:
    """Agrees to everything but what it refuses, and remembers what it was asked."""

    is_present = True

    def __init__(self, asked: list[str], refused: str = "") -> None:
        self._asked = asked
        self._refused = refused

    def confirm_pour(self, plan, note, robot, cup):
        self._answer("pour?")

    def confirm_recovery(self, error, is_repeated):
        self._answer("again?" if is_repeated else "recover?")

    def confirm_back_off(self, moves):
        self._answer("back off?")

    def is_cup_in_hand(self, known):
        self._asked.append("the cup?")
        return self._refused != "the cup?"

    def confirm_opening(self, gripper, known):
        self._answer("open?")

    def backed_off(self):
        self._asked.append("home")

    def _answer(self, question):
        self._asked.append(question)
        if question == self._refused:
            raise Cancelled("Not confirmed; nothing moved.")


@pytest.mark.parametrize("stopped_by", [RobotError("A protective stop."), Cancelled("Stopped on request.")])
def test_a_stopped_pour_is_recovered_step_by_step_and_planned_again(stopped_by):
    asked: list[str] = []
    assert pour_cup(StoppedOnce(stopped_by, asked), Scripted(asked), "UR5", CUP) == RUN
    recovery = ["recover?", "again?", "recover", "back off?", "back off", "home"]
    assert asked == ["plan", "pour?", *recovery, "plan", "pour?", "pour"]


@pytest.mark.parametrize("refused", ["pour?", "recover?", "again?", "back off?"])
def test_what_is_not_confirmed_does_not_happen(refused):
    asked: list[str] = []
    with pytest.raises(Cancelled):
        pour_cup(StoppedOnce(RobotError("A protective stop."), asked), Scripted(asked, refused), "UR5", CUP)
    assert asked[-1] == refused


def test_without_an_operator_a_stop_ends_it(monkeypatch):
    asked: list[str] = []
    monkeypatch.setattr(PrintingOperator, "confirm_pour", lambda *_: asked.append("shown"))
    with pytest.raises(RobotError, match="protective"):
        pour_cup(
            StoppedOnce(RobotError("A protective stop."), asked), PrintingOperator(Path("x")), "UR5", CUP
        )
    assert asked == ["plan", "shown"]


def test_a_stop_on_the_way_back_is_recovered_from_like_the_first():
    asked: list[str] = []
    stopped = StoppedOnce(RobotError("A protective stop."), asked)
    stopped.stops_on_the_way_back = 2
    assert pour_cup(stopped, Scripted(asked), "UR5", CUP) == RUN
    again = ["recover?", "recover", "back off?"]
    recovery = ["recover?", "again?", "recover", "back off?", *again, *again, "back off", "home"]
    assert asked == ["plan", "pour?", *recovery, "plan", "pour?", "pour"]


def test_an_arm_off_its_path_lets_go_where_it_is_and_the_next_plan_begins_there():
    asked: list[str] = []
    stopped = StoppedOnce(RobotError("A protective stop."), asked)
    stopped.is_off_its_path = True
    assert pour_cup(stopped, Scripted(asked), "UR5", CUP) == RUN
    recovery = ["recover?", "again?", "recover", "open?", "let go"]
    assert asked == ["plan", "pour?", *recovery, "plan", "pour?", "pour"]


@pytest.mark.parametrize(
    ("error", "follows"),
    [
        (
            RobotNotReady("The speed slider is at 0."),
            ["recover?", "recover", "back off?", "back off", "home"],
        ),
        (MoveRefused("The base joint would be at 90 degrees."), ["open?", "let go"]),
    ],
)
def test_an_arm_that_cannot_go_back_is_seen_to_and_one_that_may_not_lets_go(error, follows):
    asked: list[str] = []
    stopped = StoppedOnce(RobotError("A protective stop."), asked)
    stopped.no_way_back = error
    assert pour_cup(stopped, Scripted(asked), "UR5", CUP) == RUN
    recovery = ["recover?", "again?", "recover", *follows]
    assert asked == ["plan", "pour?", *recovery, "plan", "pour?", "pour"]


@pytest.mark.parametrize(
    ("known", "refused", "follows"),
    [
        ("The arm is on the path of run 0001.", "", ["the cup?", "back off?", "back off", "home"]),
        ("The arm is on the path of run 0001.", "the cup?", ["the cup?", "open?", "let go"]),
        ("", "", ["open?", "let go"]),
    ],
)
def test_a_hand_that_is_found_closed_is_emptied_as_the_operator_says(known, refused, follows):
    asked: list[str] = []
    found = StoppedOnce(RobotError(""), asked)
    found.known = known
    empty_hand(found, Scripted(asked, refused))
    assert asked == follows
    assert not found.is_interrupted


def test_a_closed_hand_stays_closed_if_that_is_not_confirmed():
    asked: list[str] = []
    with pytest.raises(Cancelled):
        empty_hand(StoppedOnce(RobotError(""), asked), Scripted(asked, "open?"))
    assert asked == ["open?"]


def test_a_real_arms_first_pour_in_a_session_is_slow_and_the_next_ones_are_not(tmp_path):
    said: list[str] = []
    reporter = SimpleNamespace(warn=said.append)
    real = read_cell()
    real = real.model_copy(update={"robot": real.robot.model_copy(update={"kind": "ur5"})})
    for settings, is_slow in ((real, True), (read_cell(), False)):
        cell = pour_cell(settings)
        limits = cell_to_pour_in(SimpleNamespace(settings=settings, cell=cell), tmp_path, reporter).limits
        share = cell.limits.first_pour_speed if is_slow else 1.0
        assert limits.tool_speed_m_s == share * cell.limits.tool_speed_m_s
        assert limits.joint_speed_rad_s == share * cell.limits.joint_speed_rad_s
        assert limits.pour_joint_speed_rad_s == cell.limits.pour_joint_speed_rad_s
    assert len(said) == 1
    assert "at 40%" in said[0]
    with RunLog(next_run_folder(tmp_path)) as log:
        log.event("confirmed", "The first.")
        log.event("done", "All moves were executed.")
    after = cell_to_pour_in(SimpleNamespace(settings=real, cell=pour_cell(real)), tmp_path, reporter)
    assert after.limits == pour_cell(real).limits
