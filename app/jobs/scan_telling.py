"""From what happens in a scan to what the window is told of it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Event, Thread
from typing import TYPE_CHECKING, Any

import numpy as np

from app.jobs.arm_news import ArmConnected, ArmGone, ArmStatus
from app.jobs.scan_news import MeshGrown, ViewDone, ViewNews, ViewsPlanned
from core.errors import PoursightError
from core.motion.kinematics import flange_pose

if TYPE_CHECKING:
    from core.geometry import FloatArray
    from core.reconstruction.tsdf import TsdfVolume
    from core.scan.model import RgbdFrame
    from hardware.cell import Cell, CellSettings
    from hardware.scanning.views import ViewRecord

_STATUS_S = 0.1
_MESH_S = 0.3
"""Soonest time between two pictures of the growing mesh, ..."""
_MESH_SHARE = 0.1
"""... and the share of the scan's time that they may take, if they are large."""


@dataclass
class ScanTelling:
    """Tells of one scan.

    Attributes:
        tell: sends one piece of news; safe from any thread.
        cell: that is scanned in.
    """

    tell: Callable[[Any], None]
    cell: CellSettings
    _next_mesh_s: float = 0.0

    def planned(self, records: Sequence[ViewRecord], volume: TsdfVolume) -> None:
        """Tell what is to be taken, and what is there already."""
        self.tell(ViewsPlanned(tuple(self._news(record, self._pose(record)) for record in records)))
        self.mesh(volume)

    def taken(self, record: ViewRecord, frame: RgbdFrame | None, volume: TsdfVolume) -> None:
        """Tell what became of a view."""
        if frame is None:
            self.tell(ViewDone(self._news(record, self._pose(record)), None, None))
            return
        self.tell(ViewDone(self._news(record, frame.T_base_camera), frame.color, frame.depth_m))
        if time.monotonic() >= self._next_mesh_s:
            self.mesh(volume)

    def mesh(self, volume: TsdfVolume) -> None:
        """Tell what was seen so far, however short the last time is ago."""
        began_s = time.monotonic()
        mesh = volume.mesh()
        self.tell(MeshGrown(mesh.vertices_m.astype(np.float32), mesh.faces.astype(np.int32)))
        now_s = time.monotonic()
        self._next_mesh_s = now_s + max(_MESH_S, (now_s - began_s) / _MESH_SHARE)

    @contextmanager
    def arm(self, cell: Cell) -> Iterator[None]:
        """Tell of the cell's arm while it is connected; a recorded scan has none."""
        if self.cell.robot.kind == "replay":
            yield
            return
        is_simulated = self.cell.robot.kind != "ur5"
        self.tell(ArmConnected(cell.robot.name, self.cell.robot.address, is_simulated))
        ended = Event()
        thread = Thread(target=self._watch, args=(cell, ended), name="arm's state", daemon=True)
        thread.start()
        try:
            yield
        finally:
            ended.set()
            thread.join()
            self.tell(ArmGone())

    def _watch(self, cell: Cell, ended: Event) -> None:
        self.tell(_status(cell))
        while not ended.wait(_STATUS_S):
            self.tell(_status(cell))
        self.tell(_status(cell))  # how it was left

    def _pose(self, record: ViewRecord) -> FloatArray | None:
        """Where the camera will stand, by kinematics; nobody knows before a recorded scan is played."""
        if self.cell.robot.kind == "replay":
            return None
        return planned_pose(self.cell, record.view.joints_rad)

    def _news(self, record: ViewRecord, T_base_camera: FloatArray | None) -> ViewNews:
        return ViewNews(record.view.name, record.state.value, tuple(record.problems), T_base_camera)


def planned_pose(cell: CellSettings, joints_rad: Sequence[float]) -> FloatArray:
    """Pose `T_base_camera` (4, 4) of a cell's camera where the arm stands at joint angles (6,)."""
    from hardware.cell.scene import ARMS

    pose: FloatArray = flange_pose(ARMS[cell.robot.model], joints_rad) @ cell.camera.pose
    return pose


def _status(cell: Cell) -> ArmStatus:
    try:
        return ArmStatus(cell.robot.state(), cell.gripper.is_closed, "")
    except PoursightError as error:
        return ArmStatus(None, None, str(error))
