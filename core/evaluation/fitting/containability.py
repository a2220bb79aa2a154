"""Fitting what decides the verdict to labelled objects, over several seeds (Sec. IV-C).

A case is prepared once and judged in every trial. A trial goes seed by seed; when the margin over the seeds
so far is below that of the best trial, the other seeds cannot mend it and the trial is given up. What is
given up, and so the whole search, does not depend on the number of workers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from core.collision import CollisionModel
from core.errors import InputError, StageError, WorkerError
from core.evaluation.fitting.fitted import FittedParameter, parameters_of_trial, start_values
from core.evaluation.fitting.scores import CaseScore, FitScore
from core.evaluation.fitting.search import FitResult, FitStep, FitTrial, PartReporter, search
from core.evaluation.judging import drop_and_fill
from core.parameters import Parameters
from core.progress import Reporter
from core.workers import Task, TaskRunner, WorkerReporter

STAGE = "fitting"


@dataclass(frozen=True)
class FitCase:
    """An object as it is known with one seed.

    Attributes:
        name: the object's.
        is_container: what a person calls it.
        seed: of the candies; for a scanned object also of its scan.
        model: its body.
    """

    name: str
    is_container: bool
    seed: int
    model: CollisionModel


@dataclass(frozen=True)
class FitRequest:
    """What to fit.

    Attributes:
        parameters: to start from.
        fitted: the parameters to be fitted; the threshold always is.
        n_trials: sets of values to try, the one to start from among them.
        sampler_seed: of the search.
    """

    parameters: Parameters
    fitted: tuple[FittedParameter, ...]
    n_trials: int
    sampler_seed: int = 0


ContainabilityStep = FitStep[FitScore]
ContainabilityResult = FitResult[FitScore]
JudgeCase = Callable[[FitCase, Parameters], float]


def fit(
    cases: Sequence[FitCase],
    request: FitRequest,
    runner: TaskRunner,
    reporter: Reporter,
    report: Callable[[ContainabilityStep], None],
    judge: JudgeCase | None = None,
) -> ContainabilityResult:
    """Find the values with the largest margin: smallest score of a container less the largest of any other.

    Args:
        cases: of all objects and seeds.
        request: what to fit.
        runner: where to judge; the cases of a seed are judged side by side.
        reporter: receives the progress; asked to stop, what was found so far is the result.
        report: called after each trial.
        judge: returns the score; none: by imagination. A function of a module, for it is sent to workers.

    Raises:
        InputError: the cases are all containers, or none is.
        StageError: a case cannot be judged with the parameters to start from.
        Cancelled: somebody asked to stop before the first trial was done.
        WorkerError: workers died in the same trial twice.
    """
    _check(cases)
    judging = _Judging(cases, request, runner, reporter, judge or score_of)
    start = start_values(request.fitted, request.parameters)
    return search(request.fitted, start, judging, request.n_trials, request.sampler_seed, report)


def score_of(case: FitCase, parameters: Parameters) -> float:
    """Return the capacity share of a case or its Omega (Eq. 1), whichever judges; in this process.

    Raises:
        StageError: the object is smaller than a candy.
        Cancelled: somebody asked to stop.
    """
    seeded = parameters.model_copy(update={"seed": case.seed})
    found, share = drop_and_fill(case.model, seeded, WorkerReporter())
    return found.omega if share is None else share


class _Judging:
    """Judges one trial after the other."""

    def __init__(
        self,
        cases: Sequence[FitCase],
        request: FitRequest,
        runner: TaskRunner,
        reporter: Reporter,
        judge: JudgeCase,
    ) -> None:
        seeds = sorted({one.seed for one in cases})
        self._by_seed = [[one for one in cases if one.seed == seed] for seed in seeds]
        self._request = request
        self._n_trials = request.n_trials if request.fitted else 1
        self._runner = runner
        self._reporter = reporter
        self._judge = judge

    def __call__(self, number: int, values: Mapping[str, float], best: FitTrial[FitScore] | None) -> FitScore:
        request = self._request
        parameters = parameters_of_trial(request.parameters, request.fitted, number, values)
        scores: list[CaseScore] = []
        for index, cases in enumerate(self._by_seed):
            begun = number + index / len(self._by_seed)
            part = PartReporter(self._reporter, STAGE, begun, 1 / len(self._by_seed), self._n_trials)
            scores += self._judged(cases, parameters, number == 0, part)
            is_last = index == len(self._by_seed) - 1
            score = FitScore(tuple(scores), is_given_up=not is_last)
            if is_last or (best is not None and score.margin < best.score.margin):
                return score
        raise AssertionError("there is a last seed")

    def _judged(
        self, cases: Sequence[FitCase], parameters: Parameters, is_start: bool, reporter: Reporter
    ) -> list[CaseScore]:
        tasks = [Task(_judge_case, (self._judge, one, parameters)) for one in cases]
        try:
            found = self._runner.run(tasks, STAGE, reporter)
        except WorkerError:
            found = self._runner.run(tasks, STAGE, reporter)  # the pool starts new workers
        return [_score(one, each, is_start) for one, each in zip(cases, found, strict=True)]


def _judge_case(judge: JudgeCase, case: FitCase, parameters: Parameters) -> float | str:
    """Return the score, or why there is none; in a worker."""
    try:
        return judge(case, parameters)
    except StageError as error:
        return str(error)


def _score(case: FitCase, found: float | str, is_start: bool) -> CaseScore:
    """What cannot be judged counts as judged most wrongly: such values are of no use."""
    if not isinstance(found, str):
        return CaseScore(case.name, case.is_container, case.seed, found)
    if is_start:
        raise StageError(
            f"'{case.name}' cannot be judged with the parameters to start from: {found} Leave the object "
            "out, or start from others."
        )
    return CaseScore(case.name, case.is_container, case.seed, 0.0 if case.is_container else 1.0)


def _check(cases: Sequence[FitCase]) -> None:
    n_containers = sum(one.is_container for one in cases)
    if n_containers in (0, len(cases)):
        kind = "container" if n_containers == 0 else "object that is no container"
        raise InputError(
            f"Nothing can be fitted to {len(cases)} cases without a single {kind}: label objects of both "
            "kinds."
        )
    for seed in {one.seed for one in cases}:
        kinds = {one.is_container for one in cases if one.seed == seed}
        if len(kinds) < 2:
            raise InputError(
                f"With seed {seed} there are only objects of one kind left; leave that seed out."
            )
