"""Figures of trials: accuracy, AUC, success of the pours, margins, times (Sec. IV-B, V)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, sqrt
from typing import TypeAlias

from core.evaluation.evaluation import EvaluatedObject, Evaluation
from core.evaluation.trials import Measure, Trial, measure_of

Interval: TypeAlias = tuple[float, float]
_Z = 1.959963984540054
"""Quantile of the normal distribution for 95 %."""
_HALVINGS = 60


@dataclass(frozen=True)
class Share:
    """So many of so many.

    Attributes:
        count: those that are meant.
        n: all of them.
    """

    count: int
    n: int

    @property
    def value(self) -> float | None:
        """From 0 to 1; none of nothing."""
        return self.count / self.n if self.n else None

    @property
    def interval(self) -> Interval | None:
        """95 % score interval of Wilson (1927), which also holds for shares of 0 and 1; none of nothing."""
        if not self.n:
            return None
        from scipy.stats import binomtest

        found = binomtest(self.count, self.n).proportion_ci(method="wilson")
        return float(found.low), float(found.high)


def auc_interval(auc: float, n_containers: int, n_others: int) -> Interval:
    """Return the 95 % interval of an AUC, in the manner of Wilson's: it has a width for an AUC of 1, too.

    Method 5 of Newcombe (2006): the variance of Hanley and McNeil, taken at the bound that is sought.
    """
    pairs = n_containers * n_others
    spare = (n_containers + n_others) / 2 - 1

    def deviation(bound: float) -> float:
        shape = (1 - bound) / (2 - bound) + bound / (1 + bound)
        return _Z * sqrt(bound * (1 - bound) * (1 + spare * shape) / pairs)

    low = _edge(lambda bound: auc - bound > deviation(bound), 0.0, auc)
    high = _edge(lambda bound: bound - auc > deviation(bound), 1.0, auc)
    return low, high


@dataclass(frozen=True)
class Confusion:
    """Labelled trials by what they are and what they were judged; ambiguous objects are in none."""

    true_positive: int
    false_positive: int
    true_negative: int
    false_negative: int
    failed: int
    undecided: int = 0

    @property
    def accuracy(self) -> Share:
        """Share judged right; what failed, and what could not be told, is not right."""
        right = self.true_positive + self.true_negative
        return Share(right, right + self.false_positive + self.false_negative + self.failed + self.undecided)


@dataclass(frozen=True)
class Margin:
    """How far apart containers and others are.

    Attributes:
        smallest_container: (score, name) of the container with the smallest; none without one.
        largest_other: (score, name) of the non-container with the largest; none without one.
    """

    smallest_container: tuple[float, str] | None
    largest_other: tuple[float, str] | None

    @classmethod
    def of(cls, scores: Iterable[tuple[float, str, bool]]) -> Margin:
        """Find the margin of (score, name, whether it is a container)."""
        known = list(scores)
        return cls(
            min(((score, name) for score, name, is_container in known if is_container), default=None),
            max(((score, name) for score, name, is_container in known if not is_container), default=None),
        )

    @property
    def value(self) -> float | None:
        """How far the containers' score stays above the others'; negative where they overlap."""
        if self.smallest_container is None or self.largest_other is None:
            return None
        return self.smallest_container[0] - self.largest_other[0]


@dataclass(frozen=True)
class StageTime:
    """Seconds that a stage took for an object, over the trials that have it."""

    n: int
    mean_s: float
    median_s: float
    max_s: float


@dataclass(frozen=True)
class Figures:
    """The figures of some trials of one variant; ambiguous objects are in none.

    Attributes:
        trials: of labelled objects.
        n_pours: pours for each object that is judged a container.
        measure: what they were judged by.
    """

    trials: tuple[Trial, ...]
    n_pours: int
    measure: Measure

    @classmethod
    def of(cls, trials: Iterable[Trial], n_pours: int) -> Figures:
        """Leave out the ambiguous ones."""
        known = tuple(trials)
        labelled = tuple(trial for trial in known if trial.label != "ambiguous")
        return cls(labelled, n_pours, measure_of(known))

    @property
    def names(self) -> tuple[str, ...]:
        """The objects."""
        return tuple(dict.fromkeys(trial.name for trial in self.trials))

    @property
    def seeds(self) -> tuple[int, ...]:
        """The seeds, in ascending order."""
        return tuple(sorted({trial.seed for trial in self.trials}))

    def of_seed(self, seed: int) -> Figures:
        """Return the figures of one seed."""
        return replace(self, trials=tuple(trial for trial in self.trials if trial.seed == seed))

    @property
    def confusion(self) -> Confusion:
        """Trials by label and judgement."""
        judged = [trial for trial in self.trials if trial.score is not None]
        cells = Counter((trial.label, trial.is_judged_container) for trial in judged)
        return Confusion(
            cells["container", True],
            cells["non-container", True],
            cells["non-container", False],
            cells["container", False],
            len(self.trials) - len(judged),
            sum(trial.is_undecided for trial in judged),
        )

    @property
    def accuracy(self) -> Share:
        """Trials that were judged right."""
        return self.confusion.accuracy

    @property
    def right_objects(self) -> Share:
        """Objects that were judged right with every seed."""
        wrong = {trial.name for trial in self.trials if not trial.is_right}
        return Share(len(self.names) - len(wrong), len(self.names))

    @cached_property
    def auc(self) -> float | None:
        """Area under the ROC curve, of the score, ties half; none without both labels."""
        containers, others = self.scores
        if not containers or not others:
            return None
        from scipy.stats import mannwhitneyu

        n_above = mannwhitneyu(containers, others, method="asymptotic").statistic
        return float(n_above / (len(containers) * len(others)))

    @property
    def auc_interval(self) -> Interval | None:
        """95 % interval of the AUC."""
        containers, others = self.scores
        return None if self.auc is None else auc_interval(self.auc, len(containers), len(others))

    @property
    def pours(self) -> Share:
        """Pours without a spilled candy; a container that was not poured into failed in all of its pours.

        So did one that the program wrongly advised not to pour into; one that it rightly did counts nowhere.
        """
        counted = [_clean(trial, self.n_pours) for trial in self._container_trials]
        return Share(sum(one.count for one in counted), sum(one.n for one in counted))

    def pours_in(self, world: str) -> Share:
        """Pours into containers without a spilled candy, of those advised and made in one world."""
        counts = [
            count
            for trial in self._container_trials
            if not trial.is_declined
            for one, count in zip(trial.worlds, trial.spilled, strict=bool(trial.worlds))
            if one == world
        ]
        return Share(sum(count == 0 for count in counts), len(counts))

    @property
    def declined(self) -> Share:
        """Of the containers' trials in which pouring was not advised, those in which that was right."""
        declined = [trial for trial in self._container_trials if trial.is_declined]
        return Share(sum(trial.is_rightly_declined for trial in declined), len(declined))

    @property
    def clean_objects(self) -> Share:
        """Containers of which no pour, with no seed, spilled a candy."""
        counted = [(trial.name, _clean(trial, self.n_pours)) for trial in self._container_trials]
        names = {name for name, clean in counted if clean.n}
        spilled = {name for name, clean in counted if clean.count < clean.n}
        return Share(len(names - spilled), len(names))

    @property
    def stray_pours(self) -> tuple[Trial, ...]:
        """Trials in which something that is no container was poured into."""
        return tuple(trial for trial in self.trials if trial.label == "non-container" and trial.n_pours)

    @property
    def margin(self) -> Margin:
        """The margin over all trials."""
        judged = ((one.score, one.name, one.label == "container") for one in self.trials)
        return Margin.of((score, name, kind) for score, name, kind in judged if score is not None)

    @property
    def threshold(self) -> float:
        """The threshold of the first trial that was judged."""
        known = [one for one in self.trials if one.score is not None] or self.trials
        return known[0].threshold if known else 0.0

    @property
    def roc(self) -> tuple[tuple[float, float], ...]:
        """The ROC curve: (share of others, share of containers) above every threshold, from (0, 0) on."""
        containers, others = self.scores
        if not containers or not others:
            return ()
        steps = sorted({*containers, *others}, reverse=True)
        return ((0.0, 0.0), *((_at_least(others, step), _at_least(containers, step)) for step in steps))

    @cached_property
    def scores(self) -> tuple[list[float], list[float]]:
        """The score of the containers, and of the others."""
        judged = [(trial.score, trial.label) for trial in self.trials if trial.score is not None]
        return (
            [score for score, label in judged if label == "container"],
            [score for score, label in judged if label != "container"],
        )

    @property
    def _container_trials(self) -> tuple[Trial, ...]:
        return tuple(trial for trial in self.trials if trial.label == "container")


def figures_of(evaluation: Evaluation, variant: str, names: frozenset[str] | None = None) -> Figures:
    """Return the figures of a variant, of all objects or of those named."""
    trials = evaluation.of_variant(variant)
    named = (trial for trial in trials if names is None or trial.name in names)
    # A set in which all failed is judged as the others of its variant are.
    return replace(Figures.of(named, evaluation.n_pours), measure=measure_of(trials))


def sets_of(objects: Sequence[EvaluatedObject]) -> dict[str, frozenset[str]]:
    """Return the sets that get figures of their own, by name: all, restricted, calibration and other.

    The other objects are those to which no parameter was fitted. A set that would be empty is not there, and
    without calibration objects neither are the others, which would be all.
    """
    calibration = frozenset(one.name for one in objects if one.is_calibration)
    names = frozenset(one.name for one in objects)
    sets = {
        "all": names,
        "restricted": frozenset(one.name for one in objects if one.is_restricted),
        "calibration": calibration,
        "other": names - calibration if calibration else frozenset(),
    }
    return {name: members for name, members in sets.items() if members or name == "all"}


def stage_times(trials: Iterable[Trial]) -> dict[str, StageTime]:
    """Return seconds by stage, in the order in which the stages come."""
    import numpy as np

    seconds: dict[str, list[float]] = {}
    for trial in trials:
        for stage, took_s in trial.seconds.items():
            seconds.setdefault(stage, []).append(took_s)
    return {
        stage: StageTime(len(took), float(np.mean(took)), float(np.median(took)), max(took))
        for stage, took in seconds.items()
    }


@dataclass(frozen=True)
class AgreementOfPeople:
    """How far the people who were asked agreed (Sec. IV-B).

    Attributes:
        mean_share: share of an object's people who agree with the majority, averaged over the objects.
        n_objects: how many objects had so many of so many people with the majority; the most agreed first.
    """

    mean_share: float
    n_objects: Mapping[tuple[int, int], int]


@dataclass(frozen=True)
class CapacityFigures:
    """How true the stated capacities of containers are whose true one is known.

    Attributes:
        near: those within `NEAR` of the true one.
        within: those of which the true one lies between the stated least and most.
    """

    near: Share
    within: Share


NEAR = 0.1


def capacity_figures(evaluation: Evaluation, variant: str) -> CapacityFigures | None:
    """Return how true the capacities are; none where no container with a known one was measured."""
    true_ml = {one.name: one.capacity_ml for one in evaluation.objects if one.label == "container"}
    found = [
        (true, one.capacity_ml, one.capacity_least_ml, one.capacity_most_ml)
        for one in evaluation.of_variant(variant)
        if (true := true_ml.get(one.name)) and one.capacity_ml is not None
    ]
    bounds = [
        (true, least, inf if most is None else most) for true, _, least, most in found if least is not None
    ]
    if not found:
        return None
    return CapacityFigures(
        Share(sum(abs(said / true - 1) <= NEAR for true, said, *_ in found), len(found)),
        Share(sum(least <= true <= most for true, least, most in bounds), len(bounds)),
    )


def agreement_of(objects: Iterable[EvaluatedObject]) -> AgreementOfPeople | None:
    """Sum up the agreement; none where only labels are known."""
    majorities = [
        (max(one.n_container, one.n_asked - one.n_container), one.n_asked) for one in objects if one.n_asked
    ]
    if not majorities:
        return None
    shares = [agreed / asked for agreed, asked in majorities]
    counts = Counter(sorted(majorities, key=lambda pair: (-pair[0] / pair[1], -pair[1])))
    return AgreementOfPeople(sum(shares) / len(shares), dict(counts))


def _clean(trial: Trial, n_pours: int) -> Share:
    if trial.is_declined:
        return Share(0, 0 if trial.is_rightly_declined else n_pours)
    return Share(trial.n_clean_pours, trial.n_pours or n_pours)


def _at_least(values: Sequence[float], threshold: float) -> float:
    return sum(value >= threshold for value in values) / len(values)


def _edge(is_outside: Callable[[float], bool], outside: float, inside: float) -> float:
    """Bisect between a bound that is too far out and the AUC itself."""
    for _ in range(_HALVINGS):
        middle = (outside + inside) / 2
        if is_outside(middle):
            outside = middle
        else:
            inside = middle
    return inside
