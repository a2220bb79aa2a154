"""Judging one object in a worker; what goes wrong with it becomes part of its verdict."""

from __future__ import annotations

from pathlib import Path
from time import perf_counter

from core.collision import CollisionModel
from core.collision.build import read_collision_model
from core.errors import Cancelled, PoursightError
from core.evaluation.labels import LabelledObject
from core.evaluation.verdicts import ObjectVerdict, measure_by, mesh_mark
from core.imagination.context import ImaginationContext
from core.imagination.drop import imagine_drop
from core.imagination.judgement import capacity_share
from core.imagination.results import Drop
from core.parameters import Parameters
from core.progress import Reporter
from core.workers import RunHere, Task, WorkerReporter


def judging_task(one: LabelledObject, parameters: Parameters, file: Path) -> Task:
    """Return the task that judges an object and writes its `ObjectVerdict` to a file."""
    return Task(judge_object, (one, parameters, file))


def judge_object(one: LabelledObject, parameters: Parameters, file: Path) -> None:
    """Judge an object and write its verdict.

    Raises:
        Cancelled: somebody asked to stop; nothing is written.
    """
    began_s = perf_counter()
    n_drop, n_in, share, problem = 0, 0, None, ""
    reporter = WorkerReporter()
    try:
        model = read_collision_model(one.mesh, parameters.collision, reporter)
        found, share = drop_and_fill(model, parameters, reporter)
        n_drop, n_in = found.n_drop, found.n_in  # with the share or not at all: without it Omega would judge
    except Cancelled:
        raise
    except PoursightError as error:
        problem = str(error)
    except Exception as error:  # one object must not end the run of all others
        problem = f"A fault of the program ended this ({type(error).__name__}: {error})."
    seconds = round(perf_counter() - began_s, 3)
    ObjectVerdict(one.name, mesh_mark(one.mesh), n_drop, n_in, seconds, problem, share).save(file)


def drop_and_fill(
    model: CollisionModel, parameters: Parameters, reporter: Reporter
) -> tuple[Drop, float | None]:
    """Let candies drop, and find the capacity share where that decides; in this process.

    Raises:
        StageError: the object is smaller than a candy.
        Cancelled: somebody asked to stop.
    """
    context = ImaginationContext(parameters, RunHere(), reporter)
    drop = imagine_drop(context, model)
    if measure_by(parameters) == "Omega":
        return drop, None
    return drop, capacity_share(context, model, drop)
