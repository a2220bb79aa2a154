"""Two evaluations side by side: what was changed, and which objects it made right or wrong."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from core.errors import InputError
from core.evaluation.evaluation import Evaluation
from core.evaluation.intervals import Share
from core.evaluation.labels import Label
from core.evaluation.pages.parameter_changes import parameter_changes
from core.evaluation.statistics import Figures
from core.evaluation.tables import figures_of
from core.evaluation.trials import Measure, Trial

Turn = Literal["judged worse", "judged better", "spilled more", "spilled less"]
TURNS: tuple[Turn, ...] = ("judged worse", "spilled more", "judged better", "spilled less")


@dataclass(frozen=True)
class ObjectPair:
    """One object in both evaluations; shares and scores are over its seeds.

    Attributes:
        name: the object's.
        label: what people call it, in the later one.
        right: trials judged right, before and after; of an ambiguous object none are counted.
        clean: pours made and without a spilled candy, before and after.
        score: mean score, before and after; none if it failed with every seed.
        measures: what the score is, before and after.
    """

    name: str
    label: Label
    right: tuple[Share, Share]
    clean: tuple[Share, Share]
    score: tuple[float | None, float | None]
    measures: tuple[Measure, Measure]

    @property
    def turns(self) -> tuple[Turn, ...]:
        """What became better or worse."""
        turns: list[Turn] = []
        if (judged := _trend(self.right)) is not None:
            turns.append("judged better" if judged > 0 else "judged worse")
        if (poured := _trend(self.clean)) is not None:
            turns.append("spilled less" if poured > 0 else "spilled more")
        return tuple(turns)


@dataclass(frozen=True)
class VariantPair:
    """The figures of a variant before and after, over the objects that both have.

    Attributes:
        before: its name in the earlier evaluation.
        after: in the later one; another one only if the two have none in common.
        figures: before and after.
        seconds: mean work on a trial, before and after; none without trials.
        objects: those that both have.
    """

    before: str
    after: str
    figures: tuple[Figures, Figures]
    seconds: tuple[float | None, float | None]
    objects: tuple[ObjectPair, ...]

    @property
    def measures(self) -> tuple[Measure, Measure]:
        """What judged, before and after."""
        return self.figures[0].measure, self.figures[1].measure

    def turned(self, turn: Turn) -> list[ObjectPair]:
        """Return the objects that turned so."""
        return [one for one in self.objects if turn in one.turns]


@dataclass(frozen=True)
class Comparison:
    """What differs between two evaluations.

    Attributes:
        settings: (what, before, after) of how they were made.
        parameters: (name, before, after, meaning).
        variants: the figures, variant by variant.
        only_before: objects that the later one lacks.
        only_after: objects that the earlier one lacks.
        relabelled: (name, label before, label after).
        other_meshes: objects whose mesh is another file.
    """

    settings: tuple[tuple[str, str, str], ...]
    parameters: tuple[tuple[str, str, str, str], ...]
    variants: tuple[VariantPair, ...]
    only_before: tuple[str, ...]
    only_after: tuple[str, ...]
    relabelled: tuple[tuple[str, str, str], ...]
    other_meshes: tuple[str, ...]


def compare(before: Evaluation, after: Evaluation) -> Comparison:
    """Compare two evaluations.

    Raises:
        InputError: they have no object in common.
    """
    old, new = ({one.name: one for one in evaluation.objects} for evaluation in (before, after))
    common = [name for name in new if name in old]
    if not common:
        raise InputError("The two evaluations have no object in common; compare two of the same objects.")
    shared = [variant for variant in after.variants if variant in before.variants]
    pairs = [(variant, variant) for variant in shared] or [(before.variants[0], after.variants[0])]
    return Comparison(
        tuple(row for row in _settings(before, after) if row[1] != row[2]),
        tuple(parameter_changes(before.parameters, after.parameters)),
        tuple(_variant_pair(before, after, *pair, common) for pair in pairs),
        tuple(name for name in old if name not in new),
        tuple(name for name in new if name not in old),
        tuple(
            (name, old[name].label, new[name].label) for name in common if old[name].label != new[name].label
        ),
        tuple(
            name
            for name in common
            if old[name].sha256 and new[name].sha256 and old[name].sha256 != new[name].sha256
        ),
    )


def write_comparison(before: Evaluation, after: Evaluation, path: Path) -> str:
    """Write the comparison of two evaluations as one HTML file.

    Args:
        before: the earlier one.
        after: the later one.
        path: of the HTML file.

    Returns:
        The same as text for a terminal.

    Raises:
        InputError: they have no object in common.
        SessionError: the disk is full or the folder may not be written.
    """
    from core.evaluation.comparison_text import comparison_text
    from core.evaluation.pages.comparison import comparison_page
    from core.evaluation.pages.rendering import write_whole

    found = compare(before, after)
    write_whole(path, comparison_page(found, before, after))
    return comparison_text(found)


def _settings(before: Evaluation, after: Evaluation) -> Iterable[tuple[str, str, str]]:
    for what, name in (("input", "source"), ("preset", "preset"), ("pours an object", "n_pours")):
        yield what, str(getattr(before, name)), str(getattr(after, name))
    yield "seeds", ", ".join(map(str, before.seeds)), ", ".join(map(str, after.seeds))
    yield "variants", ", ".join(before.variants), ", ".join(after.variants)
    for name in dict.fromkeys([*before.truth, *after.truth]):
        old, new = (str(one.truth.get(name, "as usual")) for one in (before, after))
        yield f"truth world: {name}", old, new
    for name in dict.fromkeys([*before.versions, *after.versions]):
        yield name, before.versions.get(name, "–"), after.versions.get(name, "–")


def _variant_pair(
    before: Evaluation,
    after: Evaluation,
    old: str,
    new: str,
    common: list[str],
) -> VariantPair:
    names = frozenset(common)
    trials = (_by_name(before.of_variant(old)), _by_name(after.of_variant(new)))
    figures = figures_of(before, old, names), figures_of(after, new, names)
    return VariantPair(
        old,
        new,
        figures,
        (_mean_seconds(before, old, names), _mean_seconds(after, new, names)),
        tuple(
            _object_pair(name, trials[0][name], trials[1][name], (figures[0].measure, figures[1].measure))
            for name in common
            if name in trials[0] and name in trials[1]
        ),
    )


def _object_pair(
    name: str, old: list[Trial], new: list[Trial], measures: tuple[Measure, Measure]
) -> ObjectPair:
    return ObjectPair(
        name,
        new[0].label,
        (_right(old), _right(new)),
        (_clean(old), _clean(new)),
        (_score(old), _score(new)),
        measures,
    )


def _by_name(trials: Iterable[Trial]) -> dict[str, list[Trial]]:
    found: dict[str, list[Trial]] = {}
    for trial in trials:
        found.setdefault(trial.name, []).append(trial)
    return found


def _right(trials: list[Trial]) -> Share:
    labelled = [trial for trial in trials if trial.label != "ambiguous"]
    return Share(sum(bool(trial.is_right) for trial in labelled), len(labelled))


def _clean(trials: list[Trial]) -> Share:
    """Of containers only: what is poured into something else is not meant to stay."""
    poured = [trial for trial in trials if trial.label == "container"]
    return Share(sum(trial.n_clean_pours for trial in poured), sum(trial.n_pours for trial in poured))


def _score(trials: list[Trial]) -> float | None:
    known = [trial.score for trial in trials if trial.score is not None]
    return sum(known) / len(known) if known else None


def _trend(pair: tuple[Share, Share]) -> int | None:
    """1 if the share has grown, -1 if it has shrunk; none if it has not changed or is not known."""
    before, after = (share.value for share in pair)
    if before is None or after is None or before == after:
        return None
    return 1 if after > before else -1


def _mean_seconds(evaluation: Evaluation, variant: str, names: frozenset[str]) -> float | None:
    took = [trial.total_s for trial in evaluation.of_variant(variant) if trial.name in names]
    return sum(took) / len(took) if took else None
