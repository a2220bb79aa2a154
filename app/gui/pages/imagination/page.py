"""The Imagination page: the drop replayed, the verdict with its reason, and the parameters behind it."""

from __future__ import annotations

from collections.abc import Callable
from math import degrees, isfinite, isinf
from pathlib import Path

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QPushButton, QSizePolicy, QStackedWidget, QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.desk.desk import Desk
from app.gui.desk.jobs import RunningJob
from app.gui.pages.background_page import BackgroundPage
from app.gui.pages.fact_grid import Fact, FactGrid
from app.gui.pages.imagination.drop import DropKey, ShownDrop, key_of, load
from app.gui.pages.imagination.view import DropReplay, PicturesPart, phase_title
from app.gui.pages.mode_row import ModeRow
from app.gui.pages.page import SidePanel, SplitView
from app.gui.pages.parameters_part import ParametersPart, n_different
from app.gui.pages.staleness import StaleNote
from app.gui.theme import GRID_PX
from app.gui.views.footprint import FootprintView
from app.gui.views.labels import say, text_label
from app.gui.views.omega_bar import OmegaBar
from app.gui.views.retention_chart import RetentionChart
from app.jobs.session_work import PictureDrawn, SessionWork
from core.imagination.retention.result import Retention, retention_sentence
from core.pipeline.session_view import IMAGINED
from core.report.plot_geometry import FootprintPlan
from core.report.sentences import duration_text, verdict_reason, verdict_sentence
from core.stages import MESH, groups_of, stages_before

MM = 1000.0
STAGES = stages_before("risk", MESH)[1:]
"""What the page runs; the collision model is made again with them."""
GROUPS = groups_of(*STAGES)
_LOWER_PX = 38 * GRID_PX
"""Of footprint or editor, at the least."""


class ImaginationPage(BackgroundPage[DropKey, ShownDrop | None]):
    """Shows what was imagined, starts imagining and rendering."""

    KEY = "imagination"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk, load)
        self._rendered: list[Path] | None = None  # so far, while pictures are rendered
        self._render_title = self.tr("Render pictures")
        self.replay = DropReplay()
        self.pictures = PicturesPart()
        self.side = VerdictSide(desk)
        left = QWidget()
        column = QVBoxLayout(left)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.replay, 1)
        column.addWidget(self.pictures)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(SplitView(left, self.side))
        self._connect()
        self.show_content(None)

    def _connect(self) -> None:
        self.side.primary.clicked.connect(self.imagine)
        self.side.empty_wanted.connect(lambda: self.desk.page_wanted.emit("scan"))
        self.pictures.render_wanted.connect(self.render_pictures)
        jobs = self.desk.jobs
        jobs.event_received.connect(self._hear)
        jobs.started.connect(self._begin)
        for signal in (jobs.finished, jobs.failed):
            signal.connect(self._end)

    @override
    def content_key(self) -> DropKey | None:
        view = self.desk.workspace.view
        return None if view is None else key_of(view)

    @override
    def show_content(self, former: ShownDrop | None) -> None:
        say(self.side.failed, self.failure)
        self.replay.show_drop(self.content)
        if self.content is not None:
            self.side.show_drop(self.content)
        self.update_actions()

    @override
    def update_actions(self) -> None:
        if self.content is None:
            self._show_empty()
        workspace, is_idle = self.desk.workspace, self.desk.jobs.is_idle
        primary = self.side.primary
        has_input = workspace.has("scan") or workspace.has("mesh")
        is_done = self._is_done()
        primary.setEnabled(has_input and not is_done and is_idle)
        if is_done:
            primary.setToolTip(self.tr("This is up to date; change a parameter to imagine it differently"))
        else:
            primary.setToolTip(self.tr("Drop candies on the model, and pour into it if they stay"))
        self.side.stale.look(workspace, primary.text())
        self.pictures.button.setEnabled(is_done and is_idle)
        self._show_pictures()

    def imagine(self) -> None:
        """Imagine the drop and the pours with the parameters as they are now."""
        self._start(self.tr("Imagine"), SessionWork.imagine)

    def render_pictures(self) -> None:
        """Render pictures of what was imagined."""
        self._start(self._render_title, SessionWork.render)

    def _start(self, title: str, method: Callable[..., None]) -> None:
        desk = self.desk
        desk.jobs.start(title, self.KEY, desk.session_host, method, desk.workspace.task())

    def _show_empty(self) -> None:
        workspace = self.desk.workspace
        button = ""
        if workspace.has("containability"):
            said = self.tr("The drop cannot be shown") if self.failure else self.tr("Loading the drop ...")
            scene = ""
        elif workspace.has("scan") or workspace.has("mesh"):
            said = self.tr("Would candies stay in it? Press Imagine to drop some on the model.")
            scene = self.tr("The drop is replayed here.")
        else:
            said = self.tr("Here candies are dropped on the model of a scanned object.")
            scene = self.tr("Scan an object first.")
            button = self.tr("Go to Scan")
        self.side.show_empty(said, button)
        self.replay.scene.set_empty_text(scene)

    def _hear(self, event: object) -> None:
        if not isinstance(event, PictureDrawn) or self._rendered is None:
            return
        if event.session == self.desk.workspace.folder:
            self._rendered.append(event.path)
            self._show_pictures()

    def _begin(self, job: RunningJob) -> None:
        if job.page == self.KEY and job.title == self._render_title:
            self._rendered = []
            self._show_pictures()

    def _end(self, _job: RunningJob, _result: object) -> None:
        self._rendered = None
        self._show_pictures()

    def _is_done(self) -> bool:
        """Whether there is nothing to imagine."""
        return all(self.desk.workspace.is_fresh(stage) for stage in IMAGINED)

    def _show_pictures(self) -> None:
        """Those that are being rendered, or those that belong to the drop that is shown."""
        drop, pictures = self.content, self.pictures
        pictures.setVisible(drop is not None)
        if drop is None:
            pictures.show_none()
        elif self._rendered is not None:
            pictures.button.hide()
            pictures.show_drawing(self._rendered, drop.containability.is_open_container)
        else:
            paths = self._evidence()
            is_old = self._is_done() and not self.desk.workspace.is_fresh("evidence")
            pictures.button.setVisible(not paths or is_old)
            if paths:
                pictures.show_drawn(paths)
            else:
                pictures.show_none(self.tr("The report's pictures and films are not rendered yet."))

    def _evidence(self) -> list[Path]:
        """The files of the evidence, if it is of the drop that is shown."""
        session, key = self.desk.workspace.session, self.content_key()
        record = self.desk.workspace.record("evidence")
        if session is None or record is None or key is None:
            return []
        if record.inputs.get("containability") != key.containability:
            return []
        return sorted(session.path / "evidence" / name for name in record.files if name != "evidence.json")


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
        facts: a few numbers.
    """

    empty_wanted = Signal()

    def __init__(self, desk: Desk) -> None:
        super().__init__(self.tr("Imagine"))
        self._verdict = text_label("drop_verdict", "verdict")
        self._reason = text_label("drop_reason")
        self.failed = text_label("drop_failed", "failed")
        self._empty_button = QPushButton()
        self._empty_button.setObjectName("drop_empty_button")
        self._empty_button.clicked.connect(self.empty_wanted)
        self.stale = StaleNote(("reconstruction", "collision", *IMAGINED))
        self.omega = OmegaBar()
        self._desk = desk
        self._parameters: ParametersPart | None = None
        self.pages = ModeRow("side_page")
        self.pages.add("footprint", self.tr("Footprint"), self.tr("From above: which candies stayed"))
        self.pages.add("retention", self.tr("Tilting"), self.tr("How many candies stay as it is tilted"))
        self.pages.add("parameters", "", self.tr("What the next run is imagined with"))
        self.pages.chosen.connect(self._turn)
        self._stack = QStackedWidget()
        self._result = self._make_result()
        self._stack.addWidget(self._result)
        self._stack.setMinimumHeight(_LOWER_PX)
        # it takes the space that is left: by its size hint the panel would scroll long before it has to
        self._stack.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Ignored)
        for widget in (
            self._verdict,
            self._reason,
            self.failed,
            self._empty_button,
            self.stale,
            self.omega,
            self.pages,
        ):
            self.body.addWidget(widget)
        self.body.addWidget(self._stack, 1)
        desk.workspace.parameters_changed.connect(self._count)
        self._count()

    def _make_result(self) -> QWidget:
        self.footprint = FootprintView()
        self.facts = FactGrid("drop_facts")
        self.retention = RetentionChart()
        self.facts.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        result = QWidget()
        column = QVBoxLayout(result)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX)
        self._picture = QStackedWidget()
        self._picture.addWidget(self.footprint)
        self._picture.addWidget(self.retention)
        column.addWidget(self._picture, 1)
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
        if page != "parameters":
            self._picture.setCurrentWidget(self.retention if page == "retention" else self.footprint)

    def _count(self) -> None:
        n = n_different(self._desk.workspace, GROUPS)
        text = self.tr("Parameters")
        differing = self.tr("1 differs") if n == 1 else self.tr("{n} differ").format(n=n)
        self.pages.set_text("parameters", f"{text} ({differing})" if n else text)

    def show_empty(self, sentence: str, button: str) -> None:
        """Show what will be here, and the button that leads there; an empty text leaves the button away."""
        self._verdict.setText(sentence)
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
        self._verdict.setText(verdict_sentence(found))
        say(self._reason, verdict_reason(found, drop.n_on_top))
        self.omega.set_values(found.omega, found.omega_threshold)
        self.omega.show()
        self.footprint.set_footprint(FootprintPlan.of(found, drop.outline_m, drop.indents_m))
        self.facts.set_facts([*self._retention_facts(drop), *self._drop_facts(drop)])
        self.retention.show_retention(drop.retention)

    def _retention_facts(self, drop: ShownDrop) -> list[Fact]:
        capacity, retention = drop.capacity, drop.retention
        if capacity is None or retention is None:
            return []
        held = self.tr("{n:.0f} candies, {ml:.0f} ml level").format(n=capacity.n_level, ml=capacity.volume_ml)
        water = self.tr("Filled from above until it overflowed, then perturbed. Water: {ml:.0f} ml.").format(
            ml=capacity.geometric_volume_ml
        )
        return [
            Fact(self.tr("Holds"), held, f"{water} {capacity.remark}".strip()),
            Fact(self.tr("Tilted"), self._tilted(retention), retention_sentence(retention)),
        ]

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
            n=drop.containability.n_drop, width=drop.particle.diameter_m * MM
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
            ),
        ]
