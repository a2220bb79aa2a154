"""The gallery: a card for each object, with the worst of its trials."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from io import BytesIO
from math import degrees, sqrt
from pathlib import Path
from typing import Literal

from core.evaluation.evaluation import PICTURES_FOLDER, EvaluatedObject, Evaluation
from core.evaluation.labels import Label
from core.evaluation.trials import Trial
from core.report.media import data_uri

State = Literal["misjudged", "spilled", "failed", "right", "ambiguous"]
TROUBLES: tuple[State, ...] = ("misjudged", "spilled", "failed")
_SEVERITY: tuple[State, ...] = (*TROUBLES, "right", "ambiguous")
_PICTURE_PX = (320, 240)
_JPEG_QUALITY = 82
_HEAP = 0.005
"""A capacity share above which something lies there, below a rim or not."""
_DECIMALS = (0, 1, 2, 3)
_NBSP = "\N{NO-BREAK SPACE}"


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


def judged_sentence(trial: Trial) -> str:
    """Say what was judged, and why."""
    if trial.score is None:
        return f"Failed: {trial.problem}"
    if trial.unseen_ml is not None:
        return f"The program cannot tell: {trial.unseen_ml:.0f} ml inside were not seen."
    if trial.view is not None:
        return _looked_sentence(trial, trial.score)
    if trial.capacity_share is not None:
        return _capacity_sentence(trial, trial.capacity_share)
    verdict = "a container" if trial.is_judged_container else "not to be a container"
    than = "more than" if trial.is_judged_container else "not more than"
    return (
        f"{trial.n_in} of {trial.n_drop} candies stayed: Omega {trial.score:.3f} is {than} the threshold of "
        f"{trial.threshold:.4g}, so it was judged {verdict}."
    )


def poured_sentence(trial: Trial, n_pours: int) -> str:
    """Say what became of the pours; empty if none was to be made."""
    if trial.spilled:
        *most, last = (str(count) for count in trial.spilled)
        counts = f"{', '.join(most)} and {last}" if most else last
        times = "once" if trial.n_pours == 1 else f"{trial.n_pours} times"
        side = "" if trial.theta_rad is None else f" from {degrees(trial.theta_rad) % 360:.0f}\N{DEGREE SIGN}"
        stuck = f" {sum(trial.in_cup)} stayed in the cup." if any(trial.in_cup) else ""
        poured = f"Poured {times}{side}: {counts} of {trial.n_pour} candies spilled{_promised(trial)}.{stuck}"
        return f"{poured} The program advised not to." if trial.is_declined else poured
    if trial.score is not None and trial.problem:
        return f"Failed: {trial.problem}"
    if trial.label == "container" and trial.n_feasible == 0:
        who = "The arm can make none of the pours" if trial.view is None else "The cup would touch the object"
        return f"{who}, which counts as spilled."
    if trial.label == "container" and n_pours:
        return "Not poured into, which counts as spilled."
    return ""


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
        _marks(trial for trial in trials if trial is not worst),
        next(iter(_marks([worst])), None),
        _mark(worst.threshold),
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
    """The less, the worse: the distance from the threshold, on the right side; of a spill, its candies."""
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


def _marks(trials: Iterable[Trial]) -> list[float]:
    return [_mark(trial.score) for trial in trials if trial.score is not None]


def _mark(score: float) -> float:
    """Where a score lies on a card's scale from 0 to 1, in per cent: to the square root."""
    return round(100 * min(1.0, sqrt(score)), 1)


def _capacity_sentence(trial: Trial, share: float) -> str:
    said, than = _share_texts(share, trial.threshold)
    more = "more than" if trial.is_judged_container else "not more than"
    return (
        f"{_held(trial)}{said}{_NBSP}% of its convex hull, {more} the threshold "
        f"of {than}{_NBSP}%{_strength(trial)}."
    )


def _looked_sentence(trial: Trial, score: float) -> str:
    verdict = "a container" if trial.is_judged_container else "not to be a container"
    than = "more than" if trial.is_judged_container else "not more than"
    return (
        f"By looks from {trial.view}: a score of {score:.3f} is {than} the threshold of "
        f"{trial.threshold:.4g}, so it was judged {verdict}."
    )


def _held(trial: Trial) -> str:
    """How a sentence on what it holds begins."""
    if trial.capacity_candies is None or trial.capacity_ml is None:
        return "It holds "
    n = round(trial.capacity_candies)
    if n == 0 and (trial.capacity_share or 0.0) > _HEAP:
        return "No candy lies below its rim; all that stays is "
    if n == 0:
        return "It holds less than one candy, " if trial.capacity_candies else "It holds no candy, "
    candies = f"{n} cand{'y' if n == 1 else 'ies'}"
    return f"It holds {candies} ({trial.capacity_ml:.0f}{_NBSP}ml) level with its rim; all that stays is "


def _strength(trial: Trial) -> str:
    if trial.holds_rad is None or not trial.capacity_candies:
        return ""
    if trial.holds_rad == 0:
        return "; something falls out at the slightest tilt"
    return f"; nothing falls out up to a tilt of {degrees(trial.holds_rad):.0f} degrees"


def _share_texts(share: float, threshold: float) -> tuple[str, str]:
    """Return both in per cent: as few decimals as show on which side of the threshold the share lies."""
    value, than = 100 * share, f"{100 * threshold:.4g}"
    texts = [f"{value:.{decimals}f}" for decimals in _DECIMALS]
    return next((text for text in texts if _side(float(text), than) == _side(value, than)), texts[-1]), than


def _side(value: float, than: str) -> int:
    return (value > float(than)) - (value < float(than))


def _promised(trial: Trial) -> str:
    """What the imagination expected of the chosen pour, in brackets."""
    said = []
    if trial.p_chosen is not None:
        said.append(f"{100 * trial.p_chosen:.0f}{_NBSP}% land inside")
    if trial.clean_at_least is not None:
        said.append(f"at least {100 * trial.clean_at_least:.0f}{_NBSP}% of such pours spill nothing")
    return f" (imagined: {'; '.join(said)})" if said else ""
