"""Taking views one after the other: move, come to rest, take an image, store it, fuse it (Sec. IV-A)."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import suppress

import numpy as np

from core.errors import MotionError, Remedy, StageError
from core.formats import excerpt
from core.geometry import FloatArray
from core.progress import Reporter
from core.quality.plain_fusion import empty_coarse_volume, fuse_plainly
from core.quality.view_quality import ViewQuality, check_view
from core.reconstruction.tsdf import TsdfVolume
from core.scan.model import Intrinsics, RgbdFrame, Scan
from hardware.cell import Cell
from hardware.errors import CameraError, CameraLost, RobotError
from hardware.interfaces import CameraImage
from hardware.scanning.control import ScanControl
from hardware.scanning.moving import (
    MOVE_TIMEOUT_S,
    POLL_S,
    RESTING_RAD_S,
    SAME_PLACE_RAD,
    Moving,
    NoMoving,
    PlainMoving,
)
from hardware.scanning.store import ScanStore
from hardware.scanning.views import PlannedView, ViewRecord, ViewState

STAGE = "scan"
MOST_FAILURES_IN_A_ROW = 3
RECONNECT_WAIT_S = 0.5
FEWEST_VIEWS = 3

ViewTaken = Callable[[ViewRecord, RgbdFrame | None, TsdfVolume], None]
"""Called after each view: what became of it, its images (none if it failed), and everything fused so far
(`.mesh()` to look at)."""
ViewsPlanned = Callable[[Sequence[ViewRecord], TsdfVolume], None]
"""Called before views are taken: what became of each so far, and everything fused so far."""


class ScanProcedure:
    """Takes the views of one scan, in the cell, which must be entered.

    Attributes:
        records: what became of each view, in their order.
        volume: everything fused so far, coarsely.
    """

    def __init__(
        self,
        cell: Cell,
        store: ScanStore | None,
        reporter: Reporter,
        control: ScanControl | None = None,
        taken: ViewTaken | None = None,
        planned: ViewsPlanned | None = None,
        moving: Moving | None = None,
    ) -> None:
        """Begin, or continue what the store's folder holds; without a store nothing goes to the disk.

        A real arm needs a `moving` that asks; without one only an arm that is not real moves.

        Raises:
            SessionError: the folder holds another scan, or cannot be written.
        """
        place = cell.settings.place
        self.records: list[ViewRecord] = []
        self.volume = empty_coarse_volume(place.crop_box)
        self._cell = cell
        self._store = store
        self._reporter = reporter
        self._control = control or ScanControl()
        self._taken = taken
        self._planned = planned
        self._moving = moving or self._unwatched()
        self._frames: dict[str, RgbdFrame] = {}
        self._intrinsics: Intrinsics | None = None
        self._last: RgbdFrame | None = None
        if store is not None:
            self.records = store.begin(place.platform_height_m, place.crop_box)
            self._recover(store)

    def take(self, views: Sequence[PlannedView]) -> None:
        """Take the views that are not taken yet; one that fails is left out and reported.

        Raises:
            Cancelled: on request; the arm is at rest, and what was taken is kept.
            StageError: several views failed one after the other.
            DeviceError: camera or robot are gone.
            SessionError: a view could not be written.
        """
        self._plan(views)
        wanted = {view.name for view in views}
        self._moving.prepare([r.view for r in self.records if r.view.name in wanted and not r.has_image])
        failures = 0
        for index, record in enumerate(self.records):
            if record.view.name not in wanted or record.has_image:
                continue
            self._control.wait_while_paused(self._reporter)
            self.records[index] = outcome = self._take_one(record.view)
            failures = 0 if outcome.has_image else failures + 1
            self._report(outcome)
            if failures == MOST_FAILURES_IN_A_ROW:
                raise StageError(
                    f"{failures} views failed one after the other, the last because: {outcome.problems[0]} "
                    f"What was taken before (views: {self._n_taken}) is kept; find and fix the cause.",
                    Remedy.CONTINUE,
                )

    def retake(self, names: Sequence[str]) -> None:
        """Take single views again; their old images stay until the new ones are there.

        Raises:
            StageError: there is no such view. See `take` for the rest.
        """
        known = {record.view.name: k for k, record in enumerate(self.records)}
        for name in names:
            if name not in known:
                names = excerpt(", ".join(known))
                raise StageError(f"The scan has no view '{excerpt(name)}'; its views are {names}.")
        self._moving.prepare([self.records[known[name]].view for name in names])
        for name in names:
            self._control.wait_while_paused(self._reporter)
            index = known[name]
            before = self.records[index]
            outcome = self._take_one(before.view)
            if outcome.has_image or not before.has_image:
                self.records[index] = outcome
            if outcome.has_image:
                self._fuse_anew()
                self._report(outcome)
            else:
                fate = "keeps its old image" if before.has_image else "is left out again"
                self._reporter.warn(f"View {name} {fate}: {outcome.problems[0]}")
                self._write_records()

    def scan(self) -> Scan:
        """Return what was taken.

        Raises:
            StageError: hardly any view was.
        """
        frames = [self._frames[r.view.name] for r in self.records if r.view.name in self._frames]
        if len(frames) < FEWEST_VIEWS or self._intrinsics is None:
            raise StageError(
                f"Only {len(frames)} views could be taken; correct what was reported and scan again."
            )
        place = self._cell.settings.place
        return Scan(tuple(frames), self._intrinsics, place.platform_height_m, place.crop_box)

    def camera_facts(self) -> tuple[Intrinsics, tuple[int, int]]:
        """Return the camera's intrinsics and the width and height of its images; one must have been taken."""
        assert self._intrinsics is not None, "an image was taken"
        height, width = next(iter(self._frames.values())).depth_m.shape
        return self._intrinsics, (width, height)

    @property
    def _n_taken(self) -> int:
        return sum(record.has_image for record in self.records)

    def _unwatched(self) -> Moving:
        assert not self._cell.settings.robot.is_real, "a real arm moves along a confirmed route only"
        return NoMoving() if self._is_replay else PlainMoving(self._cell, self._reporter)

    def _recover(self, store: ScanStore) -> None:
        """Continue an interrupted scan; a view recorded but not whole on the disk is taken again."""
        left = store.recover(self.records)
        if left is not None:
            self._frames = {frame.name: frame for frame in left.frames}
            self._intrinsics = left.intrinsics
            self._fuse_anew()
        self.records = [
            record if record.view.name in self._frames else ViewRecord(record.view) for record in self.records
        ]

    def _plan(self, views: Sequence[PlannedView]) -> None:
        known = {record.view.name for record in self.records}
        self.records += [ViewRecord(view) for view in views if view.name not in known]
        if self._planned is not None:
            self._planned(tuple(self.records), self.volume)

    def _take_one(self, view: PlannedView) -> ViewRecord:
        """Move there and shoot, with a bound on the tries."""
        try:
            self._moving.go(view)
        except MotionError as error:
            return ViewRecord(view, ViewState.FAILED, (str(error),))
        if not self._is_replay:
            self._settle(np.array(view.joints_rad))
        problems: tuple[str, ...] = ()
        for attempt in range(self._cell.settings.scan.tries):
            self._reporter.raise_if_cancelled()
            try:
                image, pose = self._take_image(reconnect=attempt > 0)
            except CameraLost:
                if attempt + 1 == self._cell.settings.scan.tries:
                    raise
                continue
            except CameraError as error:
                problems = (str(error),)
                continue
            frame = RgbdFrame(view.name, image.color, image.depth_m, pose)
            quality = self._judge(frame, image.intrinsics)
            problems = quality.problems
            if not quality.is_useless:
                return self._store_view(view, frame, image.intrinsics, problems)
        return ViewRecord(view, ViewState.FAILED, problems)

    def _settle(self, joints_rad: FloatArray) -> None:
        """Wait until the arm has been at rest for a while, at its target."""
        settle_s = 0.0 if self._is_instant else self._cell.settings.scan.settle_s
        began_s = since_s = time.monotonic()
        while True:
            self._moving.refuse_stopped()
            state = self._cell.robot.state()
            if time.monotonic() - began_s > MOVE_TIMEOUT_S:
                raise RobotError(
                    f"The {self._cell.robot.name} does not come to rest; find out what shakes it.",
                    Remedy.CONTINUE,
                )
            if np.abs(state.joint_speeds_rad_s).max() > RESTING_RAD_S:
                since_s = time.monotonic()
            elif time.monotonic() - since_s >= settle_s:
                break
            self._reporter.raise_if_cancelled()
            time.sleep(POLL_S)
        if np.abs(state.joints_rad - joints_rad).max() > SAME_PLACE_RAD:
            raise RobotError(f"The {self._cell.robot.name} is not where it was sent; see what holds it.")

    def _take_image(self, reconnect: bool) -> tuple[CameraImage, FloatArray]:
        """Take an image and the camera's pose (4, 4) by the joints and the hand-eye calibration."""
        cell = self._cell
        if reconnect:
            time.sleep(0.0 if self._is_instant else RECONNECT_WAIT_S)
            with suppress(CameraError):
                cell.camera.__exit__(None, None, None)
            cell.camera.__enter__()
        before = cell.robot.state().joints_rad
        image = cell.camera.capture()
        self._moving.refuse_stopped()
        after = cell.robot.state()
        if np.abs(after.joints_rad - before).max() > SAME_PLACE_RAD:
            raise RobotError(
                "The arm moved while an image was taken; keep hands off the arm.", Remedy.CONTINUE
            )
        return image, after.T_base_flange @ cell.settings.camera.pose

    def _judge(self, frame: RgbdFrame, intrinsics: Intrinsics) -> ViewQuality:
        place = self._cell.settings.place
        return check_view(
            frame, intrinsics, place.crop_box, before=self._last, table_height_m=place.table_height_m
        )

    def _store_view(
        self, view: PlannedView, frame: RgbdFrame, intrinsics: Intrinsics, problems: tuple[str, ...]
    ) -> ViewRecord:
        record = ViewRecord(view, ViewState.POOR if problems else ViewState.TAKEN, problems)
        self._intrinsics = intrinsics
        self._last = frame
        if self._store is not None:
            now = [record if r.view.name == view.name else r for r in self.records]
            self._store.write_view(frame, intrinsics, now)
        is_new = view.name not in self._frames
        self._frames[view.name] = frame
        if is_new:
            fuse_plainly(self.volume, frame, intrinsics)
        return record

    def _report(self, outcome: ViewRecord) -> None:
        self._write_records()
        for problem in outcome.problems:
            kind = "left out" if not outcome.has_image else "poor"
            self._reporter.warn(f"View {outcome.view.name} is {kind}: {problem}")
        self._reporter.progress(STAGE, self._n_taken, len(self.records))
        if self._taken is not None:
            frame = self._frames[outcome.view.name] if outcome.has_image else None
            self._taken(outcome, frame, self.volume)

    def _write_records(self) -> None:
        if self._store is not None:
            self._store.write_records(self.records)

    def _fuse_anew(self) -> None:
        """A view cannot be taken out of a volume: fuse all again."""
        assert self._intrinsics is not None, "there are frames"
        self.volume = empty_coarse_volume(self._cell.settings.place.crop_box)
        for frame in self._frames.values():
            fuse_plainly(self.volume, frame, self._intrinsics)

    @property
    def _is_instant(self) -> bool:
        return self._cell.settings.simulation.is_instant and not self._cell.settings.robot.is_real

    @property
    def _is_replay(self) -> bool:
        return self._cell.settings.robot.kind == "replay"
