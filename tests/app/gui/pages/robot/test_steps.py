"""What comes next, by how everything stands."""

from __future__ import annotations

import pytest

from app.gui.pages.robot.steps import Activity, Situation, Step
from app.jobs.arm_events import ArmStatus
from core.motion.pour.plan import Segment

READY = ArmStatus(None, False, "")
STOPPED = ArmStatus(None, True, "It was stopped.", stopped_in=Segment.CARRY)
ON_ITS_WAY = ArmStatus(None, True, "", stopped_in=Segment.CARRY)


def step(activity=Activity.NONE, status=READY, **facts):
    standing = {
        "is_connected": status is not None,
        "can_pour": True,
        "has_plan": False,
        "has_back_off": False,
        "has_run": False,
    }
    return Situation(activity, status, **(standing | facts)).step


@pytest.mark.parametrize(
    ("facts", "expected"),
    [
        ({"can_pour": False}, Step.EMPTY),
        ({"status": None}, Step.CONNECT),
        ({"is_connected": False}, Step.CONNECT),
        ({}, Step.PLAN),
        ({"has_plan": True}, Step.CHECK),
        ({"activity": Activity.POURING, "has_plan": True}, Step.POUR),
        ({"has_run": True}, Step.OUTCOME),
        ({"status": STOPPED}, Step.STOPPED),
        ({"status": ON_ITS_WAY}, Step.PLAN_BACK_OFF),
        ({"status": ON_ITS_WAY, "has_back_off": True}, Step.CHECK_BACK_OFF),
        ({"status": ON_ITS_WAY, "activity": Activity.BACKING_OFF}, Step.BACK_OFF),
    ],
)
def test_the_next_step(facts, expected):
    assert step(**facts) is expected


def test_coming_back_after_a_stop_comes_before_anything_else():
    everything = {"has_plan": True, "has_run": True, "can_pour": False, "is_connected": False}
    assert step(status=STOPPED, **everything) is Step.STOPPED
    assert step(status=ON_ITS_WAY, **everything) is Step.PLAN_BACK_OFF


def test_a_stopped_arm_on_its_way_has_no_way_before_it_is_ready():
    assert step(status=STOPPED, has_back_off=True) is Step.STOPPED
