"""The hollows of a surface, found by workers: when asked for, beside other tasks, or ahead of both."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from core.collision import CollisionModel
from core.imagination.capacity.basin import ML, Basin
from core.imagination.context import ImaginationContext
from core.imagination.particle_shape import particle_volume_m3
from core.mesh import TriangleMesh
from core.parameters import Parameters
from core.workers import Task

STAGE = "capacity"
HALF = 0.5
"""Candies half as large are asked about; a scan has gaps of its own that smaller ones would pass.

It is asked of the surface before it was simplified, where that is at hand: pinholes grow with fewer faces.
"""
_SMALLEST_CANDIES = 1.0
"""A hollow counts when its bulk holds so many."""
_USUAL_FRACTION = 0.6


def basin_of(context: ImaginationContext, surface: TriangleMesh, thickness_m: float) -> Basin:
    """Return what a surface holds of something so thick (m)."""
    task = _task(surface, thickness_m, context.parameters)
    made: Basin | None = context.ahead.of(surface, task.arguments[1:])
    return context.run([task], STAGE)[0] if made is None else made


def find_beside(
    context: ImaginationContext, surface: TriangleMesh, thickness_m: float, take: Callable[[Basin], None]
) -> None:
    """Let the same be found beside the next tasks, unless it is known; `take` receives it."""
    task = _task(surface, thickness_m, context.parameters)
    made: Basin | None = context.ahead.of(surface, task.arguments[1:])
    if made is None:
        context.spare.append((task, take))
    else:
        take(made)


def find_ahead(context: ImaginationContext, model: CollisionModel) -> None:
    """Let idle processors find what the capacity of an object needs, whatever stays of a drop."""
    parameters = context.parameters
    wanted = [(model.surface, 1.0), (model.most_detailed, HALF)]
    if model.unseen is not None:
        wanted.append((model.unseen.roomy, 1.0))
    for surface, scale in wanted:
        task = _task(surface, scale * parameters.particle.diameter_m, parameters)
        context.spare.append((task, partial(context.ahead.keep, surface, task.arguments[1:])))


def usual_bulk_ml(parameters: Parameters) -> float:
    """What a candy takes up in a container of usual size."""
    return particle_volume_m3(parameters.particle) * ML / _USUAL_FRACTION


def _task(surface: TriangleMesh, thickness_m: float, parameters: Parameters) -> Task:
    smallest_ml = _SMALLEST_CANDIES * usual_bulk_ml(parameters)
    return Task(_find, (surface, thickness_m, smallest_ml, parameters.capacity.lattice_points), 1.0)


def _find(surface: TriangleMesh, thickness_m: float, smallest_ml: float, points: int) -> Basin:
    from core.imagination.capacity.water import find_basin  # loads numba: in the worker alone

    return find_basin(surface, thickness_m, smallest_ml, points)
