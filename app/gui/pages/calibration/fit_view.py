"""The large view while parameters are fitted: how far it is, the margins, the best values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QStackedWidget, QVBoxLayout, QWidget

from app.gui.pages.calibration.fit_chart import MarginChart
from app.gui.pages.calibration.fit_values import FitValues, ValueRow
from app.gui.pages.calibration.fit_words import fitted_title, score_sentence, step_sentence, value_text
from app.gui.pages.calibration.measure_words import measure_noun
from app.gui.theme import GRID_PX
from core.evaluation.fitting.fitted import FittedParameter, start_values, threshold_name
from core.evaluation.fitting.scores import FitScore
from core.evaluation.fitting.trials import FitStep
from core.evaluation.verdicts import measure_by
from core.parameters import Parameters


class FitView(QWidget):
    """Shows one fit.

    Attributes:
        values: the best so far.
    """

    def __init__(self) -> None:
        super().__init__()
        self._chart: MarginChart | None = None
        self.values = FitValues()
        self._verdict = QLabel()
        self._verdict.setObjectName("fit_verdict")
        self._verdict.setProperty("role", "verdict")
        self._verdict.setWordWrap(True)
        self._detail = QLabel()
        self._detail.setObjectName("fit_detail")
        self._detail.setWordWrap(True)
        self._detail.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self._stack = QStackedWidget()
        self._stack.addWidget(self._build_hint())
        self._stack.addWidget(self._build_charts())
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self._stack)
        self._fitted: Sequence[FittedParameter] = ()
        self._parameters = Parameters()

    def _build_hint(self) -> QLabel:
        hint = QLabel(
            self.tr(
                "Fit tries many sets of values and keeps the one with which containers and other objects are "
                "told apart by the largest margin. The margin of each trial and the best values will be "
                "here; whenever you stop it, the best so far is kept."
            )
        )
        hint.setObjectName("fit_hint")
        hint.setAlignment(Qt.AlignmentFlag.AlignCenter)
        hint.setWordWrap(True)
        hint.setMargin(8 * GRID_PX)
        return hint

    def _build_charts(self) -> QWidget:
        words = QVBoxLayout()
        words.setContentsMargins(2 * GRID_PX, 2 * GRID_PX, 2 * GRID_PX, GRID_PX)
        words.setSpacing(GRID_PX // 2)
        words.addWidget(self._verdict)
        words.addWidget(self._detail)
        charts = QWidget()
        column = QVBoxLayout(charts)
        column.setContentsMargins(0, 0, 0, 2 * GRID_PX)
        column.setSpacing(GRID_PX)
        column.addLayout(words)
        column.addStretch(1)
        column.addWidget(self.values)
        self._column = column
        return charts

    @property
    def chart(self) -> MarginChart:
        """A point for each trial; made when there is one to come, because that takes its time."""
        if self._chart is None:
            self._chart = MarginChart()
            self._column.takeAt(1)
            self._column.insertWidget(1, self._chart, 1)
        return self._chart

    def begin(self, fitted: Sequence[FittedParameter], parameters: Parameters, n_trials: int) -> None:
        """Show a fit that has just begun, from these parameters."""
        self._fitted, self._parameters = fitted, parameters
        start = start_values(fitted, parameters)
        self._stack.setCurrentIndex(1)
        self._verdict.setText(self.tr("Preparing the objects ..."))
        self._detail.setText("")
        self.chart.clear(n_trials if fitted else 1, measure_by(parameters))
        self.values.set_rows([self._row(one, start, None, None) for one in fitted])

    def show_step(self, step: FitStep[FitScore]) -> None:
        """Show one more trial."""
        start, measure = start_values(self._fitted, self._parameters), measure_by(self._parameters)
        threshold_before = self._parameters.containability.deciding_threshold
        self.chart.add(step)
        self._verdict.setText(step_sentence(step))
        self._detail.setText(score_sentence(step.best.score, measure))
        importance = step.importance
        rows = [
            self._row(one, start, step.best.values[one.name], importance.get(one.name))
            for one in self._fitted
        ]
        name = threshold_name(self._parameters)
        threshold = ValueRow(
            self.tr("Threshold ({measure})").format(measure=measure_noun(measure)),
            value_text(name, threshold_before),
            value_text(name, step.best.score.threshold),
            None,
            self.tr("follows from the scores"),
        )
        self.values.set_rows([*rows, threshold])

    def end(self, sentence: str) -> None:
        """Say how it ended."""
        self._verdict.setText(sentence)

    def _row(
        self,
        one: FittedParameter,
        start: Mapping[str, float],
        best: float | None,
        importance: float | None,
    ) -> ValueRow:
        shown = "--" if best is None else value_text(one.name, best)
        return ValueRow(fitted_title(one), value_text(one.name, start[one.name]), shown, importance)
