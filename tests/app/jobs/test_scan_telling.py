"""What is told of a scan's arm and of its growing mesh, without a process around it."""

from __future__ import annotations

import time

import numpy as np
import pytest

from app.jobs.arm_news import ArmConnected, ArmGone, ArmStatus
from app.jobs.scan_news import MeshGrown, ViewDone, ViewsPlanned
from app.jobs.scan_telling import ScanTelling
from core.mesh import TriangleMesh
from core.resources import RESOURCES
from core.scan.model import RgbdFrame
from hardware.cell import open_cell, read_cell
from hardware.errors import RobotLost
from hardware.scanning.views import PlannedView, ViewRecord, ViewState
from hardware.simulation.world import World


@pytest.fixture
def cell():
    settings = read_cell()
    return open_cell(settings, World(None, np.array([0.0, -0.35, 0.0])))


def test_a_real_arm_is_told_with_the_address_that_takes_a_stop(cell):
    told = []
    real = read_cell(RESOURCES / "cells" / "ur5_example.toml")
    with cell, ScanTelling(told.append, real).arm(cell):
        time.sleep(0.25)
    connected, *statuses, gone = told
    assert connected == ArmConnected(cell.robot.name, real.robot.address, is_simulated=False)
    assert [type(one) for one in statuses] == [ArmStatus] * len(statuses)
    assert 3 <= len(statuses) <= 5
    assert statuses[0].is_gripper_closed is False
    assert gone == ArmGone()


def test_an_arm_that_does_not_answer_is_told_in_a_sentence(cell):
    told = []
    with cell:
        cell.robot.state = lost
        with ScanTelling(told.append, cell.settings).arm(cell):
            time.sleep(0.05)
    assert told[1] == ArmStatus(None, None, "The arm does not answer; look at its cable.")


def lost():
    raise RobotLost("The arm does not answer; look at its cable.")


class SlowVolume:
    """Its mesh takes a while."""

    n_meshes = 0

    def mesh(self):
        self.n_meshes += 1
        time.sleep(0.02)
        return TriangleMesh(np.zeros((3, 3)), np.array([[0, 1, 2]]))


def test_a_mesh_that_takes_its_time_is_not_told_after_each_view(cell):
    told, volume = [], SlowVolume()
    telling = ScanTelling(told.append, cell.settings)
    records = [
        ViewRecord(PlannedView(f"frame-{k:06d}", cell.settings.robot.home_rad), ViewState.TAKEN)
        for k in range(5)
    ]
    telling.planned(records, volume)
    frame = RgbdFrame("", np.zeros((2, 2, 3), np.uint8), np.zeros((2, 2), np.float32), np.eye(4))
    for record in records:
        telling.taken(record, frame, volume)
    assert [type(one) for one in told] == [ViewsPlanned, MeshGrown] + [ViewDone] * 5
    time.sleep(0.35)
    telling.taken(records[0], frame, volume)
    assert volume.n_meshes == 2
    assert told[-1].vertices_m.dtype == np.float32
    assert told[-1].faces.dtype == np.int32
