"""Scans in a host process: what is told and when, how they are held up, stopped, killed and continued."""

from __future__ import annotations

import os
import queue
import signal
import time

import numpy as np
import pytest

from app.jobs.arm_news import ArmConnected, ArmGone, ArmStatus, StopDone
from app.jobs.host import Host
from app.jobs.messages import Failed, FailureKind, Finished, News, Progressed, Warned
from app.jobs.scan_news import MeshGrown, Proposal, ViewDone, ViewsPlanned
from app.jobs.scan_work import ScanWork
from app.jobs.session_work import SessionTask, working_on
from app.scanning import IN_PROGRESS, ScanWishes, scan_object
from core.parameters import Parameters
from core.progress import Reporter
from core.session import Session
from core.workers import WorkerPool
from hardware.cell import read_cell
from hardware.scanning.keeping import read_views

N_VIEWS = 5
NO_WISHES = ScanWishes()


@pytest.fixture(scope="module")
def cell():
    """The simulated cell with its first views only: they lie near each other."""
    return with_views(read_cell(), slice(N_VIEWS))


def with_views(settings, which):
    return with_joints(settings, settings.scan.views_rad[which])


def with_joints(settings, views_rad):
    scan = settings.scan.model_copy(update={"views_rad": tuple(views_rad)})
    return settings.model_copy(update={"scan": scan})


@pytest.fixture(scope="module")
def process():
    """One host for the whole module; whoever kills its process gets the next one by itself."""
    heard = queue.Queue()
    host = Host(ScanWork, "scans", heard.put)
    host.open()
    yield host, heard
    host.close()


@pytest.fixture
def scanning(process, cell, tmp_path):
    host, heard = process
    while not heard.empty():
        heard.get()
    return Scanning(host, heard, cell, SessionTask(tmp_path / "session", Parameters(), "default"))


class Scanning:
    """Starts jobs and collects what they tell."""

    def __init__(self, host, heard, cell, task):
        self.host, self.heard, self.cell, self.task = host, heard, cell, task
        self.told = []

    def start(self, wishes=NO_WISHES, source="bowl"):
        self.host.order(ScanWork.get_ready)
        self.host.start(ScanWork.scan, self.task, self.cell, source, wishes)

    def until(self, is_enough, seconds=30.0):
        """Listen until a message or piece of news is of a kind; return it."""
        deadline_s = time.monotonic() + seconds
        while True:
            message = self.heard.get(timeout=max(deadline_s - time.monotonic(), 0.01))
            thing = message.payload if isinstance(message, News) else message
            self.told.append(thing)
            if is_enough(thing):
                return thing

    def end(self):
        return self.until(lambda thing: isinstance(thing, Finished | Failed))

    def views(self):
        return [thing.view for thing in self.told if isinstance(thing, ViewDone)]

    def until_views(self, n):
        while len(self.views()) < n:
            self.until(lambda thing: isinstance(thing, ViewDone))


def is_moving(thing):
    return isinstance(thing, ArmStatus) and np.abs(thing.state.joint_speeds_rad_s).max() > 0


def kinds(told):
    """Kinds of news in their order, each once in a row, without what comes by the clock."""
    kept = [type(thing) for thing in told if not isinstance(thing, ArmStatus | Progressed | Warned)]
    return [kind for k, kind in enumerate(kept) if k == 0 or kind is not kept[k - 1]]


def test_a_scan_tells_of_its_arm_views_and_mesh_in_order(scanning):
    scanning.start()
    assert isinstance(scanning.end(), Finished)
    told = kinds(scanning.told)
    assert told[:3] == [ArmConnected, ViewsPlanned, MeshGrown]
    assert told[-2:] == [ArmGone, Finished]
    [connected] = [thing for thing in scanning.told if isinstance(thing, ArmConnected)]
    assert connected.is_simulated
    assert connected.stop_address is None
    [planned] = [thing for thing in scanning.told if isinstance(thing, ViewsPlanned)]
    done = [thing for thing in scanning.told if isinstance(thing, ViewDone)]
    assert [view.name for view in planned.views] == [one.view.name for one in done]
    assert {view.state for view in planned.views} == {"pending"}
    for before, after in zip(planned.views, done, strict=True):
        np.testing.assert_allclose(after.view.T_base_camera, before.T_base_camera, atol=1e-9)
        assert after.view.state == "taken"
        assert after.color.shape == (480, 640, 3)
        assert after.color.dtype == np.uint8
        assert after.depth_m.dtype == np.float32
        assert 0.3 < after.depth_m[240, 320] < 1.0
    meshes = [thing for thing in scanning.told if isinstance(thing, MeshGrown)]
    assert len(meshes[0].faces) == 0
    assert len(meshes[-1].faces) > 1000
    assert meshes[-1].vertices_m.dtype == np.float32
    assert meshes[-1].faces.max() < len(meshes[-1].vertices_m)


def test_the_arm_is_seen_moving_and_the_images_are_those_of_one_that_jumps(scanning, tmp_path):
    scanning.start()
    assert isinstance(scanning.end(), Finished)
    states = [thing.state for thing in scanning.told if isinstance(thing, ArmStatus)]
    began_s, ended_s = states[0].time_s, states[-1].time_s
    assert 5 < len(states) / (ended_s - began_s) < 12
    moving = [state for state in states if np.abs(state.joint_speeds_rad_s).max() > 0]
    assert len(moving) > len(states) / 4
    other = Session.create_or_open(tmp_path / "other")
    with WorkerPool() as pool, working_on(SessionTask(other.path, Parameters(), ""), pool, Reporter()) as one:
        scan_object(one, scanning.cell, "bowl")
    scans = [Session.open(folder).record("scan") for folder in (scanning.task.folder, other.path)]
    assert scans[0].digest == scans[1].digest


def test_a_paused_scan_holds_and_goes_on(scanning):
    scanning.start()
    scanning.until_views(1)
    scanning.host.order(ScanWork.pause)
    pause_s = time.monotonic()
    with pytest.raises(queue.Empty):
        scanning.until(lambda thing: isinstance(thing, ViewDone) and time.monotonic() > pause_s + 1.2, 1.8)
    n_held = len(scanning.views())
    assert n_held <= 2
    assert not any(is_moving(thing) for thing in scanning.told[-3:])
    scanning.host.order(ScanWork.resume)
    assert isinstance(scanning.end(), Finished)
    assert len(scanning.views()) == N_VIEWS


def test_a_cancelled_scan_ends_within_a_second_and_is_continued(scanning):
    scanning.start()
    scanning.until_views(2)
    began_s = time.monotonic()
    scanning.host.cancel()
    failed = scanning.end()
    assert time.monotonic() - began_s < 1
    assert failed.kind is FailureKind.CANCELLED
    assert kinds(scanning.told)[-2:] == [ArmGone, Failed]
    first = [view.name for view in scanning.views()]
    assert taken(scanning) == first
    scanning.told.clear()
    scanning.start()
    assert isinstance(scanning.end(), Finished)
    [planned] = [thing for thing in scanning.told if isinstance(thing, ViewsPlanned)]
    assert [view.name for view in planned.views if view.state == "taken"] == first
    assert [view.name for view in scanning.views()] == [
        view.name for view in planned.views if view.name not in first
    ]
    meshes = [thing for thing in scanning.told if isinstance(thing, MeshGrown)]
    assert len(meshes[0].faces) > 500, "what was kept is shown at once"


def taken(scanning):
    kept = read_views(scanning.task.folder / IN_PROGRESS)
    return [record.view.name for record in kept if record.has_image]


def test_stop_halts_the_arm_and_nothing_goes_on(scanning):
    scanning.start()
    scanning.until(
        lambda thing: isinstance(thing, ArmStatus) and np.abs(thing.state.joint_speeds_rad_s).max()
    )
    began_s = time.monotonic()
    scanning.host.order(ScanWork.stop)
    assert scanning.end().kind is FailureKind.CANCELLED
    assert time.monotonic() - began_s < 1
    assert not is_moving([thing for thing in scanning.told if isinstance(thing, ArmStatus)][-1])
    [done] = [thing for thing in scanning.told if isinstance(thing, StopDone)]
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
    scanning.told.clear()
    scanning.start()
    assert isinstance(scanning.end(), Finished)
    assert len(scanning.views()) == N_VIEWS - len(kept)
    assert len(read_views(scanning.task.folder / "scan")) == N_VIEWS
    assert not (scanning.task.folder / IN_PROGRESS).exists()


def test_single_views_are_taken_again(scanning):
    scanning.start()
    scanning.end()
    scanning.told.clear()
    scanning.start(ScanWishes(retake=("frame-000002",)))
    assert isinstance(scanning.end(), Finished)
    assert [view.name for view in scanning.views()] == ["frame-000002"]


def test_a_view_that_fails_is_told_with_its_reason(scanning):
    home, (first, *others) = scanning.cell.robot.home_rad, scanning.cell.scan.views_rad
    into_the_table = (home[0], 0.25, *home[2:])
    scanning.cell = with_joints(scanning.cell, (first, into_the_table, *others))
    scanning.start()
    assert isinstance(scanning.end(), Finished)
    failed = [one for one in scanning.told if isinstance(one, ViewDone) and one.view.state == "failed"]
    assert [one.view.name for one in failed] == ["frame-000001"]
    assert "table" in failed[0].view.problems[0]
    assert failed[0].color is None
    assert len(scanning.views()) == N_VIEWS + 1


@pytest.mark.slow
def test_views_that_show_more_are_proposed_and_taken(scanning):
    scanning.cell = with_views(read_cell(), slice(None, None, 4))
    n = len(scanning.cell.scan.views_rad)
    scanning.start(source="vase")
    scanning.end()
    scanning.host.start(ScanWork.propose, scanning.task, scanning.cell)
    proposal = scanning.end().result
    assert 1 <= proposal.n_views <= 6
    assert 0.02 < proposal.revealed_share <= 1
    scanning.told.clear()
    scanning.start(ScanWishes(adaptive=True), source="vase")
    assert isinstance(scanning.end(), Finished)
    planned = [thing for thing in scanning.told if isinstance(thing, ViewsPlanned)]
    assert len(planned[-1].views) > n
    assert len(scanning.views()) == len(planned[-1].views) - n


def test_a_scan_that_saw_everything_needs_no_more_views(scanning):
    scanning.start()
    scanning.end()
    scanning.host.start(ScanWork.propose, scanning.task, scanning.cell)
    assert scanning.end().result == Proposal(0, 0.0)


def test_what_cannot_be_scanned_is_a_sentence(scanning):
    scanning.start(source="mugg")
    failed = scanning.end()
    assert failed.kind is FailureKind.EXPLAINED
    assert "did you mean" in failed.sentence
    assert not any(isinstance(thing, ArmConnected) for thing in scanning.told)
