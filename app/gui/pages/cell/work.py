"""What the Cell page starts."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QCoreApplication

from app.gui.desk.desk import Desk
from app.gui.desk.jobs import RunningJob
from app.gui.pages.cell.side import StepOptions
from app.jobs.cell_work import CellWork
from app.operations.calibration import crop, step_names, steps, touch, undoing
from app.operations.calibration.cell_file import known_cells, new_cell
from app.operations.calibration.cup_entry import read_taught_station
from core.errors import PoursightError

_PATIENCE_REAL_S = 4.0
"""A real arm comes to rest before its process may be ended."""
_IN_BACKGROUND = "cell.step"


class CellJobs:
    """Does the steps of the chosen cell: those with devices as jobs, the others in the background."""

    def __init__(self, desk: Desk, page: str) -> None:
        self._desk = desk
        self._page = page
        self._job: RunningJob | None = None
        self.step = ""
        """That was started last."""
        self.is_live = False
        """Whether it shows what the camera sees, and does nothing else."""

    @property
    def is_running(self) -> bool:
        """Whether one of the steps is under way as a job."""
        running = self._desk.jobs.running
        return running is not None and running is self._job

    def make(self, name: str, is_simulated: bool, address: str | None) -> None:
        """Make a new cell, and choose it."""
        make = partial(_new_cell, name, is_simulated, address)
        self._desk.background.run(_IN_BACKGROUND, make, self._desk.cell.choose)

    def do(self, step: str, title: str, options: StepOptions, *, is_restarted: bool = False) -> None:
        """Do a step.

        Raises:
            InputError: there can be no board as it was entered.
        """
        path = self._path()
        if step == step_names.BOARD:
            enter = partial(
                steps.enter_board, path, options.measured_board, options.paper, options.measured_m
            )
            self._desk.background.run(_IN_BACKGROUND, enter, lambda _: self.read_again())
        elif step in (step_names.ARM, step_names.CAMERA):
            self._start(step, title, CellWork.examine, path, step)
        elif step == step_names.HAND_EYE:
            self._start(step, title, CellWork.calibrate, path, options.n_views, is_restarted)
            if self._job is not None:  # what was taken since is used
                self._job.start_again = partial(self.do, step, title, options)
        elif step == step_names.CHECK:
            self._start(step, title, CellWork.check, path)
        elif step == step_names.TABLE:
            self._start(step, title, CellWork.measure_table, path, options.thickness_m)
        elif step == step_names.REFERENCE:
            self._start(step, title, CellWork.store_reference, path)
        elif step == step_names.CUP:
            self._start(step, title, CellWork.enter_cup, path, options.cup.entry)
        elif step == step_names.DRY_RUN:
            self._start(step, title, CellWork.dry_run, path)
        else:
            assert step == step_names.VIEWS, "there are no others"
            self._start(step, title, CellWork.choose_views, path, options.n_scan_views)

    def watch_camera(self, title: str) -> None:
        """Show what the camera sees until it is cancelled."""
        self._start(step_names.CAMERA, title, CellWork.watch_camera, self._path())
        self.is_live = self.is_running
        if self._job is not None and self.is_live:
            self._job.is_endless = True

    def print_board(self, options: StepOptions, then: Callable[[Path], None]) -> None:
        """Write the board's PDF; raises as `do` does."""
        write = partial(steps.enter_board, self._path(), options.printed_board, options.paper, None)

        def written(pdf: Path) -> None:
            self.read_again()
            then(pdf)

        self._desk.background.run(_IN_BACKGROUND, write, written)

    def read_station(self, then: Callable[[tuple[float, float, float]], None]) -> None:
        """Read where the hand was guided to."""
        self._desk.background.run(_IN_BACKGROUND, partial(read_taught_station, self._path()), then)

    def read_touch(self, tip_m: tuple[float, ...]) -> None:
        """Read the corner of the board that the hand's tip touches, (3,) in the flange frame."""
        read = partial(touch.read_touch, self._path(), np.array(tip_m))
        self._desk.background.run(_IN_BACKGROUND, read, lambda _: self.read_again())

    def enter_crop_box(
        self, low_m: npt.ArrayLike, high_m: npt.ArrayLike, refused: Callable[[PoursightError], None]
    ) -> None:
        """Put another crop box, corners (3,) in metres, into the cell's file, which is shown again."""
        enter = partial(crop.enter_crop_box, self._path(), low_m, high_m)

        def say(error: PoursightError) -> None:
            refused(error)
            self.read_again()

        self._desk.background.run(_IN_BACKGROUND, enter, lambda _: self.read_again(), say)

    def undo(self, step: str) -> None:
        """Take back a step."""
        undo = partial(undoing.undo, self._path(), step)
        self._desk.background.run(_IN_BACKGROUND, undo, lambda _: self.read_again())

    def pause(self) -> None:
        """Let the arm rest after the current view."""
        self._desk.jobs.pause(CellWork.pause)

    def resume(self) -> None:
        """Go on; where a job asks, that says yes."""
        self._desk.jobs.resume(CellWork.resume)

    def read_again(self) -> None:
        """Read the cell's file, which a step may have changed."""
        self._desk.cell.choose(self._desk.cell.path)

    def _path(self) -> Path:
        path = self._desk.cell.path
        assert path is not None, "the page offers no step of the cell that the program ships"
        return path

    def _start(self, step: str, title: str, method: Callable[..., object], *arguments: object) -> None:
        desk = self._desk
        if not desk.jobs.is_idle:
            return
        self.step, self.is_live = step, False
        desk.scan_host.order(CellWork.get_ready)
        patience_s = 1.0 if desk.cell.is_simulated else _PATIENCE_REAL_S
        done = QCoreApplication.translate("CellPage", "{title}: done.").format(title=title)
        desk.jobs.start(
            title, self._page, desk.scan_host, method, *arguments, patience_s=patience_s, done=done
        )
        self._job = desk.jobs.running


def _new_cell(name: str, is_simulated: bool, address: str | None) -> Path:
    return new_cell(name, is_simulated, len(known_cells()), address)
