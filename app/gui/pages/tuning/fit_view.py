"""The large view while parameters are fitted: progress, the margin of each trial, the best values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pyqtgraph
from PySide6.QtCore import QEvent, Qt
from PySide6.QtGui import QColor, QFont
from PySide6.QtWidgets import QStackedWidget, QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.pages.tuning.fit_texts import (
    fitted_title,
    measure_noun,
    score_sentence,
    signed,
    step_sentence,
    value_text,
)
from app.gui.theme import GRID_PX, theme_of
from app.gui.views.fact_table import Column, FactTable, Row
from app.gui.views.labels import text_label
from app.gui.views.painting import smaller, tabular
from core.evaluation.fitting.fitted import FittedParameter, start_values, threshold_name
from core.evaluation.fitting.scores import FitScore
from core.evaluation.fitting.search import FitStep
from core.evaluation.trials import Measure
from core.evaluation.verdicts import measure_by
from core.parameters import Parameters

_POINT_PX = 9
_LEFT_PX, _BOTTOM_PX = 64, 44
_PADDING = 0.06


class MarginChart(QWidget):
    """One point a trial: filled if all seeds were judged, hollow if it was given up; the best as a line."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("fit_chart")
        self.setAccessibleName(self.tr("Margin of each trial"))
        self._steps: list[FitStep[FitScore]] = []
        self._plot: Any = pyqtgraph.PlotWidget(enableMenu=False)
        self._plot.setMouseEnabled(x=False, y=False)
        self._plot.hideButtons()
        self._plot.setLabel("bottom", self.tr("Trial"))
        self._plot.getAxis("left").enableAutoSIPrefix(False)
        self._plot.getAxis("left").setWidth(_LEFT_PX)
        self._plot.getViewBox().setDefaultPadding(_PADDING)
        self._plot.getAxis("bottom").setHeight(_BOTTOM_PX)
        self._zero = pyqtgraph.InfiniteLine(0, 0)
        self._plot.addItem(self._zero, ignoreBounds=True)
        self._best = self._plot.plot([], [], stepMode="right")
        self._judged = self._plot.plot([], [])
        self._given_up = self._plot.plot([], [])
        self._legend = self._plot.addLegend(offset=(-8, -8))
        for item, text in (
            (self._best, self.tr("best so far")),
            (self._judged, self.tr("judged")),
            (self._given_up, self.tr("given up")),
        ):
            self._legend.addItem(item, text)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self._plot)
        self._style()

    @property
    def steps(self) -> tuple[FitStep[FitScore], ...]:
        """What is shown."""
        return tuple(self._steps)

    def clear(self, n_trials: int, measure: Measure) -> None:
        """Start over with so many trials to come, whose margins are of that measure."""
        self._steps = []
        noun = measure_noun(measure)
        self._plot.setLabel("left", self.tr("Margin ({measure})").format(measure=noun))
        tip = self.tr(
            "Margin: smallest {measure} of a container minus the largest of another object, over all seeds. "
            "A trial is given up as soon as its first seeds show that it cannot become the best."
        )
        self.setToolTip(tip.format(measure=noun))
        self._plot.setXRange(0.5, n_trials + 0.5, padding=0.02)
        self._draw()

    def add(self, step: FitStep[FitScore]) -> None:
        """Show one more trial."""
        self._steps.append(step)
        self._draw()
        margin = signed(step.best.score.margin)
        said = self.tr("{n} trials, best margin {margin}")
        self.setAccessibleDescription(said.format(n=len(self._steps), margin=margin))

    def _draw(self) -> None:
        points = [(step.trial.number + 1, step.trial.score) for step in self._steps]
        self._judged.setData(*_places([(x, one.margin) for x, one in points if not one.is_given_up]))
        self._given_up.setData(*_places([(x, one.margin) for x, one in points if one.is_given_up]))
        self._best.setData(
            *_places([(step.trial.number + 1, step.best.score.margin) for step in self._steps])
        )

    def _style(self) -> None:
        theme = theme_of(self)
        accent, text, muted = (theme.color(name) for name in ("accent", "text", "muted"))
        self._plot.setBackground(theme.color("surface"))
        font = tabular(smaller(self.font()))
        for side in ("left", "bottom"):
            axis = self._plot.getAxis(side)
            axis.setPen(theme.color("line"))
            axis.setTextPen(muted)
            axis.setStyle(tickFont=QFont(font))
        self._zero.setPen(pyqtgraph.mkPen(muted, style=Qt.PenStyle.DashLine))
        self._best.setPen(pyqtgraph.mkPen(accent, width=2))
        for item, symbol, fill in ((self._judged, "o", text), (self._given_up, "t", QColor(0, 0, 0, 0))):
            item.setPen(None)
            item.setSymbol(symbol)
            item.setSymbolSize(_POINT_PX)
            item.setSymbolBrush(fill)
            item.setSymbolPen(pyqtgraph.mkPen(text if symbol == "o" else muted, width=1.5))
        for _, label in self._legend.items:
            label.setText(label.text, color=text.name())
        self._legend.setBrush(theme.color("surface"))

    @override
    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._style()


def _places(points: list[tuple[int, float]]) -> tuple[list[int], list[float]]:
    return [x for x, _ in points], [y for _, y in points]


class FitView(QWidget):
    """Shows one fit.

    Attributes:
        values: the best so far.
    """

    def __init__(self) -> None:
        super().__init__()
        self._chart: MarginChart | None = None
        self.values = self._build_values()
        self._verdict = text_label("fit_verdict", "verdict")
        self._detail = text_label("fit_detail")
        hint = text_label("fit_hint")
        hint.setText(
            self.tr(
                "Fit tries many sets of values and keeps the one that separates containers from other "
                "objects by the largest margin. The margin of each trial and the best values appear here. "
                "You can stop at any time; the best so far is kept."
            )
        )
        hint.setAlignment(Qt.AlignmentFlag.AlignCenter)
        hint.setMargin(8 * GRID_PX)
        self._stack = QStackedWidget()
        self._stack.addWidget(hint)
        self._stack.addWidget(self._build_charts())
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self._stack)
        self._fitted: Sequence[FittedParameter] = ()
        self._parameters = Parameters()

    def _build_values(self) -> FactTable:
        importance = self.tr(
            "How much the best quarter of the trials differs from the others in this parameter (PED-ANOVA); "
            "shown from eight trials on"
        )
        values = FactTable(
            [
                Column(self.tr("Parameter"), align="left"),
                Column(self.tr("Start")),
                Column(self.tr("Best")),
                Column(self.tr("Importance"), tooltip=importance, align="left"),
            ]
        )
        values.setObjectName("fit_values")
        values.setAccessibleName(self.tr("Best values so far"))
        return values

    def _build_charts(self) -> QWidget:
        words = QVBoxLayout()
        words.setContentsMargins(2 * GRID_PX, 2 * GRID_PX, 2 * GRID_PX, GRID_PX)
        words.setSpacing(GRID_PX // 2)
        words.addWidget(self._verdict)
        words.addWidget(self._detail)
        charts = QWidget()
        self._column = QVBoxLayout(charts)
        self._column.setContentsMargins(0, 0, 0, 0)
        self._column.setSpacing(GRID_PX)
        self._column.addLayout(words)
        self._column.addStretch(1)
        self._column.addWidget(self.values)
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
        """Show a fit that has just started, from these parameters."""
        self._fitted, self._parameters = fitted, parameters
        self._stack.setCurrentIndex(1)
        self._verdict.setText(self.tr("Preparing the objects …"))
        self._detail.setText("")
        self.chart.clear(n_trials if fitted else 1, measure_by(parameters))
        self._show_values({}, {}, None)

    def show_step(self, step: FitStep[FitScore]) -> None:
        """Show one more trial."""
        self.chart.add(step)
        self._verdict.setText(step_sentence(step))
        self._detail.setText(score_sentence(step.best.score, measure_by(self._parameters)))
        self._show_values(step.best.values, step.importance, step.best.score.threshold)

    def end(self, sentence: str) -> None:
        """Say how it ended."""
        self._verdict.setText(sentence)

    def _show_values(
        self, best: Mapping[str, float], importance: Mapping[str, float], threshold: float | None
    ) -> None:
        """A row for each parameter, and one for the threshold as soon as it is known."""
        start = start_values(self._fitted, self._parameters)
        rows = []
        for one in self._fitted:
            found = value_text(one.name, best[one.name]) if one.name in best else None
            share = f"{100 * importance[one.name]:.0f} %" if one.name in importance else None
            rows.append(Row((fitted_title(one), value_text(one.name, start[one.name]), found, share)))
        if threshold is not None:
            name = threshold_name(self._parameters)
            title = self.tr("Threshold ({measure})").format(
                measure=measure_noun(measure_by(self._parameters))
            )
            before = value_text(name, self._parameters.containability.deciding_threshold)
            follows = self.tr("follows from the scores")
            rows.append(Row((title, before, value_text(name, threshold), follows)))
        self.values.set_rows(rows)
        height_px = self.values.horizontalHeader().sizeHint().height() + self.values.verticalHeader().length()
        self.values.setFixedHeight(height_px + GRID_PX)
