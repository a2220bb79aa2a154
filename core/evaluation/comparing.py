"""Two evaluations side by side: what was changed, and which objects it made right or wrong."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from core.errors import InputError
from core.evaluation.evaluation import Evaluation
from core.evaluation.labels import Label
from core.evaluation.statistics import Figures, Share, figures_of
from core.evaluation.trials import Measure, Trial
from core.parameters import Parameters, describe, flatten

Change = Literal["judged worse", "spilled more", "judged better", "spilled less"]


@dataclass(frozen=True)
class ObjectPair:
    """One object in both evaluations; shares and scores are over its seeds.

    Attributes:
        name: the object's.
        label: what people call it, in the later one.
        right: trials judged right, before and after; of an ambiguous object none are counted.
        clean: pours made and without a spilled candy, before and after.
        score: mean score, before and after; none if it failed with every seed.
    """

    name: str
    label: Label
    right: tuple[Share, Share]
    clean: tuple[Share, Share]
    score: tuple[float | None, float | None]

    @property
    def changes(self) -> tuple[Change, ...]:
        """What became better or worse."""
        changes: list[Change] = []
        if (judged := _trend(self.right)) is not None:
            changes.append("judged better" if judged > 0 else "judged worse")
        if (poured := _trend(self.clean)) is not None:
            changes.append("spilled less" if poured > 0 else "spilled more")
        return tuple(changes)


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

    def changed(self, change: Change) -> list[ObjectPair]:
        """Return the objects that changed so."""
        return [one for one in self.objects if change in one.changes]


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
    digests = {name: (old[name].sha256, new[name].sha256) for name in common}
    return Comparison(
        tuple(row for row in _settings(before, after) if row[1] != row[2]),
        tuple(parameter_changes(before.parameters, after.parameters)),
        tuple(_variant_pair(before, after, *pair, common) for pair in pairs),
        tuple(name for name in old if name not in new),
        tuple(name for name in new if name not in old),
        tuple(
            (name, old[name].label, new[name].label) for name in common if old[name].label != new[name].label
        ),
        tuple(name for name, pair in digests.items() if all(pair) and pair[0] != pair[1]),
    )


def default_parameters() -> dict[str, Any]:
    """Return the default ones by dotted name, as plain JSON, as an evaluation keeps them."""
    plain: dict[str, Any] = json.loads(json.dumps(flatten(Parameters())))
    return plain


def parameter_changes(before: Mapping[str, Any], after: Mapping[str, Any]) -> list[tuple[str, str, str, str]]:
    """Return (name, value before, value after, what it means) of each parameter that differs.

    They may come from different versions of the program. The seed is left out: an evaluation has several.
    """
    facts = {fact.name: fact for fact in describe()}
    rows = []
    for name in {**before, **after}:
        if name == "seed" or (name in before and name in after and before[name] == after[name]):
            continue
        unit, doc = (facts[name].unit, facts[name].doc) if name in facts else ("", "not in this version")
        rows.append((name, _value_text(before, name, unit), _value_text(after, name, unit), doc))
    return rows


def _value_text(values: Mapping[str, Any], name: str, unit: str) -> str:
    if name not in values:
        return "not there"
    value = values[name]
    if value is None:
        return "automatic"
    if isinstance(value, bool):
        return "yes" if value else "no"
    several = value if isinstance(value, list) else [value]
    text = ", ".join(f"{one:.6g}" if isinstance(one, float) else str(one) for one in several)
    return f"{text} {unit}".rstrip()


def _settings(before: Evaluation, after: Evaluation) -> Iterable[tuple[str, str, str]]:
    for what, name in (("input", "source"), ("preset", "preset"), ("pours an object", "n_pours")):
        yield what, str(getattr(before, name)), str(getattr(after, name))
    yield "seeds", ", ".join(map(str, before.seeds)), ", ".join(map(str, after.seeds))
    yield "variants", ", ".join(before.variants), ", ".join(after.variants)
    for name in dict.fromkeys([*before.truth, *after.truth]):
        old, new = (str(one.truth.get(name, "as usual")) for one in (before, after))
        yield f"ground-truth simulation: {name}", old, new
    for name in dict.fromkeys([*before.versions, *after.versions]):
        yield name, before.versions.get(name, "–"), after.versions.get(name, "–")


def _variant_pair(
    before: Evaluation, after: Evaluation, old: str, new: str, common: list[str]
) -> VariantPair:
    names = frozenset(common)
    known = [
        [trial for trial in evaluation.of_variant(variant) if trial.name in names]
        for evaluation, variant in ((before, old), (after, new))
    ]
    trials = [_by_name(found) for found in known]
    return VariantPair(
        old,
        new,
        (figures_of(before, old, names), figures_of(after, new, names)),
        (_mean(trial.total_s for trial in known[0]), _mean(trial.total_s for trial in known[1])),
        tuple(
            _object_pair(name, trials[0][name], trials[1][name])
            for name in common
            if name in trials[0] and name in trials[1]
        ),
    )


def _object_pair(name: str, old: list[Trial], new: list[Trial]) -> ObjectPair:
    return ObjectPair(
        name,
        new[0].label,
        (Figures.of(old, 0).accuracy, Figures.of(new, 0).accuracy),
        (_clean(old), _clean(new)),
        (
            _mean(trial.score for trial in old if trial.score is not None),
            _mean(trial.score for trial in new if trial.score is not None),
        ),
    )


def _by_name(trials: Iterable[Trial]) -> dict[str, list[Trial]]:
    found: dict[str, list[Trial]] = {}
    for trial in trials:
        found.setdefault(trial.name, []).append(trial)
    return found


def _clean(trials: list[Trial]) -> Share:
    """Of containers only: what is poured into something else is not meant to stay."""
    poured = [trial for trial in trials if trial.label == "container"]
    return Share(sum(trial.n_clean_pours for trial in poured), sum(trial.n_pours for trial in poured))


def _trend(pair: tuple[Share, Share]) -> int | None:
    """1 if the share has grown, -1 if it has shrunk; none if it has not changed or is not known."""
    before, after = (share.value for share in pair)
    if before is None or after is None or before == after:
        return None
    return 1 if after > before else -1


def _mean(values: Iterable[float]) -> float | None:
    known = list(values)
    return sum(known) / len(known) if known else None
