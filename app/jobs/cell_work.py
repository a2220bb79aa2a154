"""Setting up a cell, for the host process that scans: whoever stops the arm there stops either."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from app.jobs.cell_events import BoardSought, CameraSeen, LooksPlanned
from app.jobs.scan_work import PausingOperator, ScanReporter, ScanWork, planned_pose, watched_cell
from app.jobs.service import JobReporter
from core.errors import Cancelled

if TYPE_CHECKING:
    from app.operations.calibration.capture import CaptureObserver
    from app.operations.calibration.cup_entry import CupEntry
    from core.calibration.collecting import Look
    from core.calibration.proposing import Proposal
    from core.geometry import FloatArray
    from core.motion.pour.plan import PlannedMove, PourPlan
    from core.session.cups import Cup
    from hardware.cell.settings import CellSettings
    from hardware.interfaces import CameraImage

_LIVE_S = 0.2
"""From image to image, for somebody who points a camera and looks; fewer than it can take."""


class CellWork(ScanWork):
    """Takes the views of an object, and sets the cell up in which it does."""

    def examine(self, reporter: JobReporter, cell_file: Path, step: str) -> None:  # noqa: ARG002
        """Try the arm or the camera; see `examine_device`."""
        from app.operations.calibration.devices import examine_device

        examine_device(cell_file, step)

    def watch_camera(self, reporter: JobReporter, cell_file: Path) -> None:
        """Publish what the camera sees until it is cancelled: `CameraSeen`.

        Raises:
            PoursightError: the camera does not answer.
        """
        from hardware.cell import read_cell
        from hardware.cell.examination import camera_alone

        camera = camera_alone(read_cell(cell_file))
        with camera, suppress(Cancelled):
            while True:
                begun_s = time.monotonic()
                image = camera.capture()
                reporter.raise_if_cancelled()
                reporter.publish(CameraSeen(image.color, image.depth_m))
                time.sleep(max(_LIVE_S - (time.monotonic() - begun_s), 0.0))

    def calibrate(self, reporter: JobReporter, cell_file: Path, n_views: int, is_restarted: bool) -> None:
        """Calibrate where the camera hangs; publishes the events of `cell_events` and `arm_events`.

        Raises:
            PoursightError: see `calibrate_cell`.
        """
        from app.operations.calibration.hand_eye import calibrate_cell

        def work(operator: PausingOperator, observer: CaptureObserver) -> None:
            calibrate_cell(cell_file, reporter, operator, observer, n_views, is_restarted)

        self._look(reporter, cell_file, n_views, work)

    def check(self, reporter: JobReporter, cell_file: Path) -> None:
        """Check the calibration with the board elsewhere; see `calibrate`."""
        from app.operations.calibration.around import N_VIEWS
        from app.operations.calibration.check import check_cell

        def work(operator: PausingOperator, observer: CaptureObserver) -> None:
            moved = partial(
                operator.ask, "Move the board elsewhere and turn it, so that the camera still sees all of it."
            )
            check_cell(cell_file, reporter, operator, moved, observer)

        self._look(reporter, cell_file, N_VIEWS + 1, work)

    def measure_table(self, reporter: JobReporter, cell_file: Path, thickness_m: float) -> None:
        """Measure platform and table by the board on them; see `calibrate`."""
        from app.operations.calibration.around import N_VIEWS
        from app.operations.calibration.table import measure_table

        def work(operator: PausingOperator, observer: CaptureObserver) -> None:
            laid = partial(
                operator.ask,
                "Lay the board flat on the middle of the platform, where the camera sees all of it.",
            )
            measure_table(cell_file, reporter, operator, laid, thickness_m, observer)

        self._look(reporter, cell_file, N_VIEWS + 1, work)

    def store_reference(self, reporter: JobReporter, cell_file: Path) -> None:
        """Store one view of the board, which stays; see `calibrate`."""
        from app.operations.calibration.reference import store_reference

        def work(operator: PausingOperator, observer: CaptureObserver) -> None:
            laid = partial(
                operator.ask, "Fix the board where it can stay during scans, in sight of the camera."
            )
            store_reference(cell_file, reporter, operator, laid, observer)

        self._look(reporter, cell_file, 1, work)

    def choose_views(self, reporter: JobReporter, cell_file: Path, n_views: int) -> None:
        """Choose the views of a scan; see `app.operations.calibration.views.choose_views`."""
        from app.operations.calibration.views import choose_views

        choose_views(cell_file, reporter, n_views)

    def enter_cup(self, reporter: JobReporter, cell_file: Path, entry: CupEntry) -> None:
        """Enter the cup; see `app.operations.calibration.cup.enter_cup`."""
        from app.operations.calibration.cup import enter_cup

        enter_cup(cell_file, entry, reporter)

    def dry_run(self, reporter: JobReporter, cell_file: Path) -> None:
        """Let the arm go through a pour with an empty cup; publishes the events of `arm_events`.

        Raises:
            PoursightError: see `app.operations.calibration.dry_run.dry_run`.
        """
        from app.operations.calibration.dry_run import dry_run
        from hardware.cell import read_cell

        progress = ScanReporter(reporter.publish, read_cell(cell_file))
        with self._under_way(reporter) as running:
            opened = partial(watched_cell, running, progress)
            dry_run(cell_file, reporter, PouringOperator(running), opened)

    def _look(
        self,
        reporter: JobReporter,
        cell_file: Path,
        n_wanted: int,
        work: Callable[[PausingOperator, CaptureObserver], None],
    ) -> None:
        from app.operations.calibration.capture import CaptureObserver
        from hardware.cell import read_cell

        settings = read_cell(cell_file)
        progress = ScanReporter(reporter.publish, settings)
        with self._under_way(reporter) as running:
            looks = _LookReporter(reporter, settings, n_wanted)
            opened = partial(watched_cell, running, progress)
            observer = CaptureObserver(
                opened, looks.planned, looks.taken, is_watching=True, control=running.control
            )
            work(PausingOperator(running), observer)


class PouringOperator(PausingOperator):
    """Asks what a dry run asks: Cancel ends it, with the arm at rest where it is."""

    def confirm_pour(self, plan: PourPlan, note: str, robot: str, cup: Cup) -> None:  # noqa: ARG002
        """Publish how long it takes, and wait."""
        self.ask(
            f"Is the platform empty, and the empty cup on its station? The {robot} makes "
            f"{len(plan.moves)} moves in {plan.duration_s:.0f} s, and waits for your word before each."
        )

    def confirm_move(self, move: PlannedMove) -> None:
        """Publish which move is next, and wait."""
        self.ask(f"Next: {move.label}, {move.trajectory.duration_s:.0f} s.")

    def is_cup_in_hand(self, known: str) -> bool:
        """Publish what is known, and wait."""
        self.ask(
            f"The gripper is closed. {known} If the hand holds the cup as that run did, it is brought back."
        )
        return True

    def confirm_opening(self, gripper: str, known: str) -> None:
        """Publish what is known, and wait."""
        self.ask(
            f"{known} Hold what is in the hand of the {gripper}: it opens where the arm stands.".lstrip()
        )

    def confirm_back_off(self, moves: Sequence[PlannedMove]) -> None:
        """Publish the moves, and wait."""
        names = ", ".join(move.label for move in moves)
        self.ask(f"The arm backs off along its checked path, and puts the cup back ({names}).")

    def backed_off(self) -> None:
        """The next dry run is planned and confirmed anew."""


class _LookReporter:
    """Publishes the looks of one run."""

    def __init__(self, reporter: JobReporter, settings: CellSettings, n_wanted: int) -> None:
        self._reporter, self._n_wanted = reporter, n_wanted
        self._settings = settings
        self._n_looks = 0

    def planned(self, poses: Sequence[Proposal]) -> None:
        """Publish from where the arm will look."""
        flanges = np.array([pose.T_base_flange for pose in poses]).reshape(-1, 4, 4)
        self._reporter.publish(LooksPlanned(flanges @ self._settings.camera.pose))

    def taken(self, look: Look, n_usable: int, image: CameraImage | None) -> None:
        """Publish what became of a look."""
        self._n_looks += 1
        view = look.view
        T_base_camera = self._camera_pose(look)
        self._reporter.publish(
            BoardSought(
                self._n_looks,
                n_usable,
                look.problem,
                T_base_camera,
                None if view is None else T_base_camera @ view.T_camera_board,
                np.empty((0, 2)) if view is None else view.corners_px,
                None if image is None else image.color,
            )
        )
        self._reporter.progress("views", min(n_usable, self._n_wanted), self._n_wanted)

    def _camera_pose(self, look: Look) -> FloatArray:
        if look.view is None:
            return planned_pose(self._settings, look.joints_rad.tolist())
        pose: FloatArray = look.view.T_base_flange @ self._settings.camera.pose
        return pose
