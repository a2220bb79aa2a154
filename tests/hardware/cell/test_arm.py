"""The arm without a camera: the simulated one is the real driver with a simulated controller."""

from __future__ import annotations

import time
from itertools import islice

import numpy as np
import psutil
import pytest

from core.errors import InputError
from core.motion.kinematics import flange_pose
from core.motion.trajectory import JointTrajectory
from hardware.cell import SIMULATED_CELL, CellSettings, open_arm, read_cell
from hardware.cell.examination import Finding, examine_cell, examine_gripper
from hardware.cell.settings import ARMS
from hardware.errors import RobotUnreachable
from hardware.robots.ur.robot import UR5Robot
from hardware.simulation.ur_controller.process import ControllerProcess
from tests.patience import HANG_S

pytestmark = [pytest.mark.system, pytest.mark.punctual]

SETTINGS = read_cell()
REAL = read_cell(SIMULATED_CELL.with_name("ur5_example.toml"))
HOME = np.array(SETTINGS.robot.home_rad)


def simulated(speed_up: float, version: str, model: str = "UR5") -> CellSettings:
    return SETTINGS.model_copy(
        update={
            "simulation": SETTINGS.simulation.model_copy(
                update={"speed_up": speed_up, "controller_version": version}
            ),
            "robot": SETTINGS.robot.model_copy(update={"model": model}),
        }
    )


def real_at(address: str, model: str = "UR5") -> CellSettings:
    robot = REAL.robot.model_copy(update={"address": address, "model": model})
    return REAL.model_copy(update={"robot": robot})


def processes() -> set[int]:
    """Our children; the one that Python keeps for shared memory stays."""
    children = psutil.Process().children(recursive=True)
    return {child.pid for child in children if "resource_tracker" not in " ".join(child.cmdline())}


@pytest.mark.parametrize(
    ("speed_up", "version", "model"), [(1.0, "3.15", "UR5"), (10.0, "3.15", "UR5"), (10.0, "5.11", "UR5e")]
)
def test_the_simulated_arm_moves_and_grips_as_fast_as_wanted(
    speed_up: float, version: str, model: str
) -> None:
    settings = simulated(speed_up, version, model)
    before = processes()
    times_s = np.arange(0, 2.001, 0.008)
    share = (1 - np.cos(np.pi * times_s / times_s[-1])) / 2
    way = JointTrajectory(times_s, HOME + np.outer(share, np.full(6, 0.3)))
    with open_arm(settings) as arm:
        assert isinstance(arm.robot, UR5Robot)
        assert arm.robot.name == f"simulated {model}"
        state = arm.robot.state()
        np.testing.assert_allclose(state.joints_rad, HOME, atol=1e-9)
        expected = flange_pose(ARMS[model], HOME) @ settings.gripper.grasp_pose
        np.testing.assert_allclose(state.T_base_tool, expected, atol=1e-6)
        began_s = time.monotonic()
        arm.robot.follow(way).wait(HANG_S)
        took_s = time.monotonic() - began_s
        np.testing.assert_allclose(arm.robot.state().joints_rad, way.end_rad, atol=1e-3)
        arm.gripper.close()
        assert arm.gripper.is_closed
    if speed_up == 1:
        assert took_s > way.duration_s
    else:
        assert took_s < way.duration_s, "a clock that runs faster needs nothing special"
    assert processes() == before


def test_it_may_begin_elsewhere_and_be_entered_again() -> None:
    joints = HOME + 0.2
    arm = open_arm(simulated(4.0, "3.15"), joints)
    for _ in range(2):
        with arm:
            np.testing.assert_allclose(arm.robot.state().joints_rad, joints, atol=1e-9)
            arm.robot.move_joints([joints, HOME], 1.0, 4.0).wait(HANG_S)


def test_the_real_arm_is_the_one_at_the_address() -> None:
    with ControllerProcess(joints_rad=HOME) as controller, open_arm(real_at(controller.address)) as arm:
        assert arm.controller is None
        assert arm.robot.name == f"UR5 at {controller.address}"
        arm.robot.move_joints([HOME, HOME + 0.1], 1.0, 4.0).wait(HANG_S)
        arm.gripper.close()
        assert '"tool_outputs": [true, false]' in controller.command("state")
    with pytest.raises(RobotUnreachable, match="Nobody answers"), open_arm(real_at("127.83.11.8")):
        pass


def test_a_recorded_scan_has_no_arm() -> None:
    replay = SETTINGS.robot.model_copy(update={"kind": "replay"})
    with pytest.raises(InputError, match="has no arm"):
        open_arm(SETTINGS.model_copy(update={"robot": replay}))


def robot_finding(settings: CellSettings) -> Finding:
    finding = list(islice(examine_cell(settings), 2))[1]
    assert finding.subject == "robot"
    return finding


def test_the_examination_connects_and_moves_nothing() -> None:
    with ControllerProcess(version="5.11", joints_rad=HOME) as controller:
        finding = robot_finding(real_at(controller.address))
        assert finding.problem is None
        assert finding.value.startswith(f"UR5 at {controller.address}, controller 5.11")
        assert ", serial number 20000000001, in remote control; " in finding.value
        assert "running, safety normal, its kinematics agree" in finding.value
        assert "calibrated kinematics read (checksum ffffffff-" in finding.value
        assert "joint limits read" in finding.value
        other = robot_finding(real_at(controller.address, "UR5e"))
        assert "not the UR5e of the cell file" in str(other.problem)
        controller.command("local")
        assert "choose remote control" in str(robot_finding(real_at(controller.address)).problem)
        assert str(HOME.tolist()) in controller.command("state")


def test_the_examination_says_that_nobody_answers() -> None:
    finding = robot_finding(real_at("127.83.11.9"))
    assert finding.value == "UR5 at 127.83.11.9"
    assert "Nobody answers" in str(finding.problem)
    assert "switch the controller on" in str(finding.problem)


def test_a_controller_that_tells_neither_number_nor_control_is_examined_all_the_same() -> None:
    with ControllerProcess(version="3.15", joints_rad=HOME) as controller:
        finding = robot_finding(real_at(controller.address))
        assert finding.problem is None
        assert "serial number" not in finding.value and "remote control" not in finding.value


def test_a_robotiq_gripper_is_examined_with_its_width_and_what_it_holds() -> None:
    with ControllerProcess(version="3.15", joints_rad=HOME, robotiq="2F-85") as controller:
        settings = real_at(controller.address)
        gripper = settings.gripper.model_copy(update={"kind": "robotiq", "model": "2F-85"})
        finding = examine_gripper(settings.model_copy(update={"gripper": gripper}))
        assert finding.value.endswith(" mm wide, holds nothing")
