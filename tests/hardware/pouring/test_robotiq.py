"""A pour with a gripper that tells what it holds: nothing is lifted that it does not hold, or carried on."""

from __future__ import annotations

import pytest

from core.session.pour_runs import PourRun
from hardware.errors import ObjectLost
from tests.hardware.pouring.rig import Rig
from tests.patience import HANG_S

pytestmark = [pytest.mark.system, pytest.mark.punctual]

pytest.importorskip("rtde_control")


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    with Rig(tmp_path_factory.mktemp("session"), speed_up=3.0, robotiq="2F-85") as rig:
        yield rig


def pours(rig):
    rig.controller.command("hand full")
    assert PourRun.load(rig.pouring.carry_out(rig.pouring.plan())).is_done
    assert rig.is_home


def comes_back(rig):
    """Without a cup: the hand holds none."""
    rig.pouring.recover()
    back = rig.pouring.plan_back_off()
    assert not any(move.holds_cup for move in back)
    rig.pouring.back_off(back)
    assert rig.is_home


def moves(rig):
    events = PourRun.load(rig.pouring.last_run).events
    return [event["name"] for event in events if event["kind"] == "move"]


def test_a_pick_that_holds_nothing_is_noticed_before_the_cup_is_lifted(rig):
    rig.controller.command("hand empty")
    with pytest.raises(ObjectLost, match="closed and holds nothing, so the cup is not lifted"):
        rig.pouring.carry_out(rig.pouring.plan())
    assert moves(rig)[-1] == "grasp"
    comes_back(rig)
    pours(rig)


def test_a_cup_that_is_lost_in_the_carry_stops_the_arm(rig):
    rig.controller.command("hand full")
    thread = rig.pour_until("carry", 0.5)
    rig.controller.command("hand empty")
    thread.join(HANG_S)
    assert isinstance(thread.error, ObjectLost), repr(thread.error)
    assert moves(rig)[-1] == "carry"
    assert not rig.is_moving
    comes_back(rig)
    pours(rig)
