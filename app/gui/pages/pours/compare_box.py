"""What the pours are compared with: a fixed direction, the run before, another session."""

from __future__ import annotations

from math import degrees, radians
from pathlib import Path

from PySide6.QtCore import Signal
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

from app.gui.pages.pours.comparison import OtherPours, one_direction
from app.gui.pages.pours.words import comparison_sentence
from app.gui.theme import GRID_PX
from app.gui.views.labels import heading, rule, say, text_label
from core.imagination.results import PourGrid

NOTHING, FIXED, BEFORE, OTHER = range(4)


class CompareBox(QWidget):
    """Chooses what to compare with and says how the two differ.

    Attributes:
        compared: the `OtherPours` to hold against the map; none to end it.
        variant_wanted: a fixed direction, in radians against the base's x-axis, that has yet to be imagined.
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
            (BEFORE, self.tr("the run before this one")),
            (OTHER, self.tr("another session...")),
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
            self.tr("theta, against the base's x-axis, in degrees (paper, Sec. V-B: 'w/ fixed theta')")
        )
        self._angle.valueChanged.connect(lambda _value: self._show_fixed())
        self._imagine = QPushButton(self.tr("Imagine it"))
        self._imagine.setObjectName("imagine_variant")
        self._imagine.setToolTip(self.tr("Imagine the 3 pours of this direction; the session stays as it is"))
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
        """Show a grid, and the one before it; a comparison goes on where it can.

        Args:
            grid: none: nothing to compare.
            before: of the run before; none if this is the first.
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
        """Tell whether a variant can be imagined now."""
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
            self._take(OtherPours(self.tr("the run before"), self._before))
        elif mode == BEFORE:
            say(self._said, self.tr("There is no run before this one since the session was opened."))
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
        known = other is not None and self._grid is not None
        say(self._said, comparison_sentence(self._grid, other) if known and self._grid and other else "")
        self.compared.emit(other)
        self._update()

    def _update(self) -> None:
        is_fixed = self.mode == FIXED
        self._angle_row.setVisible(is_fixed)
        self._imagine.setVisible(is_fixed and self._other is None)
        self._imagine.setEnabled(self._can_imagine)
