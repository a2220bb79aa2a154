"""How a fit is written for people: its measure, its parameters with their ranges, its steps and its score."""

from __future__ import annotations

from functools import cache

from PySide6.QtCore import QCoreApplication

from app.gui.views.parameter_editor.naming import Display, group_title, titles
from core.evaluation.fitting.fitted import FittedParameter
from core.evaluation.fitting.scores import FitScore
from core.evaluation.fitting.search import FitStep
from core.evaluation.labels import LabelledObject
from core.evaluation.trials import Measure
from core.parameters import FieldFacts, Parameters, describe, difference


def measure_noun(measure: Measure) -> str:
    """Return a measure as it is called within a sentence."""
    return _tr("Omega") if measure == "Omega" else _tr("capacity share")


def measure_meaning(measure: Measure) -> str:
    """Say what a measure is."""
    if measure == "Omega":
        return _tr("Omega: share of the candies that stayed.")
    return _tr("Capacity share: how much of its bulk is hollow, so that candies stay in it.")


def object_title(one: LabelledObject) -> str:
    """Return what people call an object: its id as words, and what it is where the id does not say so."""
    words = one.name.replace("_", " ").replace("-", " ").strip()
    title = words[:1].upper() + words[1:]
    says_it = not one.category or one.category.replace("_", " ").lower() in words.lower()
    return title if says_it else f"{title} ({one.category})"


def differences_text(parameters: Parameters, base: Parameters) -> str:
    """Return what differs, a line each."""
    return "\n".join(
        f"{name} = {after:.6g}" if isinstance(after, float) else f"{name} = {after}"
        for name, (_, after) in difference(parameters, base).items()
    )


@cache
def _facts() -> dict[str, FieldFacts]:
    return {fact.name: fact for fact in describe()}


def fitted_title(one: FittedParameter) -> str:
    """Return what a parameter is called; what goes with it is named, too."""
    title, group = titles(list(_facts().values()))[one.name], one.name.split(".")[0]
    if one.tied:
        return _tr("Rolling and spinning friction")
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
    """Return the range in which a parameter is searched for."""
    display = Display.of(_facts()[one.name])
    return _tr("{low} to {high}").format(
        low=f"{display.to_shown(one.low):.3g}", high=value_text(one.name, one.high)
    )


def step_sentence(step: FitStep[FitScore]) -> str:
    """Say how far a fit is and what its best so far is worth."""
    if step.best.number == 0:
        best = _tr("Nothing beats the start yet: margin {margin}.")
    else:
        best = _tr("Best so far: trial {best} with a margin of {margin}.")
    said = f"{_tr('Trial {k} of {n}.')} {best}"
    margin = signed(step.best.score.margin)
    return said.format(k=step.trial.number + 1, n=step.n_trials, best=step.best.number + 1, margin=margin)


def score_sentence(score: FitScore, measure: Measure) -> str:
    """Say which objects decide the margin, and what the threshold brings."""
    said = _tr(
        "Smallest {measure} of a container: {least} ({container}); largest of another object: {most} "
        "({other})."
    )
    if score.is_separating:
        worth = _tr("A threshold of {threshold} separates them all.")
    else:
        worth = _tr(
            "They overlap: a threshold of {threshold} judges {share} % correctly, and no other does better."
        )
    least, most = score.smallest_container, score.largest_other
    return f"{said} {worth}".format(
        measure=measure_noun(measure),
        least=f"{least.score:.3f}",
        container=least.name,
        most=f"{most.score:.3f}",
        other=most.name,
        threshold=f"{score.threshold:.3g}",
        share=f"{100 * score.accuracy():.1f}",
    )


def signed(margin: float) -> str:
    """Return a margin with its sign where it is negative."""
    return f"{margin:.3f}".replace("-", "\N{MINUS SIGN}")


def _tr(text: str) -> str:
    return QCoreApplication.translate("Tuning", text)
