"""Imagining the pours of one fixed direction beside the session, to compare with."""

from __future__ import annotations

from functools import partial
from math import degrees
from pathlib import Path
from tempfile import TemporaryDirectory

from PySide6.QtCore import QObject, Signal

from app.gui.desk.desk import Desk
from app.gui.pages.pours.comparison import load_grid, scratch_session
from app.jobs.session_work import SessionTask, SessionWork
from core.imagination.results import PourGrid, imagined_n_pour
from core.parameters import apply_settings

_ONLY_POURS = {
    "containability.verdict": "omega",
    "containability.omega_threshold": 0.0,
    "pouring.amount": "number",
    "risk.n_tries": 0,
}
"""Only P is compared: that it is a container, and how much goes in, is known."""


class VariantRun(QObject):
    """Runs one variant at a time in a scratch session, which lasts until the next one or the program's end.

    Attributes:
        imagined: the direction in radians and its `PourGrid`.
    """

    imagined = Signal(float, object)

    def __init__(self, desk: Desk, page: str, parent: QObject) -> None:
        super().__init__(parent)
        self._desk = desk
        self._page = page
        self._home: TemporaryDirectory[str] | None = None

    def start(self, theta_rad: float) -> None:
        """Imagine the session's object with a fixed direction; nothing happens while a job is under way."""
        if not self._desk.jobs.is_idle:
            return
        task = self._desk.workspace.task()
        self._home = TemporaryDirectory(prefix="poursight-variant-", ignore_cleanup_errors=True)
        copy = partial(scratch_session, task.folder, Path(self._home.name))
        self._desk.background.run("scratch", copy, lambda scratch: self._imagine(scratch, task, theta_rad))

    def _imagine(self, scratch: Path, task: SessionTask, theta_rad: float) -> None:
        parameters = apply_settings(task.parameters, _ONLY_POURS | {"pouring.theta_fixed_rad": theta_rad})
        n_pour = imagined_n_pour(task.folder / "pouring")
        if n_pour is not None:
            parameters = apply_settings(parameters, {"pouring.n_pour": n_pour})
        self._desk.jobs.start(
            self.tr("Imagine pours from {deg:.0f}°").format(deg=degrees(theta_rad)),
            self._page,
            self._desk.session_host,
            SessionWork.imagine,
            SessionTask(scratch, parameters, task.preset),
            then=lambda _result: self._load(scratch, theta_rad),
        )

    def _load(self, scratch: Path, theta_rad: float) -> None:
        def tell(grid: PourGrid) -> None:
            self.imagined.emit(theta_rad, grid)

        self._desk.background.run("variant", partial(load_grid, scratch), tell)
