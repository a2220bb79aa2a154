"""A fit: what to fit to what, and the job between these choices and the view of its trials."""

from __future__ import annotations

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtWidgets import QCheckBox, QComboBox, QFormLayout, QGridLayout, QLabel, QPushButton, QSpinBox

from app.gui.desk.desk import Desk
from app.gui.desk.jobs import RunningJob
from app.gui.pages.page import SidePanel
from app.gui.pages.tuning.fit_texts import fitted_tip, fitted_title, measure_noun, range_text, signed
from app.gui.pages.tuning.fit_view import FitView
from app.gui.remedies import worded
from app.gui.theme import GRID_PX
from app.gui.views.labels import heading, say, text_label
from app.gui.views.painting import tabular
from app.jobs.host import Host
from app.jobs.messages import Failed
from app.jobs.tuning_work import FitDone, FitStepped, FitTask, TuningWork
from app.operations.tuning_board import Board
from core.errors import InputError
from core.evaluation.fitting.fitted import (
    CONTAINABILITY,
    FittedParameter,
    fitted_parameters,
    parameters_of_trial,
    threshold_name,
)
from core.evaluation.labels import LabelledObject, objects_to_fit
from core.evaluation.trials import Measure
from core.evaluation.verdicts import measure_by
from core.parameters import Parameters, apply_settings
from core.report.sentences import duration_text
from core.workers import usable_processors

_PATIENCE_S = 5.0
"""A stopped fit sums up its best before it ends."""
_OFFERED = (
    *CONTAINABILITY,
    "containability.contact.restitution",
    "particle.diameter_m",
    "particle.height_m",
)
_SEEDS, _TRIALS = 3, 40


class FitSide(SidePanel):
    """The choices of a fit.

    Attributes:
        back_wanted: to the objects.
        changed: something else was chosen.
    """

    back_wanted = Signal()
    changed = Signal()

    def __init__(self) -> None:
        super().__init__("")
        self.primary.setText(self.tr("Fit"))
        self.primary.setObjectName("fit_start")
        back = QPushButton(self.tr("Back to objects"))
        back.setObjectName("fit_back")
        back.setMinimumHeight(5 * GRID_PX)
        back.clicked.connect(self.back_wanted)
        self.add_button(back)
        self._objects_note = text_label("fit_objects")
        self._measure_note = text_label("fit_measure", "muted")
        self._all = QCheckBox(self.tr("All labelled objects"))
        self._all.setObjectName("fit_all")
        self._all.setToolTip(self.tr("Not only those that are marked in the column 'calib'"))
        self._all.toggled.connect(lambda: self.changed.emit())
        self._boxes: dict[FittedParameter, QCheckBox] = {}
        self._build()

    def _build(self) -> None:
        self.body.addWidget(heading(self.tr("Fit to labels")))
        self.body.addWidget(self._objects_note)
        self.body.addWidget(self._all)
        self.body.addSpacing(GRID_PX)
        self.body.addWidget(heading(self.tr("Parameters")))
        self.body.addLayout(self._build_parameters())
        self.body.addWidget(self._measure_note)
        self.body.addSpacing(GRID_PX)
        self.body.addWidget(heading(self.tr("Search")))
        self.body.addLayout(self._build_search())
        self._time_note = text_label("fit_time")
        self.body.addWidget(self._time_note)
        self.body.addStretch(1)

    def _build_parameters(self) -> QGridLayout:
        grid = QGridLayout()
        grid.setHorizontalSpacing(GRID_PX)
        grid.setVerticalSpacing(GRID_PX // 2)
        grid.setColumnStretch(0, 1)
        for row, one in enumerate(fitted_parameters(_OFFERED)):
            box = QCheckBox(fitted_title(one))
            box.setObjectName(f"fit_{one.name}")
            box.setChecked(one.name in CONTAINABILITY)
            box.setToolTip(fitted_tip(one))
            box.toggled.connect(lambda: self.changed.emit())
            where = QLabel(range_text(one))
            where.setFont(tabular(self.font()))
            where.setProperty("role", "muted")
            where.setToolTip(self.tr("The range in which the value is searched for"))
            grid.addWidget(box, row, 0)
            grid.addWidget(where, row, 1, Qt.AlignmentFlag.AlignRight)
            self._boxes[one] = box
        return grid

    def _build_search(self) -> QFormLayout:
        self._source = QComboBox()
        self._source.setObjectName("fit_input")
        self._source.addItem(self.tr("scanned in the simulated cell"), "scan")
        self._source.addItem(self.tr("taken from its mesh"), "mesh")
        self._source.setToolTip(
            self.tr("Scanned: errors of the reconstruction count; takes some seconds for each object")
        )
        self._seeds = self._number("fit_seeds", _SEEDS, 20, self.tr("Each object is judged with each seed"))
        tip = self.tr("Sets of values to try; the first is the start")
        self._trials = self._number("fit_trials", _TRIALS, 1000, tip)
        for changing in (
            self._seeds.valueChanged,
            self._trials.valueChanged,
            self._source.currentIndexChanged,
        ):
            changing.connect(lambda _: self.changed.emit())
        form = QFormLayout()
        form.setHorizontalSpacing(2 * GRID_PX)
        form.setVerticalSpacing(GRID_PX)
        form.setLabelAlignment(Qt.AlignmentFlag.AlignLeft)
        for title, widget in (
            (self.tr("Each object is"), self._source),
            (self.tr("Seeds"), self._seeds),
            (self.tr("Trials"), self._trials),
        ):
            widget.setAccessibleName(title)
            form.addRow(title, widget)
        return form

    def _number(self, name: str, value: int, most: int, tip: str) -> QSpinBox:
        box = QSpinBox()
        box.setObjectName(name)
        box.setRange(1, most)
        box.setValue(value)
        box.setToolTip(tip)
        box.setFixedWidth(12 * GRID_PX)
        return box

    @property
    def is_all(self) -> bool:
        """Whether all labelled objects are taken, marked in the column 'calib' or not."""
        return self._all.isChecked()

    def task(self, objects: tuple[LabelledObject, ...], preset: str, parameters: Parameters) -> FitTask:
        """Return what is chosen now, for these objects and from these parameters."""
        return FitTask(
            objects=objects,
            source="scan" if self._source.currentData() == "scan" else "mesh",
            n_seeds=self._seeds.value(),
            parameters=parameters,
            preset=preset,
            fitted=tuple(one for one, box in self._boxes.items() if box.isChecked()),
            n_trials=self._trials.value(),
        )

    def show_measure(self, measure: Measure) -> None:
        """Say what judges."""
        said = self.tr(
            "Judged by {measure}. Its threshold needs no search: it is set where it separates the labels "
            "best."
        )
        self._measure_note.setText(said.format(measure=measure_noun(measure)))

    def show_time(self, seconds_each: float | None, n_objects: int) -> None:
        """Say how long the fit takes at most.

        Args:
            seconds_each: that judging an object once takes on average; none if none was judged yet.
            n_objects: to be judged in each trial, with each seed.
        """
        if seconds_each is None:
            say(self._time_note, self.tr("'Run all' first: then it is known how long a fit takes."))
            return
        n_judged = self._trials.value() * self._seeds.value() * n_objects
        said = self.tr(
            "Takes about {time} at most: {n} times {each:.1f} s, {workers} at a time. "
            "Trials that cannot become the best are given up early."
        )
        if self._source.currentData() == "scan":
            said += " " + self.tr("Scanning the objects once comes on top.")
        n_workers = usable_processors()
        seconds = n_judged * seconds_each / n_workers
        text = said.format(time=duration_text(seconds), n=n_judged, each=seconds_each, workers=n_workers)
        say(self._time_note, text)

    def show_objects(self, objects: tuple[LabelledObject, ...], problem: str, can_choose: bool) -> None:
        """Say what is fitted to.

        Args:
            objects: that are chosen.
            problem: why nothing can be fitted to them; empty if it can.
            can_choose: whether some, but not all, are marked in the column 'calib'.
        """
        self._all.setVisible(can_choose)
        n_containers = sum(one.label == "container" for one in objects)
        said = self.tr("{n} objects; containers: {containers}, others: {others}.")
        counted = said.format(n=len(objects), containers=n_containers, others=len(objects) - n_containers)
        self._objects_note.setText(problem or counted)
        self._objects_note.setToolTip(", ".join(one.name for one in objects))


class FitPart(QObject):
    """View and side panel of a fit, and the job between them.

    Attributes:
        view: margins and values.
        side: the choices.
        found: parameters that a fit ended with, and its `FitDone`; none instead of that if its process died.
    """

    found = Signal(object, object)

    def __init__(self, desk: Desk, host: Host[TuningWork], page: str, parent: QObject | None = None) -> None:
        """Make one for the page with that key; its jobs run in `host`."""
        super().__init__(parent)
        self.view = FitView()
        self.side = FitSide()
        self._jobs = desk.jobs
        self._host = host
        self._page = page
        self._board: Board | None = None
        self._draft: tuple[str, Parameters] = "default", Parameters()
        self._objects: tuple[LabelledObject, ...] = ()
        self._task: FitTask | None = None
        self._last: FitStepped | None = None
        self.side.primary.clicked.connect(self.start)
        self.side.changed.connect(self._update)
        desk.jobs.event_received.connect(self._hear)
        desk.jobs.started.connect(lambda _: self._update())
        desk.jobs.finished.connect(lambda *_: self._update())
        desk.jobs.failed.connect(self._fail)

    def show_board(self, board: Board | None, draft: tuple[str, Parameters]) -> None:
        """Fit to these objects, from these parameters."""
        self._board, self._draft = board, draft
        self.side.show_measure(measure_by(draft[1]))
        self._update()

    def _update(self) -> None:
        if self._board is None:
            self._objects = ()
            self.side.show_objects((), self.tr("No objects are chosen yet."), False)
            self.side.primary.setEnabled(False)
            return
        objects = self._board.objects
        labelled = [one for one in objects if one.label != "ambiguous"]
        n_marked = sum(one.is_calibration for one in labelled)
        problem = ""
        try:
            self._objects = objects_to_fit(objects, self.side.is_all)
        except InputError as error:
            self._objects, problem = (), worded(error)
        self.side.show_objects(self._objects, problem, 0 < n_marked < len(labelled))
        self.side.show_time(self._seconds_each(self._board), len(self._objects))
        self.side.primary.setEnabled(self._jobs.is_idle and bool(self._objects))

    def _seconds_each(self, board: Board) -> float | None:
        """How long judging one of the chosen objects takes, by the newest set that knows any of them."""
        names = {one.name for one in self._objects}
        for one in reversed(board.sets):
            verdicts = [verdict for name, verdict in board.of(one).items() if name in names]
            seconds = [verdict.seconds for verdict in verdicts if verdict.score is not None]
            if seconds:
                return sum(seconds) / len(seconds)
        return None

    def start(self) -> None:
        """Fit what is chosen."""
        if not self._objects or not self._jobs.is_idle:
            return
        task = self._task = self.side.task(self._objects, *self._draft)
        self._last = None
        self.view.begin(task.fitted, task.parameters, task.n_trials)
        title = self.tr("Fit {n} parameters to {objects} objects").format(
            n=len(task.fitted) + 1, objects=len(self._objects)
        )
        self._jobs.start(
            title, self._page, self._host, TuningWork.fit, task, then=self._finish, patience_s=_PATIENCE_S
        )

    def _hear(self, event: object) -> None:
        if isinstance(event, FitStepped) and self._task is not None:
            self._last = event
            self.view.show_step(event.step)

    def _finish(self, done: FitDone) -> None:
        if self._last is None:
            return
        self.found.emit(done.parameters, done)
        self._end(done.is_cut_short)

    def _fail(self, job: RunningJob, failed: Failed) -> None:  # noqa: ARG002 - the window says why
        self._update()
        task, last, self._task = self._task, self._last, None
        if job.page != self._page or task is None:
            return
        if last is None:
            self.view.end(self.tr("Ended before the first trial was complete."))
            return
        best = last.step.best
        found = parameters_of_trial(task.parameters, task.fitted, best.number, best.values)
        self.found.emit(apply_settings(found, {threshold_name(found): best.score.threshold}), None)
        self._end(is_cut_short=True)

    def _end(self, is_cut_short: bool) -> None:
        self._task = None
        if self._last is None:
            return
        step = self._last.step
        start = signed(self.view.chart.steps[0].trial.score.margin)
        if is_cut_short:
            said = self.tr("Stopped after {n} trials; the best is kept: margin {margin} instead of {start}.")
        else:
            said = self.tr("Done after {n} trials: margin {margin} instead of {start}.")
        n = step.trial.number + 1
        self.view.end(said.format(n=n, margin=signed(step.best.score.margin), start=start))
