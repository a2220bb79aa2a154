"""The verdict with its reason, the footprint, and the parameters."""

from __future__ import annotations

from math import degrees, isfinite, isinf

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QPushButton, QSizePolicy, QStackedWidget, QVBoxLayout, QWidget

from app.gui.desk.desk import Desk
from app.gui.pages.fact_grid import Fact, FactGrid
from app.gui.pages.imagination.loading import ShownDrop
from app.gui.pages.imagination.sentences import Sentences
from app.gui.pages.mode_row import ModeRow
from app.gui.pages.page import SidePanel
from app.gui.pages.parameters_part import ParametersPart, n_different
from app.gui.pages.staleness import StaleNote
from app.gui.theme import GRID_PX
from app.gui.views.footprint import FootprintView
from app.gui.views.labels import text_label
from app.gui.views.omega_bar import OmegaBar
from core.imagination.holding.words import holding_sentence
from core.report.sentences import verdict_sentence

MM = 1000.0
GROUPS = (
    "seed",
    "collision",
    "particle",
    "solver",
    "containability",
    "capacity",
    "holding",
    "pouring",
    "risk",
)
_LOWER_PX = 38 * GRID_PX
"""Of footprint or editor, at the least."""


class VerdictSide(SidePanel):
    """What was found, and what it was found with.

    Signals: `empty_wanted` when the button of the empty state is pressed.

    Attributes:
        pages: footprint or parameters.
    """

    empty_wanted = Signal()

    def __init__(self, desk: Desk) -> None:
        super().__init__(self.tr("Imagine"))
        self._sentences = Sentences(self)
        self._verdict = text_label("drop_verdict", "verdict")
        self._reason = text_label("drop_reason")
        self._failed = text_label("drop_failed", "failed")
        self._empty_button = QPushButton()
        self._empty_button.setObjectName("drop_empty_button")
        self._empty_button.clicked.connect(self.empty_wanted)
        self.stale = StaleNote(("reconstruction", "collision", "containability"))
        self.omega = OmegaBar()
        self._desk = desk
        self._parameters: ParametersPart | None = None
        self.pages = ModeRow("side_page")
        self.pages.add("footprint", self.tr("Footprint"), self.tr("From above: which candies stayed"))
        self.pages.add("parameters", "", self.tr("What the next run is imagined with"))
        self.pages.chosen.connect(self._turn)
        self._stack = QStackedWidget()
        self._result = self._make_result()
        self._stack.addWidget(self._result)
        self._stack.setMinimumHeight(_LOWER_PX)
        # it takes the room there is: by its size hint, the panel would scroll long before it has to
        self._stack.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Ignored)
        for widget in (
            self._verdict,
            self._reason,
            self._failed,
            self._empty_button,
            self.stale,
            self.omega,
            self.pages,
        ):
            self.body.addWidget(widget)
        self.body.addWidget(self._stack, 1)
        self._failed.hide()
        desk.workspace.parameters_changed.connect(self._count)
        self._count()

    def _make_result(self) -> QWidget:
        self.footprint = FootprintView()
        self.facts = FactGrid("drop_facts")
        self.facts.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        result = QWidget()
        column = QVBoxLayout(result)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX)
        column.addWidget(self.footprint, 1)
        column.addWidget(self.facts)
        return result

    @property
    def parameters(self) -> ParametersPart:
        """The parameters; made when they are first wanted."""
        if self._parameters is None:
            self._parameters = ParametersPart(self._desk, GROUPS)
            self._stack.addWidget(self._parameters)
        return self._parameters

    def _turn(self, page: str) -> None:
        self._stack.setCurrentWidget(self.parameters if page == "parameters" else self._result)

    def _count(self) -> None:
        n = n_different(self._desk.workspace, GROUPS)
        text = self.tr("Parameters")
        differing = self.tr("1 differs") if n == 1 else self.tr("{n} differ").format(n=n)
        self.pages.set_text("parameters", f"{text} ({differing})" if n else text)

    def show_failure(self, sentence: str) -> None:
        """Say why the result cannot be shown; empty: it can."""
        self._failed.setText(sentence)
        self._failed.setVisible(bool(sentence))

    def show_empty(self, sentence: str, button: str) -> None:
        """Show what will be here, and the button that leads there; an empty text leaves the button away."""
        self._verdict.setText(sentence)
        self._reason.hide()
        self._empty_button.setText(button)
        self._empty_button.setVisible(bool(button))
        self.omega.hide()
        self.footprint.clear()
        self.facts.set_facts([])

    def show_drop(self, drop: ShownDrop) -> None:
        """Show what was found."""
        found = drop.containability
        footprint = found.footprint
        self._empty_button.hide()
        self._verdict.setText(verdict_sentence(found))
        self._reason.setText(self._sentences.reason(found, drop.n_on_top))
        self._reason.show()
        self.omega.set_values(found.omega, found.omega_threshold)
        self.omega.show()
        self.footprint.set_footprint(
            found.drop_positions_m[:, :2],
            found.retained,
            drop.outline_m,
            None if footprint is None else footprint.center_m[:2],
            0.0 if footprint is None else footprint.axis_rad,
            drop.indents_m,
        )
        self.facts.set_facts(self._facts(drop))

    def _holding_facts(self, drop: ShownDrop) -> list[Fact]:
        capacity, holding = drop.capacity, drop.holding
        if capacity is None or holding is None:
            return []
        held = self.tr("{n:.0f} candies, {ml:.0f} ml").format(n=capacity.n_candies, ml=capacity.bulk_ml)
        tilt = self._tilt(holding.first_rad, holding.tilt_rad[-1])
        if isfinite(holding.first_rad):
            tilt = self.tr("{deg:.0f}° (half of them to {half})").format(
                deg=degrees(holding.holds_rad), half=self._tilt(holding.half_rad, holding.tilt_rad[-1])
            )
        water = self.tr(
            "Filled from above until candies ran over, then perturbed. Water: {ml:.0f} ml."
        ).format(ml=capacity.geometric_volume_ml)
        return [
            Fact(self.tr("Holds"), held, f"{water} {capacity.explanation}".strip()),
            Fact(self.tr("Keeps all to"), tilt, holding_sentence(holding)),
        ]

    def _tilt(self, tilt_rad: float, most_rad: float) -> str:
        if isinf(tilt_rad):
            return self.tr("over {deg:.0f}°").format(deg=degrees(most_rad))
        return self.tr("{deg:.0f}°").format(deg=degrees(tilt_rad))

    def _facts(self, drop: ShownDrop) -> list[Fact]:
        arrow = " \N{RIGHTWARDS ARROW} "
        counts = arrow.join(str(phase.n_inside) for phase in drop.phases)
        candies = self.tr("{n}, {width:.1f} mm wide").format(
            n=drop.containability.n_drop, width=drop.particle.diameter_m * MM
        )
        return [
            *self._holding_facts(drop),
            Fact(self.tr("Candies"), candies, self.tr("How many were dropped, and their diameter")),
            Fact(
                self.tr("Still in it"),
                counts,
                self.tr("Candies in the object's bounding box after the fall, each tilt and the shoves"),
            ),
            Fact(
                self.tr("Seed"),
                str(drop.seed),
                self.tr("Of all randomness: the same seed and parameters give the same result"),
            ),
            Fact(self.tr("Took"), self.tr("{s:.1f} s").format(s=drop.seconds), self.tr("Time of the drop")),
        ]
