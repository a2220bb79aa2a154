"""A real arm between and at the views of a scan, with the real driver over TCP: watched at every moment."""

from __future__ import annotations

import json

import numpy as np
import pytest

from core.errors import MotionError
from core.progress import Reporter
from hardware.errors import RobotError
from hardware.pouring.run_log import RunLog
from hardware.scanning.moving import WatchedMoving
from hardware.scanning.views import name_views
from tests.hardware.pouring.rig import Rig
from tests.patience import wait_until

pytestmark = [pytest.mark.system, pytest.mark.punctual]

pytest.importorskip("rtde_control")


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    with Rig(tmp_path_factory.mktemp("session"), 2.0) as rig:
        yield rig


@pytest.fixture
def moving(rig, tmp_path):
    with RunLog(tmp_path / "scan") as log:
        yield WatchedMoving(rig.arm, log, rig.reporter, lambda _: "confirmed")


@pytest.mark.parametrize("fault", ["foreign moving", "protective stop", "jump 1 0.03"])
def test_an_arm_that_is_stopped_at_a_view_is_no_view_and_recovers(rig, moving, tmp_path, fault):
    view, home = name_views((rig.settings.scan.views_rad[0], rig.settings.robot.home_rad))
    moving.prepare([view])
    moving.go(view)
    moving.refuse_stopped()
    assert not moving.was_stopped
    before = rig.joints_rad
    rig.controller.command(fault)
    wait_until(lambda: rig.arm.robot.stopped_by() is not None)
    with pytest.raises(RobotError, match="recover"):
        moving.refuse_stopped()
    assert moving.was_stopped
    wait_until(lambda: json.loads(rig.controller.command("state"))["is_moving"] is False)
    assert np.abs(rig.joints_rad - before).max() < 0.06
    events = [json.loads(line) for line in (tmp_path / "scan" / "events.jsonl").open()]
    assert [event["kind"] for event in events] == ["planned", "confirmed", "move", "stopped"]
    rig.arm.robot.recover()
    moving.prepare([home])
    moving.go(home)
    assert rig.is_home


def test_what_makes_the_arm_slow_on_its_way_is_said_once(rig, tmp_path):
    class Listening(Reporter):
        said: tuple[str, ...] = ()

        def warn(self, sentence):
            self.said += (sentence,)

    reporter = Listening()
    view, home = name_views((rig.settings.scan.views_rad[0], rig.settings.robot.home_rad))
    with RunLog(tmp_path / "scan") as log:
        moving = WatchedMoving(rig.arm, log, reporter, lambda _: "confirmed")
        moving.prepare([view, home])
        moving.go(view)
        assert reporter.said == ()
        rig.controller.command("when moving in 0.2 slider 0.6")
        moving.go(home)
        rig.controller.command("slider 1")
        assert len(reporter.said) == 1
        assert "slider is at 60%" in reporter.said[0]
        rig.controller.command("reduced")
        moving.prepare([view, home])
        moving.go(view)
        moving.go(home)
        rig.controller.command("normal")
    assert len(reporter.said) == 2
    assert "reduced mode" in reporter.said[1]


def test_views_beyond_the_safety_limits_are_refused_before_anything_moves(rig, moving):
    (view,) = name_views((rig.settings.scan.views_rad[0],))
    home = rig.settings.robot.home_rad[0]
    rig.controller.command(f"limit 1 {home - 0.1} {home + 0.1}")
    try:
        with pytest.raises(RobotError, match="safety limits"):
            moving.prepare([view])
        assert rig.is_home
    finally:
        rig.controller.command("no limits")


def test_no_view_is_gone_to_with_a_cup_in_the_hand(rig, tmp_path):
    view = name_views(rig.settings.scan.views_rad[:1])
    rig.arm.gripper.close()
    with RunLog(tmp_path / "scan") as log:
        moving = WatchedMoving(
            rig.arm, log, rig.reporter, lambda _: pytest.fail("nothing is to be confirmed")
        )
        with pytest.raises(MotionError, match="may hold a cup; nothing moved"):
            moving.prepare(view)
        rig.arm.gripper.open()
    assert (tmp_path / "scan" / "events.jsonl").read_text() == ""
