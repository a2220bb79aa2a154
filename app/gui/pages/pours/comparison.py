"""Comparing the pours with others: a fixed direction, the previous run, another session."""

from __future__ import annotations

import os
import shutil
from dataclasses import dataclass, replace
from functools import partial
from math import degrees, pi, radians
from pathlib import Path

import numpy as np
from PySide6.QtCore import QCoreApplication, QObject, Signal
from PySide6.QtWidgets import (
    QComboBox,
    QDoubleSpinBox,
    QFileDialog,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from app.gui.desk.desk import Desk
from app.gui.theme import GRID_PX
from app.gui.views.labels import heading, rule, say, text_label
from app.jobs.session_work import SessionWork
from app.operations.session import SessionTask
from core.errors import SessionError
from core.geometry import FloatArray
from core.imagination.results import PourGrid
from core.parameters import apply_settings
from core.pipeline.session_view import ALL_IMAGINED, SessionView
from core.report import place_text
from core.report.sentences import ratio_text
from core.scratch import ScratchFolder

NOTHING, FIXED, BEFORE, OTHER = range(4)
SAME_DIRECTION_RAD = np.radians(0.5)
"""A direction this near to one of the grid's counts as that one: nothing new need be imagined."""
_LEFT_OUT = shutil.ignore_patterns(
    ".*", "pours", *ALL_IMAGINED, "motion", "evidence", "*.html", "operator_choice.json"
)
_ONLY_POURS = {
    "containability.verdict": "omega",
    "containability.omega_threshold": 0.0,
    "pouring.amount": "number",
    "risk.n_tries": 0,
}
"""Only P is compared: that the object is a container, and how much goes in, is known."""


@dataclass(frozen=True)
class OtherPours:
    """What is compared with.

    Attributes:
        label: what it is.
        grid: its pours.
    """

    label: str
    grid: PourGrid

    def ratios_for(self, grid: PourGrid) -> FloatArray:
        """P (I, J) of the other pours in the directions of `grid`: each from the other's nearest one."""
        ratios: FloatArray = self.grid.p[self._nearest(grid)]
        return ratios

    def farthest_rad(self, grid: PourGrid) -> float:
        """How far a direction of `grid` is from the one it is compared with, at most."""
        return float(angles_apart(grid.theta_rad, self.grid.theta_rad[self._nearest(grid)]).max())

    def _nearest(self, grid: PourGrid) -> np.ndarray:
        apart = angles_apart(grid.theta_rad[:, None], self.grid.theta_rad[None, :])
        return np.asarray(apart.argmin(axis=1))


def best_of(grid: PourGrid) -> tuple[int, int]:
    """Return (i, j) of the largest P; among equals the first."""
    i, j = np.unravel_index(int(grid.p.argmax()), grid.p.shape)
    return int(i), int(j)


def angles_apart(a_rad: FloatArray, b_rad: FloatArray) -> FloatArray:
    """Return how far angles are apart, 0 to pi."""
    apart: FloatArray = np.abs((a_rad - b_rad + pi) % (2 * pi) - pi)
    return apart


def one_direction(grid: PourGrid, theta_rad: float) -> PourGrid | None:
    """Return the pours of one direction of the grid; none if it has no such direction."""
    apart = angles_apart(grid.theta_rad, np.array(theta_rad))
    i = int(apart.argmin())
    if apart[i] > SAME_DIRECTION_RAD:
        return None
    row = slice(i, i + 1)
    return replace(
        grid,
        n_in=grid.n_in[row],
        n_spilled=grid.n_spilled[row],
        theta_rad=grid.theta_rad[row],
        pivot_m=grid.pivot_m[row],
        recordings=grid.recordings[row],
    )


def load_grid(session: Path) -> PourGrid:
    """Read the pours of another session.

    Raises:
        SessionError: it is no session, or holds no pours.
    """
    view = SessionView.of(session)
    if view.verdict is not None and not view.verdict.is_open_container:
        known = "is not known to be" if view.verdict.is_undecided else "is not"
        raise SessionError(
            f"The object of {session} {known} an open container: there are no pours to compare with."
        )
    if view.grid is None:
        raise SessionError(f"The session {session} holds no imagined pours to compare with.")
    return view.grid


def scratch_session(session: Path, home: Path) -> Path:
    """Copy a session up to its collision model into `home`, to imagine a variant in."""
    scratch = home / session.name
    shutil.copytree(session, scratch, ignore=_LEFT_OUT, copy_function=_link)
    return scratch


def _link(source: str, target: str) -> str:
    """Stages are replaced as a whole and never changed, so a second name for a file is as good as a copy."""
    try:
        os.link(source, target)
        return target
    except OSError:
        return str(shutil.copy2(source, target))


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
        self._home: ScratchFolder | None = None

    def start(self, theta_rad: float) -> None:
        """Imagine the session's object with a fixed direction; nothing happens while a job is under way."""
        if not self._desk.jobs.is_idle:
            return
        task = self._desk.workspace.task()
        self._home = ScratchFolder()
        copy = partial(scratch_session, task.folder, self._home.path)
        self._desk.background.run("scratch", copy, lambda scratch: self._imagine(scratch, task, theta_rad))

    def _imagine(self, scratch: Path, task: SessionTask, theta_rad: float) -> None:
        parameters = apply_settings(task.parameters, _ONLY_POURS | {"pouring.theta_fixed_rad": theta_rad})
        pours = SessionView.of(task.folder).pours
        if pours is not None:
            parameters = apply_settings(parameters, {"pouring.n_pour": pours.n_pour})
        self._desk.jobs.start(
            self.tr("Imagine pours from {deg:.0f}°").format(deg=degrees(theta_rad)),
            self._page,
            self._desk.session_host,
            SessionWork.imagine,
            SessionTask(scratch, parameters, task.preset),
            then=lambda _result: self._load(scratch, theta_rad),
        )

    def _load(self, scratch: Path, theta_rad: float) -> None:
        self._desk.background.run(
            "variant", partial(load_grid, scratch), lambda grid: self.imagined.emit(theta_rad, grid)
        )


class CompareBox(QWidget):
    """Chooses what to compare with and says how the two differ.

    Attributes:
        compared: the `OtherPours` that the map is compared with; none to end it.
        variant_wanted: a fixed direction, in radians from the base's x-axis, that has yet to be imagined.
        session_wanted: the folder of another session.
    """

    compared = Signal(object)
    variant_wanted = Signal(float)
    session_wanted = Signal(Path)

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("compare")
        self._grid: PourGrid | None = None
        self._before: PourGrid | None = None
        self._variants: dict[int, PourGrid] = {}
        self._other: OtherPours | None = None
        self._can_imagine = False
        self._with = QComboBox()
        self._with.setObjectName("compare_with")
        self._with.setAccessibleName(self.tr("Compare with"))
        for key, text in (
            (NOTHING, self.tr("nothing")),
            (FIXED, self.tr("a fixed direction (theta fixed)")),
            (BEFORE, self.tr("the previous run")),
            (OTHER, self.tr("another session…")),
        ):
            self._with.addItem(text, key)
        self._with.activated.connect(self._choose)
        self._said = text_label("comparison")
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX)
        column.addWidget(rule())
        column.addWidget(heading(self.tr("Compare with")))
        column.addWidget(self._with)
        column.addWidget(self._build_angle())
        column.addWidget(self._said)
        self._update()

    def _build_angle(self) -> QWidget:
        self._angle = QDoubleSpinBox()
        self._angle.setObjectName("fixed_angle")
        self._angle.setAccessibleName(self.tr("Fixed direction"))
        self._angle.setRange(0, 359)
        self._angle.setDecimals(0)
        self._angle.setSuffix("°")
        self._angle.setWrapping(True)
        self._angle.setToolTip(
            self.tr("theta, from the base's x-axis, in degrees (paper, Sec. V-B: 'w/ fixed theta')")
        )
        self._angle.valueChanged.connect(lambda _value: self._show_fixed())
        self._imagine = QPushButton(self.tr("Imagine it"))
        self._imagine.setObjectName("imagine_variant")
        self._imagine.setToolTip(
            self.tr("Imagine the 3 pours from this direction; the session stays as it is")
        )
        self._imagine.clicked.connect(lambda: self.variant_wanted.emit(radians(self._angle.value())))
        self._angle_row = QWidget()
        row = QHBoxLayout(self._angle_row)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(GRID_PX)
        row.addWidget(QLabel(self.tr("from")))
        row.addWidget(self._angle)
        row.addWidget(self._imagine)
        row.addStretch(1)
        return self._angle_row

    @property
    def other(self) -> OtherPours | None:
        """What the map is compared with."""
        return self._other

    def show_grid(self, grid: PourGrid | None, before: PourGrid | None) -> None:
        """Show a grid, and the previous one; a comparison goes on where it can.

        Args:
            grid: none: nothing to compare.
            before: of the previous run; none if this is the first.
        """
        self.setVisible(grid is not None)
        if grid is not self._grid:
            self._variants = {}
            if grid is not None:
                self._angle.blockSignals(True)
                self._angle.setValue(round(degrees(float(grid.theta_rad[0]))) % 360)
                self._angle.blockSignals(False)
            if self.mode in (FIXED, BEFORE):
                self._with.setCurrentIndex(NOTHING)
                self._take(None)
        self._grid, self._before = grid, before
        self._update()

    @property
    def mode(self) -> int:
        """What is chosen to compare with."""
        return int(self._with.currentData())

    def set_can_imagine(self, can_imagine: bool) -> None:
        """Say whether a variant can be imagined now."""
        self._can_imagine = can_imagine
        self._update()

    def show_variant(self, theta_rad: float, grid: PourGrid) -> None:
        """Compare with a fixed direction that was imagined for it."""
        self._variants[round(degrees(theta_rad)) % 360] = grid
        if self.mode == FIXED:
            self._show_fixed()

    def show_session(self, label: str, grid: PourGrid) -> None:
        """Compare with the pours of another session."""
        if self.mode == OTHER:
            self._take(OtherPours(label, grid))

    def show_problem(self, sentence: str) -> None:
        """Say why there is nothing to compare with."""
        self._take(None)
        say(self._said, sentence)

    def _choose(self) -> None:
        mode = self.mode
        self._take(None)
        if mode == FIXED:
            self._show_fixed()
        elif mode == BEFORE and self._before is not None:
            self._take(OtherPours(self.tr("the previous run"), self._before))
        elif mode == BEFORE:
            say(self._said, self.tr("There was no earlier run since the session was opened."))
        elif mode == OTHER:
            self._ask_for_session()

    def _show_fixed(self) -> None:
        if self.mode != FIXED or self._grid is None:
            return
        angle_deg = round(self._angle.value())
        row = one_direction(self._grid, radians(angle_deg))
        variant = row or self._variants.get(angle_deg)
        if variant is None:
            self._take(None)
            said = self.tr("{deg}° lies between the grid's directions: its 3 pours have to be imagined.")
            say(self._said, said.format(deg=angle_deg))
            return
        self._take(OtherPours(self.tr("fixed at {deg}°").format(deg=angle_deg), variant))
        if row is not None:
            said = self.tr("{deg}° is one of the grid's directions, so this needs no run of its own.")
            say(self._said, f"{self._said.text()} {said.format(deg=angle_deg)}")

    def _ask_for_session(self) -> None:
        folder = QFileDialog.getExistingDirectory(self, self.tr("Compare with the pours of a session"))
        if folder:
            self.session_wanted.emit(Path(folder))
        else:
            self._with.setCurrentIndex(NOTHING)
            self._update()

    def _take(self, other: OtherPours | None) -> None:
        self._other = other
        grid = self._grid
        say(self._said, "" if grid is None or other is None else comparison_sentence(grid, other))
        self.compared.emit(other)
        self._update()

    def _update(self) -> None:
        is_fixed = self.mode == FIXED
        self._angle_row.setVisible(is_fixed)
        self._imagine.setVisible(is_fixed and self._other is None)
        self._imagine.setEnabled(self._can_imagine)


def comparison_sentence(grid: PourGrid, other: OtherPours) -> str:
    """Say which of two grids has the better best pour, and by how much."""
    here, there = best_of(grid), best_of(other.grid)
    points = round(100 * (grid.p[here] - other.grid.p[there]))
    if points == 0:
        difference = _tr("just as good")
    else:
        difference = (_tr("{n} points worse") if points > 0 else _tr("{n} points better")).format(
            n=abs(points)
        )
    said = _tr(
        "Best here: {here} % from {here_place}. {label}: {there} % from {there_place}, {difference}."
    ).format(
        here=ratio_text(grid, *here),
        here_place=place_text(grid, *here),
        label=other.label[:1].upper() + other.label[1:],
        there=ratio_text(other.grid, *there),
        there_place=place_text(other.grid, *there),
        difference=difference,
    )
    apart_deg = degrees(other.farthest_rad(grid))
    if len(other.grid.theta_rad) > 1 and apart_deg > 1:
        differs = _tr(
            "Its directions differ by up to {deg:.0f}°; each pour is compared with the nearest one."
        )
        said += f" {differs.format(deg=apart_deg)}"
    return said


def _tr(text: str) -> str:
    return QCoreApplication.translate("Pours", text)
