"""The real driver, connected to a simulated controller, and the controller's own word on its arm."""

from __future__ import annotations

import json
import socket
import time
from dataclasses import dataclass
from pathlib import Path
from threading import Event, Thread
from typing import Any

import numpy as np

from core.geometry import FloatArray, make_pose, rotation_x
from core.motion.arm_models import UR5, ArmModel
from core.motion.trajectory import JointTrajectory
from hardware.errors import RobotError
from hardware.robots.ur.link import UrMove
from hardware.robots.ur.robot import UR5Robot
from hardware.simulation.ur_controller.process import ControllerProcess
from tests.awake import AwakeClock
from tests.patience import HANG_S, wait_until

HOME = np.array([0.2, -1.6, 1.4, -1.5, -1.5, 0.1])
NEAR = HOME + np.array([0.2, -0.1, 0.1, 0.15, -0.1, 0.2])
FAR = HOME + np.array([1.5, 0.2, -0.2, 0.3, 0.2, -0.8])
SPEED, ACCELERATION = 1.0, 4.0
T_FLANGE_TOOL = make_pose(rotation_x(0.4), [0.01, -0.03, 0.15])
PAYLOAD_KG, PAYLOAD_CENTER_M = 1.2, (0.0, -0.02, 0.07)
STANDS_WITHIN_S = 0.5
USUAL_SLACK_NS = 50_000
VERSIONS = ["3.15", "5.11"]


def driver(address: str, arm: ArmModel = UR5, **options: Any) -> UR5Robot:
    return UR5Robot(arm, address, T_FLANGE_TOOL, PAYLOAD_KG, PAYLOAD_CENTER_M, **options)


def bent_way(duration_s: float = 1.2, end: FloatArray = NEAR) -> JointTrajectory:
    """From home, not straight, at rest at both ends."""
    times_s = np.arange(0, duration_s + 1e-9, 0.008)
    share = (1 - np.cos(np.pi * times_s / times_s[-1])) / 2
    bend = np.outer(np.sin(np.pi * share) ** 2, [0.1, 0.0, -0.1, 0.05, 0.0, 0.1])
    return JointTrajectory(times_s, HOME + np.outer(share, end - HOME) + bend)


def slack_ns(thread: int) -> int:
    """How much later than asked for the system may wake a thread."""
    return int(Path(f"/proc/{thread}/timerslack_ns").read_text())


def may_change_threads() -> bool:
    """As the kernel asks it: of another thread, also of one's own process."""
    is_over = Event()
    other = Thread(target=is_over.wait)
    other.start()
    try:
        Path(f"/proc/{other.native_id}/timerslack_ns").write_text(str(USUAL_SLACK_NS))
    except OSError:
        return False
    finally:
        is_over.set()
        other.join()
    return True


@dataclass
class Bench:
    """A controller, and the robot that is connected to it."""

    controller: ControllerProcess
    robot: UR5Robot

    def truth(self) -> dict[str, Any]:
        """What the controller itself says."""
        state: dict[str, Any] = json.loads(self.controller.command("state"))
        return state

    def worker(self) -> int:
        """The process that talks to the controller."""
        return self.robot._connected().worker.process_id

    def is_calm(self) -> bool:
        """Whether the arm has stood for so long that the two threads that receive look seldom."""
        tasks = Path(f"/proc/{self.worker()}/task").iterdir()
        return sum(slack_ns(int(task.name)) > 10 * USUAL_SLACK_NS for task in tasks) == 2

    def joints(self) -> FloatArray:
        return np.array(self.truth()["joints_rad"])

    def is_moving(self) -> bool:
        return bool(self.truth()["is_moving"])

    def begin(self, kind: str) -> UrMove:
        """Begin a long motion of a kind and return when it is well under way."""
        here = self.joints()
        if kind == "move_joints":
            move = self.robot.move_joints([here, here + (FAR - HOME)], SPEED, ACCELERATION)
        else:
            times_s = np.arange(0, 2.2, 0.008)
            share = (1 - np.cos(np.pi * times_s / times_s[-1])) / 2
            move = self.robot.follow(JointTrajectory(times_s, here + np.outer(share, FAR - HOME)))
        wait_until(lambda: np.abs(self.truth()["speeds_rad_s"]).max() > 0.5)
        return move

    def seconds_to_rest(self) -> float:
        """From now until the controller says that the arm stands."""
        with AwakeClock() as clock:
            began_s = clock.now_s()
            wait_until(lambda: not self.is_moving())
            return clock.now_s() - began_s

    def stays_where_it_is(self, for_s: float = 0.3) -> bool:
        before = self.joints()
        time.sleep(for_s)
        return bool(np.array_equal(before, self.joints()))

    def dashboard(self, *lines: str) -> None:
        """What a person does at the panel."""
        with socket.create_connection((self.controller.address, 29999), 2) as connection:
            for line in lines:
                connection.recv(500)
                connection.sendall(line.encode() + b"\n")
            connection.recv(500)

    def put_in_order(self) -> None:
        """Ready and at home, whatever the test before left behind."""
        for line in ("link restore", "emergency release", "unstick", "heed uploads", "remote", "slider 1"):
            self.controller.command(line)
        try:
            here = self.robot.state().joints_rad
            move = self.robot.move_joints([here, HOME], 3.0, 10.0)
        except RobotError:
            wait_until(lambda: not self.is_moving())
            self.robot.recover()
            move = self.robot.move_joints([self.joints(), HOME], 3.0, 10.0)
        move.wait(HANG_S)

    def works_again(self) -> None:
        """Recover, and see that nothing of the past goes on and that the next move arrives."""
        before = self.joints()
        self.robot.recover()
        assert self.stays_where_it_is(0.1)
        np.testing.assert_allclose(self.joints(), before, atol=1e-4)
        self.robot.move_joints([before, before - 0.1], SPEED, ACCELERATION).wait(HANG_S)
        np.testing.assert_allclose(self.joints(), before - 0.1, atol=1e-3)
