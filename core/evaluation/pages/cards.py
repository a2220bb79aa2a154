"""The gallery: a card for each object, with the worst of its trials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Literal

from core.evaluation.evaluation import PICTURES_FOLDER, EvaluatedObject, Evaluation
from core.evaluation.labels import Label
from core.evaluation.pages.card_words import judged_sentence, poured_sentence
from core.evaluation.pages.charts import place, seed_marks
from core.evaluation.trials import Trial
from core.report.media import data_uri

State = Literal["misjudged", "spilled", "failed", "right", "ambiguous"]
TROUBLES: tuple[State, ...] = ("misjudged", "spilled", "failed")
_SEVERITY: tuple[State, ...] = (*TROUBLES, "right", "ambiguous")
_PICTURE_PX = (320, 240)
_JPEG_QUALITY = 82


@dataclass(frozen=True)
class Card:
    """An object as the gallery shows it.

    Attributes:
        name: the object's.
        category: what it is; may be empty.
        label: what people call it.
        state: of its worst trial.
        picture: address that holds the picture; empty if there is none.
        judged: the verdict and its reason, in a sentence.
        poured: what became of the pours, in a sentence; empty if there was nothing to pour.
        seeds: how it went with the other seeds; empty if there is one.
        marks: scores of the other trials, in per cent of the scale.
        mark: the same of the worst trial; none if it could not be judged.
        threshold: the threshold, on the same scale.
    """

    name: str
    category: str
    label: Label
    state: State
    picture: str
    judged: str
    poured: str
    seeds: str
    marks: list[float]
    mark: float | None
    threshold: float


def cards_of(evaluation: Evaluation, variant: str, folder: Path) -> list[Card]:
    """Return a card for each object that was tried.

    Misjudged ones come first, then spilled, then failed ones; then containers, then others, the closest call
    first; then the ambiguous ones.
    """
    tried = [
        (one, [trial for trial in evaluation.of_variant(variant) if trial.name == one.name])
        for one in evaluation.objects
    ]
    found = [(one, trials, min(trials, key=_badness)) for one, trials in tried if trials]
    found.sort(key=lambda card: _order(card[2]))
    return [_card(evaluation, one, trials, worst, folder) for one, trials, worst in found]


def state_of(trial: Trial) -> State:
    """Return what is the matter with a trial."""
    if trial.label == "ambiguous":
        return "ambiguous"
    if trial.score is not None and not trial.is_right:
        return "misjudged"
    if trial.label == "container" and any(trial.spilled):
        return "spilled"
    return "failed" if trial.problem else "right"


def _card(
    evaluation: Evaluation,
    one: EvaluatedObject,
    trials: Sequence[Trial],
    worst: Trial,
    folder: Path,
) -> Card:
    return Card(
        one.name,
        one.category,
        one.label,
        state_of(worst),
        _embedded(folder / PICTURES_FOLDER / worst.picture) if worst.picture else "",
        judged_sentence(worst),
        poured_sentence(worst, evaluation.n_pours),
        _seeds_said(trials, worst),
        seed_marks(trial for trial in trials if trial is not worst),
        next(iter(seed_marks([worst])), None),
        round(100 * place(worst.threshold), 1),
    )


def _seeds_said(trials: Sequence[Trial], worst: Trial) -> str:
    if len(trials) == 1:
        return ""
    shown = f"shown: seed {worst.seed}, the worst"
    if worst.label == "ambiguous":
        n_containers = sum(bool(trial.is_judged_container) for trial in trials)
        return f"A container with {n_containers} of {len(trials)} seeds; shown: seed {worst.seed}."
    n_right = sum(bool(trial.is_right) for trial in trials)
    said = f"Judged right with {n_right} of {len(trials)} seeds"
    n_poured = sum(trial.n_pours for trial in trials)
    if worst.label == "container" and n_poured:
        said += f", {sum(trial.n_clean_pours for trial in trials)} of {n_poured} pours clean"
    return f"{said}; {shown}."


def _badness(trial: Trial) -> tuple[int, float]:
    return _SEVERITY.index(state_of(trial)), _comfort(trial)


def _order(trial: Trial) -> tuple[int, str, float]:
    severity, comfort = _badness(trial)
    # "container" sorts before "non-container"
    return severity, trial.label if state_of(trial) == "right" else "", comfort


def _comfort(trial: Trial) -> float:
    """The less, the worse: the way from the threshold to the right side; of a spill, its candies."""
    if state_of(trial) == "spilled":
        return -float(sum(trial.spilled))
    if trial.score is None:
        return 0.0
    beyond = trial.score - trial.threshold
    return {"container": beyond, "non-container": -beyond, "ambiguous": abs(beyond)}[trial.label]


def _embedded(path: Path) -> str:
    """Return a picture as JPEG, small, as an address that holds it; empty if it cannot be read."""
    from PIL import Image

    try:
        with Image.open(path) as image:
            small = image.convert("RGB")
    except OSError:  # which PIL also raises of a damaged one
        return ""
    small.thumbnail(_PICTURE_PX)
    content = BytesIO()
    small.save(content, "JPEG", quality=_JPEG_QUALITY, optimize=True)
    return data_uri("image/jpeg", content.getvalue())
