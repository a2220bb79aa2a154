"""What comes next, by how everything stands."""

from __future__ import annotations

import pytest

from app.gui.pages.robot.steps import Doing, Situation, Step
from app.jobs.arm_news import ArmStatus

READY = ArmStatus(None, False, "")
STOPPED = ArmStatus(None, True, "It was stopped.", must_back_off=True)
ON_ITS_WAY = ArmStatus(None, True, "", must_back_off=True)


def step(doing=Doing.NOTHING, status=READY, **facts):
    standing = {
        "is_connected": status is not None,
        "is_possible": True,
        "has_plan": False,
        "has_way": False,
        "has_run": False,
    }
    return Situation(doing, status, **(standing | facts)).step


@pytest.mark.parametrize(
    ("facts", "expected"),
    [
        ({"is_possible": False}, Step.EMPTY),
        ({"status": None}, Step.CONNECT),
        ({"is_connected": False}, Step.CONNECT),
        ({}, Step.PLAN),
        ({"has_plan": True}, Step.CHECK),
        ({"doing": Doing.POURING, "has_plan": True}, Step.POUR),
        ({"has_run": True}, Step.OUTCOME),
        ({"status": STOPPED}, Step.STOPPED),
        ({"status": ON_ITS_WAY}, Step.WAY_BACK),
        ({"status": ON_ITS_WAY, "has_way": True}, Step.BACK),
        ({"status": ON_ITS_WAY, "doing": Doing.BACKING}, Step.BACKING),
    ],
)
def test_the_next_step(facts, expected):
    assert step(**facts) is expected


def test_coming_back_after_a_stop_comes_before_anything_else():
    everything = {"has_plan": True, "has_run": True, "is_possible": False, "is_connected": False}
    assert step(status=STOPPED, **everything) is Step.STOPPED
    assert step(status=ON_ITS_WAY, **everything) is Step.WAY_BACK


def test_a_stopped_arm_on_its_way_has_no_way_before_it_is_ready():
    assert step(status=STOPPED, has_way=True) is Step.STOPPED
