"""Who is asked what while a cup is poured: with a pour that is stopped, and nothing that moves."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from app.cli.operators import PrintingOperator
from app.operations.pouring import pour_cup
from core.errors import Cancelled
from core.session.cups import Cup
from hardware.errors import RobotError

RUN = Path("0002")
CUP = Cup(1, 1, 20, None)


class StoppedOnce:
    """A pour that is stopped, recovers at the second attempt, backs off, and succeeds."""

    is_interrupted = False
    stops_on_the_way_back = 0
    robot = SimpleNamespace(pending_step=lambda: None)

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
        return ()

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
