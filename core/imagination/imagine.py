"""Both imaginations of one object, sharing the workers so that neither core waits."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter

from core.collision import CollisionModel
from core.geometry import BoolArray
from core.imagination.amount.deciding import decide_amount, is_number_in_one_cup
from core.imagination.amount.result import Amount
from core.imagination.body import body_files
from core.imagination.capacity.result import Capacity
from core.imagination.choice import choose_pour
from core.imagination.containability import ObjectAtRest, drop_task, object_at_rest
from core.imagination.cup import cup_parts
from core.imagination.cup_runs import CupRuns
from core.imagination.drop_grid import grid_counts, pitch_m
from core.imagination.holding.result import Holding
from core.imagination.judging import judge
from core.imagination.packing import pack_cup, packing_task
from core.imagination.pouring import imagine_pours
from core.imagination.results import Containability, PourChoice, PourGrid
from core.imagination.risk.results import PourRisk
from core.imagination.risk.set_up import as_planned
from core.imagination.risk.tries import imagine_risk
from core.parameters import Parameters
from core.progress import Reporter
from core.workers import TaskRunner

WORKER_MODULE = "core.imagination.preload"
"""What workers import before their first task."""


@dataclass(frozen=True)
class Imagination:
    """Everything imagined of an object; without grid, risk and choice if it is no open container.

    Attributes:
        containability: the drop, with the verdict.
        capacity: what the object holds; none if Omega decides, or nothing stayed in the drop.
        holding: how firmly; as `capacity`.
        amount: how many candies shall go in, and whether they fit; as `capacity`.
        grid: the pours.
        risk: of the pours; none also if no tries were asked for.
        choice: the surest pour, or the paper's if the risk is not known.
        paper_choice: what the paper's rule says.
        containability_s: seconds of the drop, the cup's runs and the verdict.
        pouring_s: seconds of the pours and their tries.
    """

    containability: Containability
    capacity: Capacity | None
    holding: Holding | None
    amount: Amount | None
    grid: PourGrid | None
    risk: PourRisk | None
    choice: PourChoice | None
    paper_choice: PourChoice | None
    containability_s: float
    pouring_s: float


def imagine(
    model: CollisionModel, parameters: Parameters, pool: TaskRunner, reporter: Reporter
) -> Imagination:
    """Imagine open containability and, if the object is an open container, the pours into it.

    Raises:
        StageError: the object is smaller than a candy, or the cup cannot hold N_pour.
    """
    cup = cup_parts(parameters.pouring.cup)
    with body_files(object=(model.parts, not model.is_convex), cup=(cup, False)) as files:
        target = object_at_rest(model, files["object"], parameters)
        _check(target, parameters)
        started = perf_counter()
        # The cup runs need nothing of the object: they fill the core that the drop leaves idle.
        early = _packings(parameters) if is_number_in_one_cup(parameters) else range(0)
        tasks = [drop_task(target, parameters)]
        tasks += [packing_task(files["cup"], parameters, packing) for packing in early]
        results = pool.run(tasks, "containability", reporter)
        judged = judge(model, results[0], parameters, pool, reporter)
        containability = judged.containability
        amount, parameters = decide_amount(judged.capacity, parameters)
        runs = CupRuns(parameters)
        for packing, run in zip(early, results[1:], strict=True):
            runs.add(as_planned(packing), run)
        dropped = perf_counter()
        known = containability, judged.capacity, judged.holding, amount
        if not containability.is_open_container or containability.footprint is None:
            return Imagination(*known, None, None, None, None, dropped - started, 0.0)
        planned = runs.of([as_planned(packing) for packing in _packings(parameters)], pool, reporter)
        grid = imagine_pours(
            target, containability.footprint, files["cup"], planned, parameters, pool, reporter
        )
        risk = imagine_risk(target, grid, runs, parameters, pool, reporter)
        choice = choose_pour(grid, parameters.pouring.cup, risk=risk)
        paper_choice = choose_pour(grid, parameters.pouring.cup)
        seconds = dropped - started, perf_counter() - dropped
        return Imagination(*known, grid, risk, choice, paper_choice, *seconds)


def imagine_containability(model: CollisionModel, parameters: Parameters) -> Containability:
    """Imagine open containability alone, in this process, which should be a worker.

    Raises:
        StageError: the object is smaller than a candy.
    """
    with body_files(object=(model.parts, not model.is_convex)) as files:
        target = object_at_rest(model, files["object"], parameters)
        _check_drop(target, parameters)
        task = drop_task(target, parameters)
        found: Containability = task.function(*task.arguments)
        return found


def imagine_grid(
    model: CollisionModel,
    found: Containability,
    runs: CupRuns,
    parameters: Parameters,
    runner: TaskRunner,
    reporter: Reporter,
) -> PourGrid:
    """Imagine the pours into an object of which some candies stayed.

    Args:
        model: the object's body.
        found: its containability; with a footprint.
        runs: of the cup; objects may share them.
        parameters: of the imagination.
        runner: where to compute.
        reporter: receives the progress.

    Raises:
        StageError: the cup cannot hold N_pour.
    """
    if found.footprint is None:
        raise ValueError("no candy stayed: there is no footprint to pour at")
    cup = cup_parts(parameters.pouring.cup)
    packings = _packings(parameters)
    planned = runs.of([as_planned(packing) for packing in packings], runner, reporter)
    with body_files(object=(model.parts, not model.is_convex), cup=(cup, False)) as files:
        target = object_at_rest(model, files["object"], parameters)
        return imagine_pours(target, found.footprint, files["cup"], planned, parameters, runner, reporter)


def imagine_grid_risk(
    model: CollisionModel,
    grid: PourGrid,
    runs: CupRuns,
    parameters: Parameters,
    runner: TaskRunner,
    reporter: Reporter,
    known: PourRisk | None = None,
    feasible: BoolArray | None = None,
) -> PourRisk | None:
    """Find the risk of pours that were imagined before; none if the parameters ask for no tries.

    Args:
        model: the object's body.
        grid: the pours.
        runs: of the cup; objects may share them.
        parameters: of the imagination.
        runner: where to compute.
        reporter: receives the progress.
        known: earlier tries, to which these are added; none: there were none.
        feasible: (I, 3) which pours the arm can make; none: all of them.

    Raises:
        StageError: the cup cannot hold N_pour.
    """
    with body_files(object=(model.parts, not model.is_convex)) as files:
        target = object_at_rest(model, files["object"], parameters)
        return imagine_risk(target, grid, runs, parameters, runner, reporter, known, feasible)


def _packings(parameters: Parameters) -> range:
    """The packings whose cup runs the pours need: none if cup and object are simulated together."""
    return range(parameters.pouring.n_packings if parameters.pouring.mode == "replay" else 0)


def _check(target: ObjectAtRest, parameters: Parameters) -> None:
    """Find out what cannot be imagined before a worker starts, and always in the same order."""
    _check_drop(target, parameters)
    if parameters.containability.verdict == "omega":  # else several cups can be poured
        pack_cup(parameters, 0)


def _check_drop(target: ObjectAtRest, parameters: Parameters) -> None:
    settings = parameters.containability
    extents = target.aabb_m[1] - target.aabb_m[0]
    grid_counts(extents, pitch_m(parameters.particle, settings), settings.n_max, settings.n_min)
