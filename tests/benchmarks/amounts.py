"""Does the recommended amount fit? Its cups are poured in the ground-truth simulation, into scanned objects.

Usage: python -m tests.benchmarks.amounts [--pours N] [--pick ID ...] [--seed N] [--amount safe|half|NUMBER]
   [--workers N] [NAME=VALUE ...]
Each try has other candies and other errors of the set-up. Of several cups all are poured into the object,
one after the other, and a try is clean if none of them spilled.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np

from app.operations.evaluation.ground_truth import ideal_path, pour_once
from app.operations.evaluation.placed_object import PlacedObject, known_surface, place_object
from core.collision import CollisionModel, build_collision_model
from core.errors import PoursightError, StageError
from core.evaluation.labels import LabelledObject, read_labels
from core.geometry import transform_points
from core.imagination.amount.reasoning import reason_amount
from core.imagination.amount.result import Amount, amount_sentence, parse_amount
from core.imagination.capacity.imagine import imagine_capacity
from core.imagination.capacity.result import Capacity
from core.imagination.context import ImaginationContext
from core.imagination.cup_runs import CupRuns
from core.imagination.drop import imagine_drop
from core.imagination.imagination import WORKER_MODULE
from core.imagination.pours import imagine_pours
from core.imagination.results import Drop, PourChoice
from core.imagination.risk.tries import try_pours
from core.mesh import TriangleMesh
from core.mesh_file import read_mesh
from core.parameters import Parameters, apply_settings
from core.progress import Reporter
from core.workers import RunHere, Task, WorkerPool
from hardware.simulation.pour_outcome.candies import NO_CANDIES, thickness_m
from hardware.simulation.pour_outcome.counting import in_object
from hardware.simulation.pour_outcome.outcome import TableOutcome
from hardware.simulation.pour_outcome.settings import OutcomeSettings
from tests.benchmarks.capacity import OBJECTS

CUPS_APART = 1000
"""Between the seeds of two cups: more than there are seeds."""


@dataclass(frozen=True)
class Row:
    """One object: the advice, how sure the pour is, and of each pour (spilled, of these once inside)."""

    capacity: Capacity
    amount: Amount
    clean_at_least: float
    poured: tuple[tuple[int, int], ...]
    problem: str = ""


def measure(
    one: LabelledObject, seed: int, request: str, n_pours: int, settings: tuple[tuple[str, str], ...]
) -> Row:
    """Scan an object, reason the amount, choose a pour and make it, in a worker."""
    parameters = apply_settings(Parameters(), {"seed": seed, **dict(settings)})
    mesh = read_mesh(one.mesh, Reporter())
    placed = place_object(mesh, "scan", seed)
    known = known_surface(mesh, placed, "scan", parameters, Reporter())
    model = build_collision_model(known.mesh, parameters.collision, Reporter())
    context = ImaginationContext(parameters, RunHere(), Reporter())
    drop = imagine_drop(context, model)
    capacity = imagine_capacity(context, model, drop)
    amount = reason_amount(parse_amount(request), capacity, parameters)
    if amount.refusal:
        return Row(capacity, amount, 0.0, (), amount.refusal)
    parameters = apply_settings(parameters, {"pouring.n_pour": amount.n_per_cup[0]})
    try:
        choice, clean_at_least = _chosen(context.reading(parameters), model, drop)
        poured = tuple(
            _poured(placed, choice, parameters, amount.n_per_cup, number) for number in range(n_pours)
        )
    except PoursightError as error:
        return Row(capacity, amount, 0.0, (), str(error))
    return Row(capacity, amount, clean_at_least, poured)


def _chosen(context: ImaginationContext, model: CollisionModel, drop: Drop) -> tuple[PourChoice, float]:
    """The pour, and the bound of its chance to spill nothing."""
    if drop.footprint is None:
        raise StageError("No candy stays in it, so there is no footprint to pour at.")
    runs = CupRuns()
    grid = imagine_pours(context, model, drop.footprint, runs)
    tries = try_pours(context, model, grid, runs)
    choice, risk = tries.choice, tries.risk
    if choice is None:
        raise AssertionError("without an arm every pour is feasible")
    return choice, float("nan") if risk is None else float(risk.clean_at_least[choice.i, choice.j])


def _poured(
    placed: PlacedObject,
    choice: PourChoice,
    parameters: Parameters,
    n_per_cup: tuple[int, ...],
    number: int,
) -> tuple[int, int]:
    """One try: candies spilled from all cups, and how many of them had been inside."""
    settings = OutcomeSettings(seed=parameters.seed)
    pouring, where = parameters.pouring, (RunHere(), Reporter())
    path = ideal_path(pouring, choice.pivot_m, choice.theta_rad)
    outcomes: list[TableOutcome] = []
    for n_candies in n_per_cup:
        lying = outcomes[-1].lying if outcomes else NO_CANDIES
        # Every cup has a packing and errors of its own.
        errors = settings.model_copy(update={"seed": settings.seed + len(outcomes) * CUPS_APART})
        cup = pouring.model_copy(update={"n_pour": n_candies})
        outcomes.append(pour_once(placed, path, cup, errors, number, *where, lying))
    over = sum(_once_inside(placed, one, settings) for one in outcomes)
    return sum(one.n_spilled for one in outcomes), over


def _once_inside(placed: PlacedObject, outcome: TableOutcome, settings: OutcomeSettings) -> int:
    """How many of the spilled candies had been inside before: they went over the rim, others beside it."""
    lost = ~(outcome.in_object | outcome.in_cup)
    stood = TriangleMesh(transform_points(outcome.T_given_stood, placed.true.vertices_m), placed.true.faces)
    height_m, candy_m = placed.platform.height_m, (settings.candy_diameter_m, thickness_m(settings))
    inside = [
        in_object(stood, positions.astype(float), height_m, 0.0, candy_m)
        for positions in outcome.recording.positions_m[:, lost]
    ]
    return int(np.any(inside, axis=0).sum())


def row_of(name: str, row: Row) -> str:
    """Return an object's row of the table."""
    spilled = [n for n, _ in row.poured]
    cells = [
        name,
        f"{row.capacity.n_candies:.0f} ({row.capacity.spread:.1f})",
        amount_sentence(row.amount),
        f"{row.clean_at_least:.2f}",
        f"{spilled.count(0)} of {len(spilled)}",
        " ".join(str(n) for n in spilled),
        str(sum(over for _, over in row.poured)),
        row.problem or row.amount.warning,
    ]
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--pours", type=int, default=10)
    parser.add_argument("--pick", nargs="*", default=[])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--amount", default="safe")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("settings", nargs="*", metavar="NAME=VALUE", default=[])
    chosen = parser.parse_args()
    settings = tuple((name, value) for name, _, value in (word.partition("=") for word in chosen.settings))
    containers = [one for one in read_labels(OBJECTS) if one.label == "container"]
    objects = [one for one in containers if not chosen.pick or one.name in chosen.pick]
    print("| object | fit (spread) | advice | sure | clean | spilled in each | over the rim | said |")
    print("|---|---|---|---|---|---|---|---|", flush=True)
    with WorkerPool(chosen.workers) as pool:
        pool.start(WORKER_MODULE)
        for one in objects:
            task = Task(measure, (one, chosen.seed, chosen.amount, chosen.pours, settings))
            row: Row = pool.run([task], "amounts", Reporter())[0]
            print(row_of(one.name, row), flush=True)


if __name__ == "__main__":
    main()
