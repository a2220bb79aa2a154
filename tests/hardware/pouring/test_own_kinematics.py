"""An arm that differs from the published one by more than it may is poured with, by its own kinematics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.errors import MotionError
from core.motion.arm_models import UR5
from core.motion.kinematics import flange_pose
from core.session.pour_runs import PourRun
from hardware.errors import WrongRobot
from hardware.pouring.run_log import driven_pivot_error_m
from hardware.robots.ur import primary_interface
from tests.hardware.pouring.rig import POURING, a_target

pytestmark = [pytest.mark.system, pytest.mark.punctual]

pytest.importorskip("rtde_control")

SPEED_UP = 2.0
WITHIN_M = 1e-3
NOBODYS_PORT = 30002


def connect_again(rig):
    rig.arm.robot.__exit__(None, None, None)
    rig.arm.robot.__enter__()


@pytest.mark.parametrize("off_mm", [4.5, 9.0])
def test_a_pour_by_the_arms_own_kinematics(rig, off_mm):
    rig.controller.command(f"calibration {off_mm}")
    try:
        connect_again(rig)
        fresh = rig.pouring.plan()
        folder = rig.pouring.carry_out(fresh)
        assert PourRun.load(folder).is_done
        assert rig.is_home
    finally:
        rig.controller.command("calibration 0")
        connect_again(rig)
    longer = replace(UR5, a_m=(0.0, UR5.a_m[1], UR5.a_m[2] - off_mm / 1000, 0.0, 0.0, 0.0))
    T_flange_cup = rig.settings.gripper.grasp_pose @ fresh.plan.T_grasp_cup
    cup, pivot_m = POURING.cup, a_target(rig.settings).pivot_m
    assert driven_pivot_error_m(folder, longer, T_flange_cup, cup, pivot_m) < WITHIN_M
    assert driven_pivot_error_m(folder, UR5, T_flange_cup, cup, pivot_m) > 0.8 * off_mm / 1000


def test_without_them_it_is_refused(rig, monkeypatch):
    monkeypatch.setattr(primary_interface, "PRIMARY_PORT", NOBODYS_PORT)
    rig.controller.command("calibration 4.5")
    try:
        connect_again(rig)
        assert "1 to 3 mm" in rig.arm.robot.kinematics.caution
        with pytest.raises(MotionError, match="its own calibration is read from its controller"):
            rig.pouring.carry_out(rig.pouring.plan())
        rig.controller.command("calibration 9")
        with pytest.raises(WrongRobot, match="puts the tool 9 mm"):
            connect_again(rig)
    finally:
        rig.controller.command("calibration 0")
        monkeypatch.undo()
        rig.arm.robot.__enter__()
    state = rig.arm.robot.state()
    np.testing.assert_allclose(state.T_base_flange, flange_pose(UR5, state.joints_rad), atol=1e-9)
