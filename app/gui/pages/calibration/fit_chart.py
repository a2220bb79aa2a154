"""The margins of all trials, and the best so far."""

from __future__ import annotations

from typing import Any

import pyqtgraph
from PySide6.QtCore import QEvent, Qt
from PySide6.QtGui import QColor, QFont
from PySide6.QtWidgets import QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.pages.calibration.fit_words import signed
from app.gui.pages.calibration.measure_words import measure_noun
from app.gui.theme import theme_of
from app.gui.views.painting import smaller, tabular
from core.evaluation.fitting.scores import FitScore
from core.evaluation.fitting.trials import FitStep
from core.evaluation.trials import Measure

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
        """Forget all trials; there will be so many, and their margins are of that measure."""
        self._steps = []
        noun = measure_noun(measure)
        self._plot.setLabel("left", self.tr("Margin ({measure})").format(measure=noun))
        tip = self.tr(
            "Margin: smallest {measure} of a container less the largest of another object, over all seeds. A "
            "trial is given up when some of the seeds show that it cannot become the best."
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
