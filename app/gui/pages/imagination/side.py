"""The right half: the verdict with its reason, what it was found with, and the parameters of the next run."""

from __future__ import annotations

from math import degrees, isfinite, isinf

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QPushButton, QSizePolicy, QStackedWidget, QWidget

from app.gui.desk.desk import Desk
from app.gui.pages.fact_grid import Fact, FactGrid
from app.gui.pages.imagination.drop import ShownDrop
from app.gui.pages.imagination.view import phase_title
from app.gui.pages.mode_row import ModeRow
from app.gui.pages.page import SidePanel
from app.gui.pages.parameters_part import ParametersPart, n_different
from app.gui.pages.staleness import StaleNote
from app.gui.theme import GRID_PX
from app.gui.views.footprint import FootprintView
from app.gui.views.labels import say, text_label
from app.gui.views.omega_bar import OmegaBar
from app.gui.views.pour_map import MappedPour, PourMap
from app.gui.views.retention_chart import RetentionChart
from core.imagination.capacity.result import Capacity
from core.imagination.results import PoursSoFar
from core.imagination.retention.result import Retention, retention_sentence
from core.pipeline.session_view import ALL_IMAGINED
from core.report.plot_geometry import FootprintPlan
from core.report.sentences import duration_text, verdict_parts, verdict_reason
from core.stages import MESH, groups_of, stages_before

MM = 1000.0
STAGES = (*stages_before("risk", MESH)[1:], "retention")
"""What the page runs; the collision model is made again with them."""
GROUPS = groups_of(*STAGES)
_PICTURE_PX, _EDITOR_PX = 18 * GRID_PX, 30 * GRID_PX
"""Heights, at the least: with the longest verdict the panel of a window of 800 pixels need not scroll."""


class VerdictSide(SidePanel):
    """What was found, and what it was found with.

    Signals: `empty_wanted` when the button of the empty state is pressed.

    Attributes:
        failed: says why the result cannot be shown.
        stale: says when the result is not what the parameters would give now.
        omega: the paper's measure.
        pages: footprint, retention or parameters.
        footprint: which candies stayed.
        retention: how many stay as it is tilted.
        wheel: the pours while they are imagined.
        facts: a few numbers.
    """

    empty_wanted = Signal()

    def __init__(self, desk: Desk) -> None:
        super().__init__(self.tr("Imagine"))
        self._verdict = text_label("drop_verdict", "verdict")
        self._details = text_label("drop_details")
        self._reason = text_label("drop_reason")
        self.failed = text_label("drop_failed", "failed")
        self._empty_button = QPushButton()
        self._empty_button.setObjectName("drop_empty_button")
        self._empty_button.clicked.connect(self.empty_wanted)
        self.stale = StaleNote(("reconstruction", "collision", *ALL_IMAGINED))
        self.omega = OmegaBar()
        self._desk = desk
        self._is_filling = False
        self._parameters: ParametersPart | None = None
        self.pages = ModeRow("side_page")
        self.pages.add("footprint", self.tr("Footprint"), self.tr("From above: which candies stayed"))
        self.pages.add("retention", self.tr("Tilting"), self.tr("How many candies stay as it is tilted"))
        self.pages.add("parameters", "", self.tr("What the next run is imagined with"))
        self.pages.chosen.connect(self._turn)
        self._make_result()
        for widget in (
            self._verdict,
            self._details,
            self._reason,
            self.failed,
            self._empty_button,
            self.stale,
            self.omega,
            self.pages,
        ):
            self.body.addWidget(widget)
        self.body.addWidget(self._picture, 1)
        self.body.addWidget(self.facts)
        desk.workspace.parameters_changed.connect(self._count)
        self._count()

    def _make_result(self) -> None:
        self.footprint = FootprintView()
        self.retention = RetentionChart()
        self.wheel = PourMap()
        self.facts = FactGrid("drop_facts")
        self.facts.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        self._picture = QStackedWidget()
        for picture in (self.footprint, self.retention, self.wheel):
            picture.setMinimumSize(_PICTURE_PX, _PICTURE_PX)
            self._picture.addWidget(picture)
        _take_what_is_left(self._picture, _PICTURE_PX)

    @property
    def parameters(self) -> ParametersPart:
        """The parameters; made when they are first wanted."""
        if self._parameters is None:
            self._parameters = ParametersPart(self._desk, GROUPS)
            _take_what_is_left(self._parameters, _EDITOR_PX)
            self._parameters.hide()
            self.body.addWidget(self._parameters, 1)
        return self._parameters

    def _turn(self, page: str) -> None:
        has_parameters = page == "parameters"
        self._picture.setVisible(not has_parameters)
        self.facts.setVisible(not has_parameters)
        if has_parameters or self._parameters is not None:
            self.parameters.setVisible(has_parameters)
        if not has_parameters:
            first = self.wheel if self._is_filling else self.footprint
            self._picture.setCurrentWidget(self.retention if page == "retention" else first)

    def _count(self) -> None:
        n = n_different(self._desk.workspace, GROUPS)
        text = self.tr("Parameters")
        differing = self.tr("1 differs") if n == 1 else self.tr("{n} differ").format(n=n)
        self.pages.set_text("parameters", f"{text} ({differing})" if n else text)

    def show_empty(self, sentence: str, button: str) -> None:
        """Show what will be here, and the button that leads there; an empty text leaves the button away."""
        self._verdict.setText(sentence)
        self._details.hide()
        self._reason.hide()
        self._empty_button.setText(button)
        self._empty_button.setVisible(bool(button))
        self.omega.hide()
        self.footprint.clear()
        self.facts.set_facts([])
        self.retention.show_retention(None)

    def show_drop(self, drop: ShownDrop) -> None:
        """Show what was found."""
        found = drop.containability
        self._empty_button.hide()
        if found is None:
            self._verdict.setText(self._so_far(drop))
            self._details.hide()
            self._reason.hide()
            self.omega.hide()
            self.footprint.clear()
        else:
            headline, details = verdict_parts(found)
            self._verdict.setText(headline)
            say(self._details, details)
            say(self._reason, verdict_reason(found, drop.n_on_top))
            self.omega.set_values(found.omega, found.omega_threshold)
            self.omega.show()
            self.footprint.set_footprint(FootprintPlan.of(found, drop.outline_m, drop.indents_m))
        self.facts.set_facts([*self._retention_facts(drop), *self._drop_facts(drop)])
        self.retention.show_retention(drop.retention)

    def _so_far(self, drop: ShownDrop) -> str:
        """What is known before the object was filled."""
        said = self.tr("{n} of {all} dropped candies stayed. How much it holds is found out next.")
        return said.format(n=drop.drop.n_in, all=drop.drop.n_drop)

    def show_pours_so_far(self, so_far: PoursSoFar) -> None:
        """Show the wheel as it fills; the first news of it turn to it."""
        self.wheel.set_pours(
            [
                MappedPour(i, j, float(theta_rad), float(indent_m), float(so_far.p[i, j]))
                for i, theta_rad in enumerate(so_far.theta_rad)
                for j, indent_m in enumerate(so_far.indent_m)
            ],
            None,
        )
        if not self._is_filling:
            self._is_filling = True
            if self.pages.mode == "footprint":
                self._picture.setCurrentWidget(self.wheel)

    def end_pours(self) -> None:
        """Put away the wheel: what came of it is on the Pours page."""
        self._is_filling = False
        self._turn(self.pages.mode)

    def _retention_facts(self, drop: ShownDrop) -> list[Fact]:
        capacity, retention = drop.capacity, drop.retention
        if capacity is None:
            return []
        held = self.tr("{n:.0f} candies, {volume} level").format(
            n=capacity.level_candies, volume=self._level_volume(capacity)
        )
        water = self.tr("Filled from above until it overflowed, then perturbed. Water: {ml:.0f} ml.").format(
            ml=capacity.geometric_volume_ml
        )
        holds = Fact(self.tr("Holds"), held, f"{water} {capacity.remark}".strip())
        if retention is None:  # it is tilted last
            return [holds]
        return [holds, Fact(self.tr("Tilted"), self._tilted(retention), retention_sentence(retention))]

    def _level_volume(self, capacity: Capacity) -> str:
        """The bounds where a scan leaves some: the headline has the figure between them."""
        if capacity.least_ml is None:
            return self.tr("{ml:.0f} ml").format(ml=capacity.level_ml)
        if capacity.most_ml is None:
            return self.tr("at least {ml:.0f} ml").format(ml=capacity.least_ml)
        return self.tr("{least:.0f} to {most:.0f} ml").format(least=capacity.least_ml, most=capacity.most_ml)

    def _tilted(self, retention: Retention) -> str:
        if isinf(retention.first_rad):
            said = self.tr("nothing falls out, even at {all:.0f}°")
        elif isfinite(retention.half_rad):
            said = self.tr("nothing falls out up to {first:.0f}°, half do by {half:.0f}°")
        else:
            said = self.tr("nothing falls out up to {first:.0f}°, most stay to {all:.0f}°")
        return said.format(
            first=degrees(retention.holds_rad),
            half=degrees(retention.half_rad),
            all=degrees(retention.tilt_rad[-1]),
        )

    def _drop_facts(self, drop: ShownDrop) -> list[Fact]:
        dropped = self.tr("{n} candies, {width:.1f} mm wide").format(
            n=drop.drop.n_drop, width=drop.particle.diameter_m * MM
        )
        return [
            Fact(self.tr("Dropped"), dropped, self.tr("How many candies were dropped, and their diameter")),
            Fact(
                self.tr("Inside after"),
                " / ".join(f"{phase_title(phase.key)} {phase.n_inside}" for phase in drop.phases),
                self.tr("Candies in the object's bounding box after each phase of the drop"),
            ),
            Fact(
                self.tr("Seed"),
                str(drop.seed),
                self.tr("Of all randomness: the same seed and parameters give the same result"),
            ),
            Fact(
                self.tr("Took"),
                duration_text(drop.seconds),
                self.tr("Computing time of the drop"),
                is_beside=True,
            ),
        ]


def _take_what_is_left(widget: QWidget, least_px: int) -> None:
    """Let a widget be as high as there is space: by its size hint the panel would scroll before it has to."""
    widget.setMinimumHeight(least_px)
    widget.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Ignored)
