"""The pours as a polar map: 8 directions by 3 distances, each with its P in per cent."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, isnan, radians

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, QSize, Qt, Signal
from PySide6.QtGui import QHelpEvent, QKeyEvent, QMouseEvent, QPaintEvent
from PySide6.QtWidgets import QSizePolicy, QToolTip, QWidget

from app.gui.views.pour_map_painter import RIM_PX, PourMapPainter, legend_px, place, points_text
from core.report.plot_geometry import PourMapLayout

_STEPS = {Qt.Key.Key_Left: (1, 0), Qt.Key.Key_Right: (-1, 0), Qt.Key.Key_Up: (0, 1), Qt.Key.Key_Down: (0, -1)}


@dataclass(frozen=True)
class MappedPour:
    """One pour as the map shows it.

    Attributes:
        i: index of the direction.
        j: index of the distance.
        theta_rad: direction from the pour centre to the pivot, from the base's x-axis.
        indent_m: L_idt, distance of the pivot from the pour centre.
        p: particle-in-object ratio P, 0..1, mean over the packings; NaN while it is not known.
        spread: standard deviation of P over the packings; None with one packing.
        is_feasible: whether the arm can make it; None when that was not checked yet.
        reason: why it is not feasible, or what is worth knowing of it.
        clean_at_least: chance that it spills nothing, lower 95 % bound, 0..1; None where no tries are known.
        n_tries: how often it was tried.
    """

    i: int
    j: int
    theta_rad: float
    indent_m: float
    p: float
    spread: float | None = None
    is_feasible: bool | None = None
    reason: str = ""
    clean_at_least: float | None = None
    n_tries: int = 0


class PourMap(QWidget):
    """Polar map of the pours, seen from above; base x points right, y up, unless it is rotated.

    Attributes:
        selected: (i, j) the user picked with mouse or keys; not sent by `select`.
    """

    selected = Signal(int, int)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("pour_map")
        self.setAccessibleName(self.tr("Map of the pours"))
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMouseTracking(True)
        policy = QSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setSizePolicy(policy)
        self._cells: dict[tuple[int, int], MappedPour] = {}
        self._chosen: tuple[int, int] | None = None
        self._selection: tuple[int, int] | None = None
        self._rotation_deg = 0.0
        self._other: NDArray[np.float64] | None = None
        self._other_label = ""
        self._wants_clean = True

    @property
    def selection(self) -> tuple[int, int] | None:
        """(i, j) of the outlined pour."""
        return self._selection

    @property
    def rotation_deg(self) -> float:
        """How far the map is rotated, anticlockwise."""
        return self._rotation_deg

    def set_pours(self, cells: Sequence[MappedPour], chosen: tuple[int, int] | None) -> None:
        """Show the pours of one grid and which was chosen; none: an empty map that says so.

        The comparison is dropped when the grid's shape changes. The selection goes to the chosen pour, unless
        somebody has selected another that is still there.
        """
        was_moved = self._selection != self._chosen
        self._cells = {(cell.i, cell.j): cell for cell in cells}
        self._chosen = chosen if chosen in self._cells else None
        if not was_moved or self._selection not in self._cells:
            self._selection = self._chosen
        if self._other is not None and self._other.shape != self.shape:
            self._other = None
        self._refresh()

    def set_comparison(self, p: NDArray[np.float64] | None, label: str = "") -> None:
        """Write in each cell by how much its P is above or below another grid's.

        Args:
            p: (I, J) P of the other grid, 0..1, in the shape of this one; None ends the comparison.
            label: what the other one is, such as "theta fixed".

        Raises:
            ValueError: the shapes differ.
        """
        if p is not None and p.shape != self.shape:
            raise ValueError(f"the other grid is {p.shape}, this one {self.shape}")
        self._other = p
        self._other_label = label
        self._refresh()

    @property
    def has_clean(self) -> bool:
        """Whether the chance that nothing is spilled is known of every pour."""
        return bool(self._cells) and all(cell.clean_at_least is not None for cell in self._cells.values())

    @property
    def shows_clean(self) -> bool:
        """Whether cells are coloured by that chance and not by P; a comparison is of P."""
        return self._wants_clean and self.has_clean and self._other is None

    def show_clean(self, is_wanted: bool) -> None:
        """Colour the cells by the chance that nothing is spilled, where it is known, or by P."""
        self._wants_clean = is_wanted
        self._refresh()

    def select(self, i: int, j: int) -> None:
        """Outline a pour, without a signal; one that is not there ends the selection."""
        self._selection = (i, j) if (i, j) in self._cells else None
        self._refresh()

    def set_rotation(self, deg: float) -> None:
        """Rotate the map anticlockwise, as the 3D view is; numbers stay upright."""
        self._rotation_deg = deg
        self.update()

    @property
    def shape(self) -> tuple[int, int]:
        """Number of directions and of distances."""
        return (
            1 + max((i for i, _ in self._cells), default=-1),
            1 + max((j for _, j in self._cells), default=-1),
        )

    def cell_center(self, i: int, j: int) -> QPointF:
        """Return where on the widget a pour's cell has its middle, px."""
        return place(self._center(), *self._layout().middle(i, j))

    def describe(self, i: int, j: int) -> str:
        """Return everything known of a pour, a line each."""
        cell = self._cells[i, j]
        lines = [
            self.tr("direction {deg:.0f}° from the base's x-axis").format(deg=degrees(cell.theta_rad)),
            self.tr("pivot {mm:.1f} mm from the pour centre (L_idt)").format(mm=1000 * cell.indent_m),
            self._describe_p(cell),
        ]
        if cell.clean_at_least is not None:
            lines.append(
                self.tr("clean pour: at least {percent:.0f} % likely, after {n} tries").format(
                    percent=100 * cell.clean_at_least, n=cell.n_tries
                )
            )
        if self._other is not None:
            lines.append(
                self.tr("{points} points against {label} ({percent:.0f} %)").format(
                    points=points_text(cell.p - float(self._other[i, j])),
                    label=self._other_label,
                    percent=100 * self._other[i, j],
                )
            )
        if cell.is_feasible is None:
            lines.append(self.tr("not yet checked with the arm"))
        elif cell.is_feasible:
            lines.append(self.tr("the arm can make it"))
        else:
            lines.append(self.tr("the arm cannot make it"))
        if cell.reason:
            lines[-1] += ": " + cell.reason
        if (i, j) == self._chosen:
            lines.insert(0, self.tr("chosen"))
        return "\n".join(lines)

    def _describe_p(self, cell: MappedPour) -> str:
        if isnan(cell.p):
            return self.tr("not imagined yet")
        if cell.spread is None:
            return self.tr("P {percent:.0f} % (one packing)").format(percent=100 * cell.p)
        return self.tr("P {percent:.0f} ± {spread:.0f} % over the packings").format(
            percent=100 * cell.p, spread=100 * cell.spread
        )

    def sizeHint(self) -> QSize:
        """Return a good size."""
        return QSize(400, 400 + legend_px(self.font()))

    def minimumSizeHint(self) -> QSize:
        """Return the smallest legible size."""
        return QSize(320, 320 + legend_px(self.font()))

    def _layout(self) -> PourMapLayout:
        n_directions, n_rings = self.shape
        rotation_rad = radians(self._rotation_deg)
        thetas = (self._cells[i, 0].theta_rad + rotation_rad for i in range(n_directions))
        radius = max(min(self._center().x(), self._center().y()) - RIM_PX, 40.0)
        return PourMapLayout(tuple(thetas), max(n_rings, 3), radius)

    def _center(self) -> QPointF:
        return QPointF(self.width() / 2, (self.height() - legend_px(self.font())) / 2)

    def _cell_at(self, point: QPointF) -> tuple[int, int] | None:
        offset = point - self._center()
        found = self._layout().cell_at(offset.x(), -offset.y())
        return found if found in self._cells else None

    def _pick(self, found: tuple[int, int]) -> None:
        if found != self._selection:
            self._selection = found
            self._refresh()
            self.selected.emit(*found)

    def _refresh(self) -> None:
        said = self.describe(*self._selection) if self._selection else ""
        self.setAccessibleDescription(said.replace("\n", ", "))
        self.update()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Pick the pour under the mouse."""
        found = self._cell_at(event.position())
        if event.button() == Qt.MouseButton.LeftButton and found is not None:
            self._pick(found)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Show a hand over what can be picked."""
        is_over = self._cell_at(event.position()) is not None
        self.setCursor(Qt.CursorShape.PointingHandCursor if is_over else Qt.CursorShape.ArrowCursor)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Move the selection with the arrows: around, and out or in."""
        step = _STEPS.get(Qt.Key(event.key()))
        if step is None or not self._cells:
            super().keyPressEvent(event)
            return
        if self._selection is None:
            self._pick(self._chosen or min(self._cells))
            return
        n_directions, n_rings = self.shape
        i, j = self._selection
        self._pick(((i + step[0]) % n_directions, min(max(j + step[1], 0), n_rings - 1)))

    def event(self, event: QEvent) -> bool:
        """Show all that is known of the pour under the mouse, or what the map shows."""
        if isinstance(event, QHelpEvent) and event.type() == QEvent.Type.ToolTip:
            found = self._cell_at(QPointF(event.pos()))
            text = self._legend() if found is None else self.describe(*found)
            QToolTip.showText(event.globalPos(), text, self)
            return True
        return super().event(event)

    def _legend(self) -> str:
        return self.tr(
            "Each cell is a pour: its direction from the pour centre and its distance from it.\n"
            "{number}\n"
            "The arc at the inner edge is the spread over the packings; a full one is 25 points or more.\n"
            "Hatched: the arm cannot make it. Star: chosen. Arrow keys move the selection."
        ).format(number=self._number_words())

    def _number_words(self) -> str:
        if self.shows_clean:
            return self.tr(
                "The large number: a pour that spills nothing is at least so likely, in per cent, with 95 % "
                "confidence.\nThe small one is P: how many candies landed inside, on average."
            )
        return self.tr("The number is P in per cent: how many candies landed inside, on average.")

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint the cells, then what lies over them."""
        painter = PourMapPainter(self, self._layout(), self._center())
        painter.paint_rings()
        if not self._cells:
            painter.paint_empty(self.tr("The pours appear here\nonce they have been imagined"))
        for key, cell in self._cells.items():
            if isnan(cell.p):
                continue
            small = self._small_text(cell)
            away_px = 3.0 if key == self._chosen and small else 0.0
            painter.paint_cell(
                *key, self._value(cell), small, cell.spread, cell.is_feasible is False, away_px
            )
        if self._chosen is not None:
            painter.paint_chosen(*self._chosen, self._value(self._cells[self._chosen]))
        if self._selection is not None:
            painter.paint_selected(*self._selection, self.hasFocus())
        painter.paint_rim(self._rotation_deg, bool(self._cells))
        title = self.tr("Clean pour, at least") if self.shows_clean else self.tr("Candies inside (P)")
        painter.paint_legend(title, self._legend_words(), bool(self._cells))
        painter.end()

    def _value(self, cell: MappedPour) -> float:
        """What the colour and the large number tell, 0 to 1."""
        if self.shows_clean and cell.clean_at_least is not None:
            return cell.clean_at_least
        return cell.p

    def _small_text(self, cell: MappedPour) -> str:
        if self._other is not None:
            return points_text(cell.p - float(self._other[cell.i, cell.j]))
        return self.tr("P {percent:.0f}").format(percent=100 * cell.p) if self.shows_clean else ""

    def _legend_words(self) -> list[str]:
        """What the small numbers and the rings are."""
        if not self._cells:
            return []
        words = []
        if self.shows_clean:
            words.append(self.tr("P: candies inside on average, %"))
        elif self._other is not None:
            words.append(self.tr("± to {label}").format(label=self._other_label))
        indents = [self._cells[0, j].indent_m for j in range(self.shape[1])]
        distances = ", ".join(f"{1000 * indent:.0f}" for indent in indents)
        words.append(self.tr("rings: pivot {mm} mm from the centre").format(mm=distances))
        return words

    def changeEvent(self, event: QEvent) -> None:
        """Repaint in another theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.update()
