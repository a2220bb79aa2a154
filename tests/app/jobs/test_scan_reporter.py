"""What is published of a scan's arm and of its growing mesh, without a process around it."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from app.jobs.arm_events import ArmConnected, ArmDisconnected, ArmStatus
from app.jobs.scan_events import MeshGrown, ViewDone, ViewsPlanned
from app.jobs.scan_work import ScanReporter
from core.mesh import TriangleMesh
from core.resources import RESOURCES
from core.scan.model import RgbdFrame
from hardware.cell import open_cell, read_cell
from hardware.errors import RobotLost
from hardware.scanning.views import PlannedView, ViewRecord, ViewState
from hardware.simulation.world import World
from tests.patience import wait_until


@pytest.fixture
def cell():
    settings = read_cell()
    return open_cell(settings, World(None, np.array([0.0, -0.35, 0.0])))


def test_a_real_arm_is_published_with_the_address_that_takes_a_stop(cell):
    published = []
    real = read_cell(RESOURCES / "cells" / "ur5_example.toml")
    with cell, ScanReporter(published.append, real).arm(cell):
        wait_until(lambda: len(published) > 3)
    connected, *statuses, gone = published
    assert connected == ArmConnected(cell.robot.name, real.robot.address, is_simulated=False)
    assert [type(one) for one in statuses] == [ArmStatus] * len(statuses)
    assert len(statuses) >= 3
    assert statuses[0].is_gripper_closed is False
    assert gone == ArmDisconnected()


def test_an_arm_that_does_not_answer_is_published_in_a_sentence(cell):
    published = []
    with cell:
        cell.robot.state = lost
        with ScanReporter(published.append, cell.settings).arm(cell):
            wait_until(lambda: len(published) > 1)
    assert published[1] == ArmStatus(None, None, "The arm does not answer; look at its cable.")


def lost():
    raise RobotLost("The arm does not answer; look at its cable.")


class SlowVolume:
    """Its mesh takes a while by a clock that a test sets."""

    n_meshes = 0
    now_s = 100.0

    def mesh(self):
        self.n_meshes += 1
        self.now_s += 0.02
        return TriangleMesh(np.zeros((3, 3)), np.array([[0, 1, 2]]))


def test_a_mesh_that_takes_its_time_is_not_published_after_each_view(cell, monkeypatch):
    published, volume = [], SlowVolume()
    clock = SimpleNamespace(monotonic=lambda: volume.now_s)
    monkeypatch.setattr("app.jobs.scan_work.time", clock)
    scan = ScanReporter(published.append, cell.settings)
    records = [
        ViewRecord(PlannedView(f"frame-{k:06d}", cell.settings.robot.home_rad), ViewState.TAKEN)
        for k in range(5)
    ]
    scan.planned(records, volume)
    frame = RgbdFrame("", np.zeros((2, 2, 3), np.uint8), np.zeros((2, 2), np.float32), np.eye(4))
    for record in records:
        scan.taken(record, frame, volume)
    assert [type(one) for one in published] == [ViewsPlanned, MeshGrown] + [ViewDone] * 5
    volume.now_s += 0.35
    scan.taken(records[0], frame, volume)
    assert volume.n_meshes == 2
    assert published[-1].vertices_m.dtype == np.float32
    assert published[-1].faces.dtype == np.int32
