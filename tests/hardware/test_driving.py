"""What is said of an arm that was seen beside its path."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest

from core.motion.trajectory import JointTrajectory
from core.progress import Reporter
from hardware.cell import read_cell
from hardware.cell.settings import ARMS
from hardware.driving import WatchedArm
from hardware.errors import ProgramStopped, RobotError, RobotNotReady, RobotStopped, TrackingLost
from hardware.interfaces import Kinematics
from hardware.modes import RobotMode
from hardware.robots.kinematic import KinematicRobot

ROBOT = read_cell().robot
HOME = np.array(ROBOT.home_rad)
BESIDE_RAD = HOME + np.array([0.0, 0.1, 0.0, 0.0, 0.0, 0.0])
PATH = JointTrajectory(np.array([0.0, 1.0]), np.array([HOME, HOME + 0.2]))


class Braking:
    """An arm 0.1 rad beside its path; its controller says why only some states after it was stopped."""

    name = "braking arm"
    progress = 0.5
    is_done = False

    def __init__(self, mode: RobotMode, ended: RobotError) -> None:
        self._mode, self._ended = mode, ended
        self._seen = KinematicRobot(Kinematics(ARMS[ROBOT.model]), BESIDE_RAD, is_instant=True).state()
        self._states_at_rest = 0
        self.is_stopped = False

    def follow(self, *_):
        return self

    def stop(self):
        self.is_stopped = True

    def wait(self, timeout_s):
        raise self._ended

    def state(self):
        self._states_at_rest += self.is_stopped
        mode = self._mode if self._states_at_rest > 5 else RobotMode.RUNNING
        return replace(self._seen, robot_mode=mode, time_s=time.monotonic())


class NoLog:
    def state(self, move, state):
        pass


@pytest.mark.parametrize(
    ("mode", "ended", "kind"),
    [
        (RobotMode.POWER_OFF, RobotStopped("By us."), RobotNotReady),
        (RobotMode.RUNNING, ProgramStopped("At its panel."), ProgramStopped),
        (RobotMode.RUNNING, RobotStopped("By us."), TrackingLost),
    ],
)
def test_an_arm_beside_its_path_is_stopped_and_the_gravest_reason_is_said(mode, ended, kind):
    robot = Braking(mode, ended)
    with pytest.raises(RobotError) as said:
        WatchedArm(robot, NoLog(), Reporter()).follow(PATH, "pour", "Pour")
    assert type(said.value) is kind
    assert robot.is_stopped
