"""A fit from the page's side: what is chosen is started, its trials are shown, its end is handed on."""

from __future__ import annotations

from PySide6.QtCore import QObject, Signal

from app.calibration_board import Board
from app.gui.desk.desk import Desk
from app.gui.desk.jobs import RunningJob
from app.gui.pages.calibration.fit_side import FitSide
from app.gui.pages.calibration.fit_view import FitView
from app.gui.pages.calibration.fit_words import signed
from app.jobs.fit_work import FitDone, FitStepped, FitTask, FitWork
from app.jobs.host import Host
from app.jobs.messages import Failed
from core.errors import InputError
from core.evaluation.fitting.chosen import chosen_objects
from core.evaluation.fitting.fitted import parameters_of_trial, threshold_name
from core.evaluation.labels import LabelledObject
from core.evaluation.verdicts import measure_by
from core.parameters import Parameters, apply_settings

_PATIENCE_S = 5.0
"""A stopped fit sums up its best before it ends."""


class FitPart(QObject):
    """View and side panel of a fit, and the job between them.

    Attributes:
        view: margins and values.
        side: the choices.
        found: parameters that a fit ended with, and its `FitDone`; none instead of that if its process died.
    """

    found = Signal(object, object)

    def __init__(self, desk: Desk, host: Host[FitWork], page: str, parent: QObject | None = None) -> None:
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
        self.side.changed.connect(self._look_again)
        desk.jobs.news.connect(self._hear)
        desk.jobs.started.connect(lambda _: self._look_again())
        desk.jobs.finished.connect(lambda *_: self._look_again())
        desk.jobs.failed.connect(self._fail)

    def show_board(self, board: Board | None, draft: tuple[str, Parameters]) -> None:
        """Fit to these objects, from these parameters."""
        self._board, self._draft = board, draft
        self.side.show_measure(measure_by(draft[1]))
        self._look_again()

    def _look_again(self) -> None:
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
            self._objects = chosen_objects(objects, self.side.wishes.is_all)
        except InputError as error:
            self._objects, problem = (), str(error)
        self.side.show_objects(self._objects, problem, 0 < n_marked < len(labelled))
        self.side.primary.setEnabled(self._jobs.is_idle and bool(self._objects))

    def start(self) -> None:
        """Fit what is chosen."""
        if not self._objects or not self._jobs.is_idle:
            return
        wishes, (preset, parameters) = self.side.wishes, self._draft
        self._task = FitTask(
            self._objects,
            wishes.source,
            wishes.n_seeds,
            parameters,
            preset,
            wishes.fitted,
            wishes.n_trials,
        )
        self._last = None
        self.view.begin(wishes.fitted, parameters, wishes.n_trials)
        title = self.tr("Fit {n} parameters to {objects} objects").format(
            n=len(wishes.fitted) + 1, objects=len(self._objects)
        )
        self._jobs.start(
            title,
            self._page,
            self._host,
            FitWork.fit,
            self._task,
            then=self._finish,
            patience_s=_PATIENCE_S,
        )

    def _hear(self, news: object) -> None:
        if isinstance(news, FitStepped) and self._task is not None:
            self._last = news
            self.view.show_step(news.step)

    def _finish(self, done: FitDone) -> None:
        if self._last is None:
            return
        self.found.emit(done.parameters, done)
        self._end(done.is_cut_short)

    def _fail(self, job: RunningJob, failed: Failed) -> None:  # noqa: ARG002 - the window tells why
        self._look_again()
        task, last, self._task = self._task, self._last, None
        if job.page != self._page or task is None:
            return
        if last is None:
            self.view.end(self.tr("Ended before the first trial was done."))
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
