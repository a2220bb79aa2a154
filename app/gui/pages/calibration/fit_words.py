"""How fitted parameters are called and written for people."""

from __future__ import annotations

from functools import cache

from PySide6.QtCore import QCoreApplication

from app.gui.pages.calibration.measure_words import measure_noun
from app.gui.views.parameter_editor.naming import Display, group_title, titles
from core.evaluation.fitting.fitted import FittedParameter
from core.evaluation.fitting.scores import FitScore
from core.evaluation.fitting.trials import FitStep
from core.evaluation.trials import Measure
from core.parameters import FieldFacts, describe


@cache
def _facts() -> dict[str, FieldFacts]:
    return {fact.name: fact for fact in describe()}


@cache
def _titles() -> dict[str, str]:
    return titles(list(_facts().values()))


def fitted_title(one: FittedParameter) -> str:
    """Return what a parameter is called; what goes with it is named, too."""
    title, group = _titles()[one.name], one.name.split(".")[0]
    if one.tied:
        return QCoreApplication.translate("Fit", "Rolling and spinning friction")
    return title if group == "containability" else f"{group_title(group)} {title.lower()}"


def fitted_tip(one: FittedParameter) -> str:
    """Return all there is to know of a parameter."""
    return Display.of(_facts()[one.name]).tooltip()


def value_text(name: str, value: float) -> str:
    """Return a value with its unit, three digits."""
    display = Display.of(_facts()[name])
    shown = f"{display.to_shown(value):.3g}"
    space = "" if display.unit in ("", "°") else " "
    return f"{shown}{space}{display.unit}"


def range_text(one: FittedParameter) -> str:
    """Return the range a parameter is looked for in."""
    display = Display.of(_facts()[one.name])
    said = QCoreApplication.translate("Fit", "{low} to {high}")
    return said.format(low=f"{display.to_shown(one.low):.3g}", high=value_text(one.name, one.high))


def step_sentence(step: FitStep[FitScore]) -> str:
    """Say how far a fit is and what its best so far is worth."""
    said = QCoreApplication.translate("Fit", "Trial {k} of {n}. {best}")
    return said.format(k=step.trial.number + 1, n=step.n_trials, best=best_sentence(step))


def best_sentence(step: FitStep[FitScore]) -> str:
    """Say what the best so far is worth."""
    if step.best.number == 0:
        said = QCoreApplication.translate("Fit", "Nothing is better than the start yet: margin {margin}.")
    else:
        said = QCoreApplication.translate("Fit", "Best so far: trial {k} with a margin of {margin}.")
    return said.format(k=step.best.number + 1, margin=signed(step.best.score.margin))


def score_sentence(score: FitScore, measure: Measure) -> str:
    """Say which objects decide the margin, and what the threshold brings."""
    said = QCoreApplication.translate(
        "Fit",
        "Smallest {measure} of a container: {least} ({container}); largest of another object: {most} "
        "({other}). {threshold}",
    )
    if score.is_separating:
        worth = QCoreApplication.translate("Fit", "A threshold of {threshold} tells all apart.")
    else:
        worth = QCoreApplication.translate(
            "Fit", "They overlap: a threshold of {threshold} judges {share} % rightly, no other judges more."
        )
    least, most = score.smallest_container, score.largest_other
    return said.format(
        measure=measure_noun(measure),
        least=f"{least.score:.3f}",
        container=least.name,
        most=f"{most.score:.3f}",
        other=most.name,
        threshold=worth.format(threshold=f"{score.threshold:.3g}", share=f"{100 * score.accuracy():.1f}"),
    )


def signed(margin: float) -> str:
    """Return a margin with its sign where it is negative."""
    return f"{margin:.3f}".replace("-", "\N{MINUS SIGN}")
