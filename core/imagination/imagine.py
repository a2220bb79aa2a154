"""Both imaginations of one object, sharing the workers so that neither core waits."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter

import numpy as np

from core.collision import CollisionModel
from core.imagination.body import BodyFile, body_files
from core.imagination.choice import choose_pour
from core.imagination.containability import ObjectAtRest, drop_task
from core.imagination.cup import cup_parts
from core.imagination.drop_grid import grid_counts, pitch_m
from core.imagination.packing import CupRun, pack_cup, packing_task
from core.imagination.pouring import imagine_pours
from core.imagination.results import Containability, PourChoice, PourGrid
from core.parameters import Parameters
from core.progress import Reporter
from core.workers import WorkerPool

WORKER_MODULE = "core.imagination.preload"
"""What workers import before their first task."""


@dataclass(frozen=True)
class Imagination:
    """Everything imagined of an object; without grid and choice if it is no open container."""

    containability: Containability
    grid: PourGrid | None
    choice: PourChoice | None
    containability_s: float
    pouring_s: float


def imagine(
    model: CollisionModel, parameters: Parameters, pool: WorkerPool, reporter: Reporter
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
        packings = range(parameters.pouring.n_packings) if parameters.pouring.mode == "replay" else range(0)
        tasks = [drop_task(target, parameters)]
        tasks += [packing_task(files["cup"], parameters, packing) for packing in packings]
        results = pool.run(tasks, "containability", reporter)
        containability: Containability = results[0]
        cup_runs: list[CupRun] = results[1:]
        dropped = perf_counter()
        if not containability.is_open_container or containability.footprint is None:
            return Imagination(containability, None, None, dropped - started, 0.0)
        grid = imagine_pours(
            target, containability.footprint, files["cup"], cup_runs, parameters, pool, reporter
        )
        choice = choose_pour(grid, parameters.pouring.cup)
        return Imagination(containability, grid, choice, dropped - started, perf_counter() - dropped)


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


def _check(target: ObjectAtRest, parameters: Parameters) -> None:
    """Find out what cannot be imagined before a worker starts, and always in the same order."""
    _check_drop(target, parameters)
    pack_cup(parameters, 0)


def _check_drop(target: ObjectAtRest, parameters: Parameters) -> None:
    settings = parameters.containability
    extents = target.aabb_m[1] - target.aabb_m[0]
    grid_counts(extents, pitch_m(parameters.particle, settings), settings.n_max, settings.n_min)


def object_at_rest(model: CollisionModel, body: BodyFile, parameters: Parameters) -> ObjectAtRest:
    """Gather what the physics needs to know of the object."""
    margin = parameters.collision.aabb_margin_m
    aabb = np.array([model.surface.aabb_min_m - margin, model.surface.aabb_max_m + margin])
    return ObjectAtRest(body, aabb, model.surface.center_of_mass_m)
