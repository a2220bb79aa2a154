"""The most promising pours imagined again with errors of the set-up, and the choice that follows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from core.collision import CollisionModel
from core.files import read_json, write_json
from core.geometry import BoolArray
from core.imagination.choice import choose_pour, papers_order, surest_first
from core.imagination.clearance import clearances_m, clearest_first
from core.imagination.context import ImaginationContext
from core.imagination.cup_runs import CupRuns
from core.imagination.object_at_rest import ObjectAtRest
from core.imagination.pours import Pour, PouredCup, PourOutcome, in_turn_task, target_of_pours
from core.imagination.results import PourChoice, PourGrid
from core.imagination.risk.drawing import draw_cups
from core.imagination.risk.race import Race
from core.imagination.risk.result import RISK_FILE, FewerCandies, PourRisk, lower_bound
from core.progress import Reporter

STAGE = "risk"
CHOICE_FILE = "choice.json"
_FEWER = 2 / 3
"""Each amount tried is so much of the one before."""
_FEWEST = 5
_TRIES_OF_FEWER = 12
"""Eight clean ones of eight are 72 % sure; a round of four is left for a pour or two that spill at once."""


@dataclass(frozen=True)
class Tries:
    """What was tried of the pours, and the choice that follows.

    Attributes:
        risk: of the pours; none if no tries were asked for.
        choice: the surest pour, or the paper's if the risk is not known; none without pours.
    """

    risk: PourRisk | None
    choice: PourChoice | None

    def save(self, folder: Path) -> None:
        """Write `choice.json`, and `risk.json` if there were tries."""
        table = None if self.choice is None else self.choice.to_table()
        write_json(folder / CHOICE_FILE, {"choice": table})
        if self.risk is not None:
            self.risk.save(folder)

    @classmethod
    def load(cls, folder: Path) -> Tries:
        """Read what `save` wrote."""
        choice = read_json(folder / CHOICE_FILE)["choice"]
        return cls(
            PourRisk.load(folder) if (folder / RISK_FILE).is_file() else None,
            None if choice is None else PourChoice.from_table(choice),
        )


def try_pours(context: ImaginationContext, model: CollisionModel, grid: PourGrid, runs: CupRuns) -> Tries:
    """Try the most promising pours again with errors, and choose.

    Raises:
        StageError: the cup cannot hold N_pour.
    """
    risk = imagine_risk(context, model, grid, runs)
    return Tries(risk, choose_pour(grid, context.parameters.pouring.cup, risk=risk))


def imagine_risk(
    context: ImaginationContext,
    model: CollisionModel,
    grid: PourGrid,
    runs: CupRuns,
    known: PourRisk | None = None,
    feasible: BoolArray | None = None,
) -> PourRisk | None:
    """Try the most promising pours again with errors; none if the parameters ask for no tries.

    Cup and object are imagined one after the other, whatever `pouring.mode` says.

    Args:
        context: `risk` of its parameters says how often and with which errors.
        model: the object's body.
        grid: its imagined pours.
        runs: of the cup; objects may share them.
        known: earlier tries, to which these are added; none: there were none.
        feasible: (I, 3) which pours the arm can make; none: all of them.

    Raises:
        StageError: the cup cannot hold N_pour.
    """
    parameters, target = context.parameters, target_of_pours(context, model)
    settings = parameters.risk
    if settings.n_tries == 0:
        return None
    order = _clearest_first(papers_order(grid, feasible), context, target, grid)
    risk = run_race(context, target, grid, runs, Race(known or PourRisk.as_planned(grid), order, settings))
    if not order or max(risk.clean_at_least[pour] for pour in order) >= settings.wanted_clean:
        return risk
    return replace(risk, fewer=_try_fewer(context, target, grid, runs, surest_first(risk, order)))


def _clearest_first(
    order: Sequence[tuple[int, int]], context: ImaginationContext, target: ObjectAtRest, grid: PourGrid
) -> list[tuple[int, int]]:
    """Return the pours in the order in which equals are tried; the paper's where no hollow is known."""
    if target.hollows is None:
        return list(order)
    return clearest_first(order, clearances_m(grid, target.hollows, context.parameters.particle.diameter_m))


def _try_fewer(
    context: ImaginationContext,
    target: ObjectAtRest,
    grid: PourGrid,
    runs: CupRuns,
    order: Sequence[tuple[int, int]],
) -> FewerCandies | None:
    """Look for the largest smaller amount, in one cup, of which a pour is as sure as is wanted."""
    pouring, wanted = context.parameters.pouring, context.parameters.risk.wanted_clean
    settings = context.parameters.risk.model_copy(update={"n_tries": _TRIES_OF_FEWER, "sure": wanted})
    n_pour = int(grid.n_pour * _FEWER) if grid.n_cups == 1 else grid.n_pour
    best = np.array(_TRIES_OF_FEWER)
    while n_pour >= _FEWEST and lower_bound(best, best) >= wanted:
        fewer = replace(grid, n_pour=n_pour, n_cups=1)
        smaller = {"pouring": pouring.model_copy(update={"n_pour": n_pour})}
        own = context.reading(context.parameters.model_copy(update=smaller))
        race = Race(PourRisk.untried(fewer), order, settings)
        risk = run_race(own, target, fewer, runs, race)
        i, j = surest_first(risk, order)[0]
        if risk.clean_at_least[i, j] >= wanted:
            return FewerCandies(n_pour, i, j, int(risk.n_tries[i, j]), int(risk.n_clean[i, j]))
        n_pour = int(n_pour * _FEWER)
    return None


class _RoundReporter(Reporter):
    """Reports a round's progress as that of the whole race, so that it never goes back.

    The further tries of the surest pour are not counted: most races have none.
    """

    def __init__(self, face: Reporter, n_before: int, n_round: int, n_most: int) -> None:
        super().__init__()
        self._face = face
        self._n_before, self._n_round, self._n_most = n_before, n_round, n_most

    def progress(self, stage: str, done: float, total: float) -> None:
        n_done = self._n_before + self._n_round * done / total
        self._face.progress(stage, min(n_done, self._n_most), self._n_most)

    def warn(self, sentence: str) -> None:
        self._face.warn(sentence)

    def raise_if_cancelled(self) -> None:
        self._face.raise_if_cancelled()


def run_race(
    context: ImaginationContext, target: ObjectAtRest, grid: PourGrid, runs: CupRuns, race: Race
) -> PourRisk:
    """Imagine a race's tries until it is over, and return what is known then.

    Raises:
        StageError: the cup cannot hold N_pour.
    """
    parameters = context.parameters
    center_m = target.aabb_m.mean(axis=0)
    while (planned := race.next_round()) is not None:
        (i, j), tries = planned
        reporter = _RoundReporter(context.reporter, race.n_spent, len(tries), race.n_most)
        reporter.progress(STAGE, 0.0, 1.0)
        pour = Pour(grid.pivot_m[i, j], float(grid.theta_rad[i]))
        cups = [draw_cups(parameters, k, grid.n_cups, center_m) for k in tries]
        drawn_runs = iter(runs.of(context, [one for drawn in cups for one in drawn]))
        tasks = [
            in_turn_task(
                target,
                [PouredCup(next(drawn_runs), one.seen_from_object(pour.T_world_E)) for one in drawn],
                drawn[0].parameters(parameters),
            )
            for drawn in cups
        ]
        outcomes: list[PourOutcome] = replace(context, reporter=reporter).run(tasks, STAGE)
        race.record((i, j), [outcome.n_spilled for outcome in outcomes])
    return race.risk
