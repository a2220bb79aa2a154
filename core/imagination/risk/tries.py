"""The race of the pours, run in physics: each round replays one pour with other errors of the set-up."""

from __future__ import annotations

from core.geometry import BoolArray
from core.imagination.choice import papers_order
from core.imagination.containability import ObjectAtRest
from core.imagination.cup_runs import CupRuns
from core.imagination.pours import Pour, PourOutcome, replay_task
from core.imagination.results import PourGrid
from core.imagination.risk.race import Race
from core.imagination.risk.results import PourRisk
from core.imagination.risk.set_up import draw_set_up
from core.parameters import Parameters
from core.progress import Reporter
from core.workers import TaskRunner

STAGE = "risk"


def imagine_risk(
    target: ObjectAtRest,
    grid: PourGrid,
    runs: CupRuns,
    parameters: Parameters,
    runner: TaskRunner,
    reporter: Reporter,
    known: PourRisk | None = None,
    feasible: BoolArray | None = None,
) -> PourRisk | None:
    """Try the most promising pours again with errors; none if the parameters ask for no tries.

    Cup and object are imagined one after the other, whatever `pouring.mode` says.

    Args:
        target: the object.
        grid: its imagined pours.
        runs: of the cup.
        parameters: of the imagination; `risk` says how often and with which errors.
        runner: where to compute.
        reporter: receives the progress.
        known: earlier tries, to which these are added; none: there were none.
        feasible: (I, 3) which pours the arm can make; none: all of them.
    """
    settings = parameters.risk
    if settings.n_tries == 0:
        return None
    race = Race(known or PourRisk.as_planned(grid), papers_order(grid, feasible), settings)
    center_m = target.aabb_m.mean(axis=0)
    spent = 0
    while (planned := race.next_round()) is not None:
        (i, j), tries = planned
        reporter.progress(STAGE, spent, settings.n_tries)
        set_ups = [draw_set_up(parameters, k, center_m) for k in tries]
        pour = Pour(grid.pivot_m[i, j], float(grid.theta_rad[i]))
        tasks = [
            replay_task(target, run, one.seen_from_object(pour.T_world_E), one.parameters(parameters), False)
            for one, run in zip(set_ups, runs.of(set_ups, runner, reporter), strict=True)
        ]
        outcomes: list[PourOutcome] = runner.run(tasks, STAGE, reporter)
        race.record((i, j), [outcome.n_spilled for outcome in outcomes])
        spent += len(tries)
    return race.risk
