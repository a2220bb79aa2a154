"""Scanning, for a host process: one host scans, another pours, and the window talks to both."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from threading import Event as Flag
from threading import Thread
from typing import TYPE_CHECKING, Any

import numpy as np

from app.jobs.arm_events import ArmConnected, ArmDisconnected, ArmStatus, StopDone
from app.jobs.messages import Event
from app.jobs.scan_events import MeshGrown, ScanQuestion, ViewDone, ViewProgress, ViewsPlanned
from app.jobs.service import JobReporter, Service
from app.operations.scan_run import ScanObserver, ScanRequest
from app.operations.scanning import Proposal, propose_views, scan_object
from app.operations.session import SessionTask, working_on
from core.errors import Cancelled, PoursightError
from core.motion.kinematics import flange_pose
from core.session import Session
from core.workers import WorkerPool

if TYPE_CHECKING:
    from core.geometry import FloatArray
    from core.reconstruction.tsdf import TsdfVolume
    from core.scan.model import RgbdFrame
    from hardware.cell import Arm, Cell, CellSettings
    from hardware.interfaces import ReadyStep, Robot
    from hardware.scanning.control import ScanControl
    from hardware.scanning.route import ScanRoute
    from hardware.scanning.views import ViewRecord

_CLOSING_S = 1.5
_STATUS_S = 0.1
_MESH_S = 0.3
"""Shortest time between two pictures of the growing mesh, ..."""
_MESH_SHARE = 0.1
"""... and the share of the scan's time that they may take, if they are large."""


@dataclass
class Running:
    """The current job.

    Attributes:
        reporter: of its job.
        control: pauses it.
        robot: of its cell, while that is open.
    """

    reporter: JobReporter
    control: ScanControl
    robot: Robot | None = None


class ScanWork(Service):
    """Takes the views of an object."""

    GIVES_WAY = False

    def __init__(self, send: Callable[[Event], None]) -> None:
        super().__init__(send)
        self._running: Running | None = None
        self._is_idle = Flag()
        self._is_idle.set()
        self._was_stopped = False

    def prepare(self) -> None:
        """Import what a scan needs."""
        from core.pipeline import pipeline  # noqa: F401
        from hardware.scanning import next_best_views, planning  # noqa: F401
        from hardware.simulation import objects, placing  # noqa: F401

    def close(self) -> None:
        """Stop the arm."""
        self.stop()
        self._is_idle.wait(_CLOSING_S)

    def scan(
        self,
        reporter: JobReporter,
        task: SessionTask,
        cell: CellSettings,
        source: str | None,
        request: ScanRequest,
    ) -> None:
        """Scan, or continue, or take views again; publishes the events of `scan_events` and `arm_events`.

        Args:
            reporter: of the job.
            task: the session and its parameters.
            cell: to scan in.
            source: for a simulated cell, a built-in object's name or a mesh file.
            request: what to do beyond the scan itself.

        Raises:
            PoursightError: the sentence says what is in the way; no view that was taken is lost.
        """
        progress = ScanReporter(reporter.publish, cell)
        with self._under_way(reporter) as running:
            opened = partial(watched_cell, running, progress)
            observer = ScanObserver(running.control, opened, progress.planned, progress.taken)
            # A scan computes nothing in workers, so that none is started.
            with WorkerPool() as pool, working_on(task, pool, reporter) as pipeline:
                scan_object(pipeline, cell, source, request, observer, PausingOperator(running))

    def propose(self, reporter: JobReporter, task: SessionTask, cell: CellSettings) -> Proposal:
        """Find out how many further views would show how much of the inside that the scan did not.

        Raises:
            PoursightError: there is no scan, or it cannot be read.
        """
        return propose_views(Session.open(task.folder).folder("scan"), cell, reporter)

    def get_ready(self) -> None:
        """Forget earlier stops; to be ordered before a scan is started."""
        self._was_stopped = False

    def pause(self) -> None:
        """Let the arm rest after the current view."""
        if (running := self._running) is not None:
            running.control.pause()

    def resume(self) -> None:
        """Go on."""
        if (running := self._running) is not None:
            running.control.resume()

    def stop(self) -> None:
        """Stop the arm, at once, and end the scan; one that was requested but has not begun never will."""
        began_s, problem = time.monotonic(), ""
        self._was_stopped = True
        if (running := self._running) is None:
            return
        running.reporter.cancel()  # first: it takes no time, and the scan must not take the stop for a fault
        if (robot := running.robot) is None:
            return
        try:
            robot.stop()
        except PoursightError as error:
            problem = str(error)
        self._send(Event(StopDone(time.monotonic() - began_s, problem)))

    @contextmanager
    def _under_way(self, reporter: JobReporter) -> Iterator[Running]:
        from hardware.scanning.control import ScanControl

        self._is_idle.clear()
        self._running = running = Running(reporter, ScanControl())
        try:
            if self._was_stopped:
                raise Cancelled("STOP was pressed before it began; start it again if the arm may move.")
            yield running
        except PoursightError:
            reporter.raise_if_cancelled()  # a stopped arm raises errors, but somebody wanted it to stop
            raise
        finally:
            self._running = None
            self._was_stopped = False
            self._is_idle.set()


@contextmanager
def watched_cell(running: Running, progress: ScanReporter, cell: Cell | Arm) -> Iterator[None]:
    """A cell's devices are connected: its arm is shown, and can be stopped."""
    running.robot = cell.robot
    try:
        with progress.arm(cell):
            running.reporter.raise_if_cancelled()  # by a stop that came before there was an arm
            yield
    finally:
        running.robot = None


class PausingOperator:
    """Asks by pausing the scan: whoever resumes it has seen what was published."""

    is_present = True

    def __init__(self, running: Running) -> None:
        self._running = running

    def confirm_step(self, step: ReadyStep, why: str) -> None:
        """Publish what is in the way and wait."""
        self.ask(f"{why} Shall the program {step.value}?")

    def confirm_route(self, route: ScanRoute, robot: str) -> None:
        """Publish the route and wait."""
        self.ask(f"The {robot} waits for your word: {route.sentence}")

    def confirm_recovery(self, error: PoursightError, is_repeated: bool) -> None:  # noqa: ARG002
        """Publish what stopped the arm and wait; a scan that was cancelled has ended."""
        if isinstance(error, Cancelled):
            raise error
        self.ask(f"{error} When that is done, the arm is made ready again; it does not move.")

    def ask(self, sentence: str) -> None:
        """Publish a sentence and wait until somebody resumes the job; raises `Cancelled` if nobody does."""
        self._running.control.pause()
        self._running.reporter.publish(ScanQuestion(sentence))
        self._running.control.wait_while_paused(self._running.reporter)


class ScanReporter:
    """Publishes the events of one scan."""

    def __init__(self, publish: Callable[[Any], None], cell: CellSettings) -> None:
        """`publish` takes an event, from any thread; `cell` is scanned in."""
        self._publish = publish
        self._cell = cell
        self._next_mesh_s = 0.0

    def planned(self, records: Sequence[ViewRecord], volume: TsdfVolume) -> None:
        """Publish which views are to be taken, and which are there already."""
        self._publish(ViewsPlanned(tuple(self._view(record, self._pose(record)) for record in records)))
        self._mesh(volume)

    def taken(self, record: ViewRecord, frame: RgbdFrame | None, volume: TsdfVolume) -> None:
        """Publish what became of a view."""
        if frame is None:
            self._publish(ViewDone(self._view(record, self._pose(record)), None, None))
            return
        self._publish(ViewDone(self._view(record, frame.T_base_camera), frame.color, frame.depth_m))
        if time.monotonic() >= self._next_mesh_s:
            self._mesh(volume)

    def _mesh(self, volume: TsdfVolume) -> None:
        """Publish what was seen so far."""
        began_s = time.monotonic()
        mesh = volume.mesh()
        self._publish(MeshGrown(mesh.vertices_m.astype(np.float32), mesh.faces.astype(np.int32)))
        now_s = time.monotonic()
        self._next_mesh_s = now_s + max(_MESH_S, (now_s - began_s) / _MESH_SHARE)

    @contextmanager
    def arm(self, cell: Cell | Arm) -> Iterator[None]:
        """Publish the status of the cell's arm while it is connected; a recorded scan has none."""
        if self._cell.robot.kind == "replay":
            yield
            return
        is_simulated = not self._cell.robot.is_real
        self._publish(ArmConnected(cell.robot.name, self._cell.robot.address, is_simulated))
        ended = Flag()
        thread = Thread(target=self._watch, args=(cell, ended), name="arm's state", daemon=True)
        thread.start()
        try:
            yield
        finally:
            ended.set()
            thread.join()
            self._publish(ArmDisconnected())

    def _watch(self, cell: Cell | Arm, ended: Flag) -> None:
        self._publish(_status(cell))
        while not ended.wait(_STATUS_S):
            self._publish(_status(cell))
        self._publish(_status(cell))  # how it was left

    def _pose(self, record: ViewRecord) -> FloatArray | None:
        """Where the camera will be, by kinematics; not known before a recorded scan is played."""
        if self._cell.robot.kind == "replay":
            return None
        return planned_pose(self._cell, record.view.joints_rad)

    def _view(self, record: ViewRecord, T_base_camera: FloatArray | None) -> ViewProgress:
        return ViewProgress(record.view.name, record.state.value, tuple(record.problems), T_base_camera)


def planned_pose(cell: CellSettings, joints_rad: Sequence[float]) -> FloatArray:
    """Return the pose `T_base_camera` (4, 4) of a cell's camera at joint angles (6,)."""
    pose: FloatArray = flange_pose(cell.robot.arm, joints_rad) @ cell.camera.pose
    return pose


def _status(cell: Cell | Arm) -> ArmStatus:
    try:
        return ArmStatus(cell.robot.state(), cell.gripper.is_closed, "")
    except PoursightError as error:
        return ArmStatus(None, None, str(error))
