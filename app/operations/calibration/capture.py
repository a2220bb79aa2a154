"""Looking at the board: the arm goes from pose to pose, each look is judged, and kept at once."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from app.operations.animating import animated
from app.operations.arm import connected
from app.operations.calibration.confirming import RouteQuestions
from app.operations.calibration.provenance import new_run, write_looks
from app.operations.scan_run import ScanOperator
from core.calibration.board import BoardSpec
from core.calibration.collecting import Collection, Look
from core.calibration.detection import Detection, detect_board, gray, measured_square_m
from core.calibration.lens import Lens
from core.calibration.proposing import Proposal
from core.calibration.views import board_view, why_unusable
from core.errors import InputError, MotionError, StageError
from core.geometry import FloatArray
from core.progress import Reporter
from hardware.cell import Cell
from hardware.cell.calibrating import open_calibration_cell
from hardware.cell.settings import CellSettings
from hardware.errors import CameraError, CameraLost
from hardware.interfaces import CameraImage
from hardware.pouring.run_log import RunLog
from hardware.scanning.control import ScanControl
from hardware.scanning.moving import Moving, PlainMoving, WatchedMoving
from hardware.scanning.views import PlannedView

_STILL_RAD = 2e-4
"""An arm that moves more than this during an image was not at rest."""
_MOVED = "The arm moved while the image was taken; keep away from it, and let it come to rest."
_REST_S = 2.0
_DEPTH_TOLERANCE = 0.05
"""Depth that differs by more says that the squares were measured or entered wrongly."""


@dataclass(frozen=True)
class CaptureObserver:
    """How somebody follows a run.

    Attributes:
        opened: called with the cell; what it returns is entered while the cell's devices are connected.
        planned: called with the poses of each round, in their order, before the first one is gone to.
        taken: called with each look, how many usable views there are by now, and its image as a pinhole
            shows it, if there is one.
        is_watching: whether a simulated arm moves where it would jump.
        control: lets it wait between two views.
    """

    opened: Callable[[Cell], AbstractContextManager[object]] = lambda cell: nullcontext(cell)
    planned: Callable[[Sequence[Proposal]], None] = lambda poses: None  # noqa: ARG005
    taken: Callable[[Look, int, CameraImage | None], None] = lambda look, n_usable, image: None  # noqa: ARG005
    is_watching: bool = False
    control: ScanControl = field(default_factory=ScanControl)


NOBODY = CaptureObserver()


@dataclass
class Capture:
    """A cell at work on one run; what `capturing` yields.

    Attributes:
        cell: connected.
        folder: of the run.
        facts: written beside the looks.
        collection: the looks so far.
        lens: of the camera.
        moving: brings the arm to poses.
        questions: to whoever confirms what a real arm does; none: nothing real moves.
        reporter: may cancel.
        observer: follows.
    """

    cell: Cell
    folder: Path
    facts: dict[str, Any]
    collection: Collection
    lens: Lens
    moving: Moving
    questions: RouteQuestions | None
    reporter: Reporter
    observer: CaptureObserver

    def adopt(self, looks: Sequence[Look]) -> None:
        """Go on with the looks of an interrupted run; their images stay where they are."""
        self.collection.looks += looks
        write_looks(self.folder, self.facts, self.collection.looks, None)

    def look_here(self) -> Look:
        """Look at the board from where the arm is."""
        return self._keep(self._look(np.array(self.cell.robot.state().joints_rad)))

    def go_and_look(self, poses: tuple[Proposal, ...]) -> None:
        """Go from pose to pose; one without a clear way is passed over.

        Raises:
            PoursightError: the arm was stopped, or a device is gone; the looks before are kept.
        """
        first = len(self.collection.looks) + 1
        views = [PlannedView(f"view {first + k}", tuple(p.joints_rad.tolist())) for k, p in enumerate(poses)]
        self.observer.planned(poses)
        self.moving.prepare(views)
        for view, pose in zip(views, poses, strict=True):
            self.observer.control.wait_while_paused(self.reporter)
            try:
                self.moving.go(view)
            except MotionError as error:
                self._keep((Look(pose.joints_rad, None, str(error)), None))
                continue
            self._keep(self._look(pose.joints_rad))

    def look_still(self, joints_rad: FloatArray, n_images: int) -> list[Detection]:
        """Go to a pose and take several images of the board; the last one is kept.

        Raises:
            StageError: one of them does not show it, or the arm moved meanwhile.
            PoursightError: see `go_and_look`; there is no clear way.
        """
        view = PlannedView("look", tuple(joints_rad.tolist()))
        self.observer.control.wait_while_paused(self.reporter)
        self.moving.prepare([view])
        self.moving.go(view)
        self._rest()
        before, found, image = self.cell.robot.state(), [], None
        for _ in range(n_images):
            self.reporter.raise_if_cancelled()
            image = self.cell.camera.capture()
            found.append(detect_board(gray(image.color), self.collection.board, self.lens))
        after = self.cell.robot.state()
        if np.abs(after.joints_rad - before.joints_rad).max() > _STILL_RAD:
            raise StageError(_MOVED)
        seen = board_view(view.name, after.T_base_flange, found[-1])
        self._keep((Look(joints_rad, seen), image))
        return found

    def _keep(self, found: tuple[Look, CameraImage | None]) -> Look:
        look, image = found
        self.collection.looks.append(look)
        png = None
        if image is not None:
            import cv2  # late: it costs the window memory

            png = cv2.imencode(".png", cv2.cvtColor(image.color, cv2.COLOR_RGB2BGR))[1].tobytes()
            # Whoever follows draws the corners into it, which are where a pinhole sees them.
            image = replace(image, color=self.lens.as_pinhole(image.color))
        write_looks(self.folder, self.facts, self.collection.looks, png)
        self.observer.taken(look, len(self.collection.views), image)
        return look

    def _look(self, joints_rad: FloatArray) -> tuple[Look, CameraImage | None]:
        self._rest()
        before = self.cell.robot.state()
        try:
            image = self.cell.camera.capture()
        except CameraLost:
            raise
        except CameraError as error:
            return Look(joints_rad, None, str(error)), None
        after = self.cell.robot.state()
        if np.abs(after.joints_rad - before.joints_rad).max() > _STILL_RAD:
            return Look(joints_rad, None, _MOVED), image
        board = self.collection.board
        name = f"view {len(self.collection.looks) + 1}"
        picture = gray(image.color)
        try:
            seen = detect_board(picture, board, self.lens)
        except StageError as error:
            return Look(joints_rad, None, str(error)), image
        _refuse_other_squares(measured_square_m(seen, board, self.lens, image.depth_m), board)
        poor = why_unusable(seen, picture, board, self.lens, after.T_base_flange, self.collection.views)
        return Look(joints_rad, board_view(name, after.T_base_flange, seen), poor or ""), image

    def _rest(self) -> None:
        """Wait until the arm and what hangs at it are still."""
        deadline_s = time.monotonic() + _REST_S
        while np.abs(self.cell.robot.state().joint_speeds_rad_s).max() > 1e-3:
            if time.monotonic() > deadline_s:
                break
            time.sleep(0.01)
        if self.cell.settings.robot.is_real:
            time.sleep(self.cell.settings.scan.settle_s)


@contextmanager
def capturing(
    cell_file: Path,
    settings: CellSettings,
    board: BoardSpec,
    step: str,
    facts: dict[str, Any],
    reporter: Reporter,
    operator: ScanOperator | None,
    observer: CaptureObserver,
    n_wanted: int,
) -> Iterator[Capture]:
    """Connect a cell that shall look at the board.

    Raises:
        PoursightError: it cannot be connected, or nobody is there to confirm what a real arm does.
    """
    if settings.robot.kind == "replay":
        raise InputError(f"The {settings.name} plays back a recorded scan; it cannot be calibrated.")
    if settings.robot.is_real and operator is None:
        raise InputError(f"Nobody is there to confirm the motions of the arm of the {settings.name}.")
    shown = animated(settings) if observer.is_watching else settings
    with (
        connected(open_calibration_cell(shown, board), operator, reporter) as cell,
        observer.opened(cell),
        capturing_in(cell, cell_file, board, step, facts, reporter, operator, observer, n_wanted) as capture,
    ):
        yield capture


@contextmanager
def capturing_in(
    cell: Cell,
    cell_file: Path,
    board: BoardSpec,
    step: str,
    facts: dict[str, Any],
    reporter: Reporter,
    operator: ScanOperator | None,
    observer: CaptureObserver,
    n_wanted: int,
) -> Iterator[Capture]:
    """Let a cell look at the board that is connected and followed already.

    Raises:
        PoursightError: the camera gives no image, or the disk refuses.
    """
    settings = cell.settings
    with ExitStack() as stack:
        reporter.raise_if_cancelled()  # by a stop that came before there was an arm
        first = cell.camera.capture()
        folder = new_run(cell_file, step)
        moving: Moving = PlainMoving(cell, reporter)
        questions: RouteQuestions | None = None
        if settings.robot.is_real:
            assert operator is not None, "refused before it was connected"
            log = stack.enter_context(RunLog(folder / "motion"))
            questions = RouteQuestions(operator, cell.robot.name)
            moving = WatchedMoving(cell, log, reporter, questions)
        set_up = settings.simulation.set_up
        lens = Lens(first.intrinsics) if set_up is None else set_up.lens(first.intrinsics)
        height, width = first.depth_m.shape
        collection = Collection(
            cell.scene, board, first.intrinsics, (width, height), settings.camera.pose,
            np.array(settings.robot.home_rad), settings.camera.min_range_m, n_wanted,
        )  # fmt: skip
        i = first.intrinsics
        known = {
            "robot": cell.robot.name,
            "kinematics": cell.robot.kinematics.checksum,
            "camera": cell.camera.name,
            "intrinsics": [i.fx, i.fy, i.cx, i.cy],
            "size_px": [width, height],
        }
        yield Capture(cell, folder, facts | known, collection, lens, moving, questions, reporter, observer)


def find_board(capture: Capture) -> None:
    """See the board once: from where the arm is, or, in simulation, from the scan's views.

    Raises:
        StageError: it is not in sight; a person has to guide the arm.
    """
    look = capture.look_here()
    if look.view is not None:
        return
    settings = capture.cell.settings
    if settings.robot.is_real:
        raise StageError(
            f"{look.problem} Guide the arm by hand to where the camera sees the whole board, and begin again."
        )
    for joints in settings.scan.views_rad:
        capture.observer.control.wait_while_paused(capture.reporter)
        try:
            capture.moving.go(PlannedView("towards the board", joints))
        except MotionError:
            continue
        if capture.look_here().view is not None:
            return
    raise StageError(f"The board is in sight from none of the scan's views. {look.problem}")


def take_rounds(capture: Capture) -> None:
    """Go through rounds of proposed poses until there are enough usable views; one confirmation is for all.

    Raises:
        PoursightError: see `Capture.go_and_look`.
    """
    n_wanted, limit_m_s = capture.collection.n_wanted, capture.cell.settings.motion.tool_speed_m_s
    purpose = (
        f"Up to {n_wanted} views of the board, a few at a time: each route is planned and checked like this "
        f"one, is driven at most at {limit_m_s:.2f} m/s, and is not asked about again. The first: "
    )
    with nullcontext() if capture.questions is None else capture.questions.once(purpose):
        n_round = 0
        while True:
            capture.reporter.raise_if_cancelled()
            here = np.array(capture.cell.robot.state().joints_rad)
            poses = capture.collection.next_poses(here, n_round)
            if not poses:
                return
            capture.go_and_look(poses)
            n_round += 1


def _refuse_other_squares(square_m: float | None, board: BoardSpec) -> None:
    if square_m is not None and abs(square_m / board.square_m - 1) > _DEPTH_TOLERANCE:
        raise StageError(
            f"The camera's depth says that the squares of the board are {square_m * 1000:.1f} mm, not "
            f"{board.square_m * 1000:.1f} mm; measure them again, and enter what you measured."
        )
