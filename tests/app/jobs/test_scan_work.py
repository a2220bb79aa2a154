"""Scans in a host process: what is published and when, how they are paused, stopped, killed and continued."""

from __future__ import annotations

import os
import signal

import numpy as np
import pytest

from app.jobs.arm_events import ArmConnected, ArmDisconnected, ArmStatus, StopDone
from app.jobs.messages import Event, Failed, FailureKind, Finished, Progressed, Warned
from app.jobs.scan_events import MeshGrown, ScanQuestion, ViewDone, ViewsPlanned
from app.jobs.scan_work import ScanWork
from app.library.session_folder import UNFINISHED_SCAN
from app.operations.scan_run import ScanRequest
from app.operations.scanning import Proposal, scan_object
from app.operations.session import SessionTask, working_on
from core.parameters import Parameters
from core.progress import Reporter
from core.session import Session
from core.workers import WorkerPool
from hardware.cell import read_cell
from hardware.scanning.store import read_views
from hardware.simulation.ur_controller.process import ControllerProcess
from tests.app.jobs.hosts import ListenedHost
from tests.awake import within

pytestmark = pytest.mark.system

N_VIEWS = 5
NOTHING_MORE = ScanRequest()
LONG_REST = 15
"""So many statuses, ten a second, without a move or a view: the scan is held."""


@pytest.fixture(scope="module")
def cell():
    """The simulated cell with its first views only: they lie near each other."""
    return with_views(read_cell(), slice(N_VIEWS))


def with_views(settings, which):
    return with_joints(settings, settings.scan.views_rad[which])


def with_joints(settings, views_rad):
    scan = settings.scan.model_copy(update={"views_rad": tuple(views_rad), "look_inside": False})
    return settings.model_copy(update={"scan": scan})


@pytest.fixture(scope="module")
def process():
    """One host for the whole module; whoever kills its process gets the next one by itself."""
    process = ListenedHost(ScanWork, "scans")
    process.host.open()
    yield process
    process.host.close()


@pytest.fixture
def scanning(process, cell, tmp_path):
    process.clear()
    yield Scanning(process, cell, SessionTask(tmp_path / "session", Parameters(), "default"))
    process.free()


class Scanning:
    """Starts jobs and collects what they send."""

    def __init__(self, process, cell, task):
        self.process, self.host, self.cell, self.task = process, process.host, cell, task

    def start(self, request=NOTHING_MORE, source="bowl"):
        self.process.messages.clear()
        self.host.order(ScanWork.get_ready)
        self.host.start(ScanWork.scan, self.task, self.cell, source, request)

    @property
    def sent(self):
        """Messages, and events without their wrapping, since the start."""
        return [one.payload if isinstance(one, Event) else one for one in self.process.messages]

    def of(self, kind):
        return self.process.of(kind)

    def wait(self, until):
        return self.process.wait(until)

    def end(self):
        return self.process.end()

    def views(self):
        return [done.view for done in self.of(ViewDone)]

    def until_views(self, n):
        while len(self.views()) < n:
            self.process.wait_for(ViewDone)

    def until_at_rest(self):
        """Wait until the arm rests for longer than between two moves of a scan that goes on."""
        at_rest = 0
        while at_rest < LONG_REST:
            self.process.next()
            thing = self.sent[-1]
            assert not isinstance(thing, Finished), "it was not held"
            if isinstance(thing, ViewDone) or is_moving(thing):
                at_rest = 0
            at_rest += isinstance(thing, ArmStatus)


def is_moving(thing):
    return isinstance(thing, ArmStatus) and np.abs(thing.state.joint_speeds_rad_s).max() > 0


def kinds(sent):
    """Kinds of events in their order, each once in a row, without what comes by the clock."""
    kept = [type(thing) for thing in sent if not isinstance(thing, ArmStatus | Progressed | Warned)]
    return [kind for k, kind in enumerate(kept) if k == 0 or kind is not kept[k - 1]]


def test_a_scan_publishes_its_arm_views_and_mesh_in_order(scanning):
    scanning.start()
    assert isinstance(scanning.end(), Finished)
    order = kinds(scanning.sent)
    assert order[:3] == [ArmConnected, ViewsPlanned, MeshGrown]
    assert order[-2:] == [ArmDisconnected, Finished]
    [connected] = scanning.of(ArmConnected)
    assert connected.is_simulated
    assert connected.stop_address is None
    [planned] = scanning.of(ViewsPlanned)
    done = scanning.of(ViewDone)
    assert [view.name for view in planned.views] == [one.view.name for one in done]
    assert {view.state for view in planned.views} == {"pending"}
    for before, after in zip(planned.views, done, strict=True):
        np.testing.assert_allclose(after.view.T_base_camera, before.T_base_camera, atol=1e-9)
        assert after.view.state == "taken"
        assert after.color.shape == (480, 640, 3)
        assert after.color.dtype == np.uint8
        assert after.depth_m.dtype == np.float32
        assert 0.3 < after.depth_m[240, 320] < 1.0
    meshes = scanning.of(MeshGrown)
    assert len(meshes[0].faces) == 0
    assert len(meshes[-1].faces) > 1000
    assert meshes[-1].vertices_m.dtype == np.float32
    assert meshes[-1].faces.max() < len(meshes[-1].vertices_m)


@pytest.mark.punctual
def test_the_arm_is_seen_moving_and_the_images_are_those_of_one_that_jumps(scanning, tmp_path):
    scanning.start()
    assert isinstance(scanning.end(), Finished)
    states = [status.state for status in scanning.of(ArmStatus)]
    assert len(states) / (states[-1].time_s - states[0].time_s) < 12
    assert sum(is_moving(status) for status in scanning.of(ArmStatus)) >= N_VIEWS
    other = Session.create_or_open(tmp_path / "other")
    with WorkerPool() as pool, working_on(SessionTask(other.path, Parameters(), ""), pool, Reporter()) as one:
        scan_object(one, scanning.cell, "bowl")
    scans = [Session.open(folder).record("scan") for folder in (scanning.task.folder, other.path)]
    assert scans[0].digest == scans[1].digest


def test_a_paused_scan_holds_and_goes_on(scanning):
    scanning.start()
    scanning.until_views(1)
    scanning.host.order(ScanWork.pause)
    scanning.until_at_rest()
    assert len(scanning.views()) < N_VIEWS
    scanning.host.order(ScanWork.resume)
    assert isinstance(scanning.end(), Finished)
    assert len(scanning.views()) == N_VIEWS


@pytest.mark.punctual
def test_a_cancelled_scan_ends_within_a_second_and_is_continued(scanning):
    scanning.start()
    scanning.until_views(2)
    with within(1):
        scanning.host.cancel()
        failed = scanning.end()
    assert failed.kind is FailureKind.CANCELLED
    assert kinds(scanning.sent)[-2:] == [ArmDisconnected, Failed]
    first = [view.name for view in scanning.views()]
    assert taken(scanning) == first
    scanning.start()
    assert isinstance(scanning.end(), Finished)
    [planned] = scanning.of(ViewsPlanned)
    assert [view.name for view in planned.views if view.state == "taken"] == first
    assert [view.name for view in scanning.views()] == [
        view.name for view in planned.views if view.name not in first
    ]
    meshes = scanning.of(MeshGrown)
    assert len(meshes[0].faces) > 500, "what was kept is shown at once"


def taken(scanning):
    kept = read_views(scanning.task.folder / UNFINISHED_SCAN)
    return [record.view.name for record in kept if record.has_image]


@pytest.mark.punctual
def test_stop_halts_the_arm_and_nothing_goes_on(scanning):
    scanning.start()
    scanning.wait(is_moving)
    with within(1):
        scanning.host.order(ScanWork.stop)
        assert scanning.end().kind is FailureKind.CANCELLED
    assert not is_moving(scanning.of(ArmStatus)[-1])
    [done] = scanning.of(StopDone)
    assert done.seconds < 0.1
    assert done.sentence == ""


def test_a_scan_that_stop_overtakes_never_begins(scanning):
    scanning.start()
    scanning.host.order(ScanWork.stop)
    failed = scanning.end()
    assert failed.kind is FailureKind.CANCELLED
    assert not scanning.views()
    scanning.host.order(ScanWork.stop)  # nothing is under way; whoever starts later has seen it
    scanning.start()
    assert isinstance(scanning.end(), Finished)


def test_a_killed_scan_is_continued(scanning):
    scanning.start()
    scanning.until_views(2)
    os.kill(scanning.host.pid, signal.SIGKILL)
    assert scanning.end().kind is FailureKind.DIED
    kept = taken(scanning)
    assert len(kept) >= 2
    scanning.start()
    assert isinstance(scanning.end(), Finished)
    assert len(scanning.views()) == N_VIEWS - len(kept)
    assert len(read_views(scanning.task.folder / "scan")) == N_VIEWS
    assert not (scanning.task.folder / UNFINISHED_SCAN).exists()


def test_single_views_are_taken_again(scanning):
    scanning.start()
    scanning.end()
    scanning.start(ScanRequest(retake=("frame-000002",)))
    assert isinstance(scanning.end(), Finished)
    assert [view.name for view in scanning.views()] == ["frame-000002"]


def test_a_view_that_fails_is_reported_with_its_reason(scanning):
    home, (first, *others) = scanning.cell.robot.home_rad, scanning.cell.scan.views_rad
    into_the_table = (home[0], 0.25, *home[2:])
    scanning.cell = with_joints(scanning.cell, (first, into_the_table, *others))
    scanning.start()
    assert isinstance(scanning.end(), Finished)
    failed = [one for one in scanning.of(ViewDone) if one.view.state == "failed"]
    assert [one.view.name for one in failed] == ["frame-000001"]
    assert "table" in failed[0].view.problems[0]
    assert failed[0].color is None
    assert len(scanning.views()) == N_VIEWS + 1


def test_views_that_show_more_are_proposed_and_taken(scanning):
    scanning.cell = with_views(read_cell(), slice(None, None, 4))
    n = len(scanning.cell.scan.views_rad)
    scanning.start(source="vase")
    scanning.end()
    scanning.host.start(ScanWork.propose, scanning.task, scanning.cell)
    proposal = scanning.end().result
    assert 1 <= proposal.n_views <= 6
    assert 0.02 < proposal.revealed_share <= 1
    scanning.start(ScanRequest(adaptive=True), source="vase")
    assert isinstance(scanning.end(), Finished)
    planned = scanning.of(ViewsPlanned)
    assert len(planned[-1].views) > n
    assert len(scanning.views()) == len(planned[-1].views) - n


def test_a_scan_that_saw_everything_needs_no_more_views(scanning):
    scanning.cell = with_views(read_cell(), slice(None, None, 2))
    scanning.start()
    scanning.end()
    scanning.host.start(ScanWork.propose, scanning.task, scanning.cell)
    assert scanning.end().result == Proposal(0, 0.0)


def test_what_cannot_be_scanned_is_a_sentence(scanning):
    scanning.start(source="mugg")
    failed = scanning.end()
    assert failed.kind is FailureKind.EXPLAINED
    assert "did you mean" in failed.sentence
    assert not scanning.of(ArmConnected)


@pytest.mark.punctual
def test_a_real_arm_waits_until_somebody_has_seen_its_route(process, cell, tmp_path):
    pytest.importorskip("rtde_control")
    with ControllerProcess(joints_rad=cell.robot.home_rad, speed_up=6.0) as controller:
        real = cell.robot.model_copy(update={"kind": "ur5", "address": controller.address})
        fixed = cell.scan.model_copy(update={"views": "fixed"})
        rehearsal = cell.model_copy(update={"robot": real, "scan": fixed, "is_rehearsal": True})
        process.clear()
        scanning = Scanning(process, rehearsal, SessionTask(tmp_path / "session", Parameters(), "default"))
        scanning.start()
        process.wait_for(ScanQuestion)
        assert "5 views in about" in scanning.of(ScanQuestion)[0].sentence
        scanning.until_at_rest()
        assert not scanning.views()
        process.host.order(ScanWork.resume)
        scanning.until_views(1)
        process.host.order(ScanWork.stop)
        failed = scanning.end()
        assert isinstance(failed, Failed)
        assert failed.kind is FailureKind.CANCELLED
        process.free()
