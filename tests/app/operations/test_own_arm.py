"""A cell whose arm was exchanged since it was calibrated says so when the arm is tried or connected."""

from __future__ import annotations

import random

import numpy as np
import pytest

from app.operations.arm import connected
from app.operations.calibration.cell_file import new_cell, write_hand_eye
from app.operations.calibration.devices import examine_device
from core.errors import InputError
from core.motion.arm_models import UR5
from core.motion.kinematics import flange_pose
from core.progress import Reporter
from hardware.cell import open_arm, read_cell
from hardware.cell.own_arm import own_kinematics
from hardware.cell.scene import motion_scene, pour_cell
from hardware.simulation.ur_controller.process import ControllerProcess

pytest.importorskip("rtde_control")

pytestmark = [pytest.mark.system, pytest.mark.punctual]
VIEWS_RAD = np.array(read_cell().scan.views_rad)
SAID = "is not the one with which the real was calibrated"


class Warnings(Reporter):
    def __init__(self):
        super().__init__()
        self.said = []

    def warn(self, sentence):
        self.said.append(sentence)


def warned(path):
    reporter = Warnings()
    with connected(open_arm(read_cell(path)), None, reporter):
        return reporter.said


def test_an_arm_that_was_exchanged_since_the_calibration_is_warned_of(tmp_path, monkeypatch):
    monkeypatch.setenv("POURSIGHT_CELLS", str(tmp_path / "cells"))
    address = ".".join(["127", *(str(random.Random().randint(2, 250)) for _ in range(3))])
    path = new_cell("real", is_simulated=False, address=address)
    pose, home_rad = read_cell(path).camera.pose, list(read_cell(path).robot.home_rad)
    with ControllerProcess("UR5", "3.15", address, home_rad) as controller:
        assert warned(path) == [], "a cell that was written by hand knows no arm"
        known = own_kinematics(read_cell(path))
        checksum = known.checksum
        write_hand_eye(path, pose, known)
        assert read_cell(path).robot.kinematics_checksum == checksum
        assert read_cell(path).robot.arm == known.model
        assert warned(path) == []
        assert examine_device(path, "arm").problem is None
        controller.command("calibration 4.5")
        [sentence] = warned(path)
        assert SAID in sentence and checksum in sentence and "calibrate the cell again" in sentence
        assert SAID in examine_device(path, "arm").problem
        other = own_kinematics(read_cell(path))
        assert read_cell(path).robot.arm == known.model != other.model
        write_hand_eye(path, pose, other)
        assert warned(path) == []
        settings = read_cell(path)
        for arm in (settings.robot.arm, motion_scene(settings).arm, pour_cell(settings).arm):
            assert arm == other.model, "views and pours are judged by the arm's own kinematics"
    write_hand_eye(path, pose)
    robot = read_cell(path).robot
    assert robot.kinematics_checksum is None and robot.arm == UR5


def test_a_rehearsed_cells_arm_is_the_same_in_this_process_and_through_its_controller(tmp_path, monkeypatch):
    monkeypatch.setenv("POURSIGHT_CELLS", str(tmp_path / "cells"))
    path = new_cell("rehearsal", is_simulated=True, seed=5)
    told = own_kinematics(read_cell(path))
    apart_m = flange_pose(told.model, VIEWS_RAD)[:, :3, 3] - flange_pose(UR5, VIEWS_RAD)[:, :3, 3]
    assert 0.0005 < np.linalg.norm(apart_m, axis=1).mean() < 0.005
    write_hand_eye(path, read_cell(path).camera.pose, told)
    assert warned(path) == []
    with open_arm(read_cell(path)) as arm:
        assert arm.robot.kinematics == told
        state = arm.robot.state()
    np.testing.assert_allclose(state.T_base_flange, flange_pose(told.model, state.joints_rad), atol=1e-6)


def test_links_of_no_arm_are_refused_in_a_sentence(tmp_path, monkeypatch):
    monkeypatch.setenv("POURSIGHT_CELLS", str(tmp_path / "cells"))
    path = new_cell("rehearsal", is_simulated=True)
    path.write_text(path.read_text().replace("link_error_m = 0.0006", "link_error_m = 0.02"))
    with pytest.raises(InputError, match=r"lower the link errors of simulation\.set_up"):
        read_cell(path)
