"""A calibration with the real driver over TCP, before a simulated camera: confirmed once, and paused."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from threading import Timer

import numpy as np
import pytest

from app.operations.calibration.capture import CaptureObserver
from app.operations.calibration.cell_file import new_cell
from app.operations.calibration.confirming import CONFIRMED_BEFORE
from app.operations.calibration.hand_eye import calibrate_cell
from app.operations.calibration.steps import enter_board
from core.calibration.board import BoardSpec
from core.calibration.rig import log_pose
from core.errors import Cancelled
from core.geometry import invert_pose
from core.motion.arm_models import UR5
from core.progress import Reporter
from hardware.cell import read_cell
from hardware.cell.own_arm import measured_in_simulation
from hardware.scanning.control import ScanControl
from hardware.scanning.moving import CONFIRMED
from hardware.simulation.ur_controller.process import ControllerProcess

pytestmark = [pytest.mark.system, pytest.mark.punctual]

pytest.importorskip("rtde_control")

N_VIEWS, SPEED_UP, PAUSE_S = 10, 6.0, 1.0
SEES_THE_BOARD = 4


@dataclass
class Operator:
    """Confirms everything, and remembers what."""

    is_present = True
    asked: list[str] = field(default_factory=list)
    refuses: bool = False

    def confirm_step(self, step, why):
        raise AssertionError(f"{why} {step}")

    def confirm_recovery(self, error, is_repeated):
        raise error

    def confirm_route(self, route, robot):
        self.asked.append(route.sentence)
        if self.refuses:
            raise Cancelled


@pytest.fixture
def cell(tmp_path, monkeypatch):
    """The file of a cell whose arm is driven over TCP while its camera and its board are simulated."""
    monkeypatch.setenv("POURSIGHT_CELLS", str(tmp_path / "cells"))
    path = new_cell("rehearsal", is_simulated=True, seed=1)
    settings = read_cell(path)
    first = settings.scan.views_rad[SEES_THE_BOARD]
    measured = measured_in_simulation(settings)
    with ControllerProcess(joints_rad=first, speed_up=SPEED_UP, measured=measured) as controller:
        text = path.read_text()
        real = f'kind = "ur5"\naddress = "{controller.address}"\nmodel'
        path.write_text("is_rehearsal = true\n" + text.replace('kind = "simulated"\nmodel', real))
        enter_board(path, BoardSpec(), "a4", 0.030)
        yield path


def events(folder):
    return [json.loads(line) for line in (folder / "motion/events.jsonl").open()]


def test_one_confirmation_is_for_all_rounds_and_a_pause_holds_the_arm(cell):
    operator, control, times_s = Operator(), ScanControl(), []

    def taken(look, n_usable, image):
        times_s.append(image.time_s)
        if len(times_s) == 3:
            control.pause()
            Timer(PAUSE_S, control.resume).start()

    observer = CaptureObserver(taken=taken, control=control)
    found = calibrate_cell(cell, Reporter(), operator, observer, N_VIEWS)
    settings = read_cell(cell)
    error = log_pose(invert_pose(settings.camera.pose) @ settings.true_camera_pose)
    assert np.linalg.norm(error[3:]) < 0.003
    assert settings.robot.arm == settings.simulation.set_up.own_arm(UR5) != UR5
    [question] = operator.asked
    assert f"Up to {N_VIEWS} views" in question and "is not asked about again" in question
    said = [event["sentence"] for event in events(found.folder) if event["kind"] == "confirmed"]
    assert said == [CONFIRMED, *[CONFIRMED_BEFORE] * (len(said) - 1)] and len(said) > 1
    assert times_s[3] - times_s[2] > PAUSE_S


def test_what_is_not_confirmed_does_not_move(cell):
    operator = Operator(refuses=True)
    with pytest.raises(Cancelled):
        calibrate_cell(cell, Reporter(), operator, n_views=N_VIEWS)
    [question] = operator.asked
    assert "The first: 3 views" in question
