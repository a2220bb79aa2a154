"""The fillings of an object, and those of smaller candies where candies might only arch over an opening."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from statistics import fmean

import numpy as np

from core.collision import CollisionModel
from core.imagination.capacity.basin import Basin
from core.imagination.capacity.filling import Filling, FillPlan, filling_task, rain_places
from core.imagination.capacity.finding import HALF, STAGE, basin_of, usual_bulk_ml
from core.imagination.capacity.openings import has_opening_below
from core.imagination.capacity.stand_in import ball_diameter_m, bulk_ml, smaller_candy, stand_in_for
from core.imagination.context import ImaginationContext
from core.imagination.particle_shape import particle_extents_m
from core.imagination.results import Drop
from core.parameters import Parameters
from core.workers import Task

_HEAPED = 0.5
"""Share of what stays that lies below a rim, below which an arch is possible."""
_SMALLER = 0.7
"""Size of smaller candies: over an opening that a candy just passes, they hardly arch."""
_ARCHES = 0.5
"""A heap of smaller candies is hardly smaller."""
_DRAINS = 0.1
"""Water left in a hollow for candies, below which it has an opening that they do not pass, or only just."""
_WIDE = 0.85
"""Width of such an opening, in candies, from which on they may pass; a lattice takes it for narrower."""
_FEW = 60
"""Half as large candies that show whether they run out."""
_PLUGGED = 1.1
"""Gaps matter when the hollow is by so much larger for what is as thick as the balls."""


@dataclass(frozen=True)
class Filled:
    """What an object was filled with.

    Attributes:
        plan: of the fillings.
        fillings: none if nothing stayed of the drop.
        is_below_arch: whether these are smaller candies, for candies only arch over an opening.
    """

    plan: FillPlan
    fillings: tuple[Filling, ...]
    is_below_arch: bool = False


def fill(context: ImaginationContext, model: CollisionModel, drop: Drop, basin: Basin) -> Filled:
    """Fill an object of which a drop (on it, or on one that differs where nobody saw) left something."""
    if not drop.retained.any():
        return Filled(_plan(basin, drop, context.parameters), ())
    plan = _plan_for(context, model, drop, basin)
    fillings = _fill(context, model, plan)
    below = _below_an_arch(context, model, drop, plan, fillings)
    return Filled(plan, fillings) if below is None else below


def fill_beside(context: ImaginationContext, model: CollisionModel, drop: Drop) -> None:
    """Let an object be filled beside the next tasks: `fill` then finds it done."""
    if not drop.retained.any():
        return
    parameters = context.parameters
    plan = _plan_for(context, model, drop, basin_of(context, model.surface, parameters.particle.diameter_m))
    may_run_out = _may_run_out(context, model, drop, plan.basin)
    for one in [plan, _of_few_small_candies(plan, parameters)] if may_run_out else [plan]:
        for k, task in enumerate(_filling_tasks(context, model, one)):
            asked = _asked(one, k, parameters)
            context.spare.append((task, partial(context.ahead.keep, model.surface, asked)))


def bulk_of_ml(plan: FillPlan, fillings: tuple[Filling, ...], basin: Basin) -> float:
    """Return the bulk volume of what stays, in the mean of the fillings."""
    return fmean(one.n_kept for one in fillings) * bulk_ml(plan.stand_in.particle, basin.around)


def _fill(context: ImaginationContext, model: CollisionModel, plan: FillPlan) -> tuple[Filling, ...]:
    tasks = _filling_tasks(context, model, plan)
    asked = [_asked(plan, k, context.parameters) for k in range(len(tasks))]
    made: list[Filling | None] = [context.ahead.of(model.surface, one) for one in asked]
    missing = [task for task, filling in zip(tasks, made, strict=True) if filling is None]
    others = iter(context.run(missing, STAGE) if missing else ())
    return tuple(next(others) if filling is None else filling for filling in made)


def _filling_tasks(context: ImaginationContext, model: CollisionModel, plan: FillPlan) -> list[Task]:
    parameters, target = context.parameters, context.target(model)
    settings = parameters.capacity
    is_large = plan.n_expected * plan.stand_in.scale**3 > settings.filled_once
    n_fillings = 1 if is_large else settings.n_fillings
    return [filling_task(target, plan, k, parameters) for k in range(n_fillings)]


def _asked(plan: FillPlan, filling: int, parameters: Parameters) -> tuple[object, ...]:
    """Tells a filling from all others of its surface: where it rains follows from the rest."""
    return plan.stand_in, plan.n_expected, plan.only_level, filling, parameters


def _below_an_arch(
    context: ImaginationContext,
    model: CollisionModel,
    drop: Drop,
    plan: FillPlan,
    fillings: tuple[Filling, ...],
) -> Filled | None:
    """Return what is left of smaller candies, where those that stay only arch over an opening; else none."""
    parameters, basin = context.parameters, plan.basin
    smaller_m = _SMALLER * float(particle_extents_m(parameters.particle).min())
    if _is_mostly_heaped(fillings) and _has_opening(context, model, drop, basin, smaller_m):
        smaller = _of_smaller_candies(plan, parameters)
        also = _fill(context, model, smaller)
        if bulk_of_ml(smaller, also, basin) < _ARCHES * bulk_of_ml(plan, fillings, basin):
            return Filled(smaller, also, is_below_arch=True)
    if _may_run_out(context, model, drop, basin):
        few = _of_few_small_candies(plan, parameters)
        also = _fill(context, model, few)
        if sum(one.n_kept for one in also) < _ARCHES * sum(one.n_poured for one in also):
            return Filled(few, also, is_below_arch=True)
    return None


def _is_mostly_heaped(fillings: tuple[Filling, ...]) -> bool:
    """Whether most of what stays lies above any rim: a heap on a floor, or an arch over an opening."""
    return sum(one.n_level for one in fillings) < _HEAPED * sum(one.n_kept for one in fillings)


def _may_run_out(context: ImaginationContext, model: CollisionModel, drop: Drop, basin: Basin) -> bool:
    """Whether candies that stay may close an opening that smaller ones pass."""
    wide_m = _WIDE * ball_diameter_m(context.parameters.particle)
    drains = basin.water_ml < _DRAINS * basin.candies_ml
    return drains and _has_opening(context, model, drop, basin, wide_m)


def _has_opening(
    context: ImaginationContext, model: CollisionModel, drop: Drop, basin: Basin, width_m: float
) -> bool:
    """Whether something of a width could fall through below the candies that stayed."""
    places_m = drop.drop_positions_m[drop.retained, :2]
    task = Task(has_opening_below, (model.surface, places_m, basin.hollow_map, width_m))
    return bool(context.run([task], STAGE)[0])


def _of_smaller_candies(plan: FillPlan, parameters: Parameters) -> FillPlan:
    """Smaller ones form a heap as well, but no arch over an opening that candies pass one by one."""
    stand_in = smaller_candy(parameters, _SMALLER)
    n_expected = plan.n_expected * (plan.stand_in.scale / _SMALLER) ** 3
    return replace(plan, stand_in=stand_in, n_expected=n_expected)


def _of_few_small_candies(plan: FillPlan, parameters: Parameters) -> FillPlan:
    """So many show whether they run out."""
    return replace(plan, stand_in=smaller_candy(parameters, HALF), n_expected=_FEW, runs_over=False)


def _plan_for(context: ImaginationContext, model: CollisionModel, drop: Drop, basin: Basin) -> FillPlan:
    plan = _plan(basin, drop, context.parameters)
    if plan.stand_in.scale == 1:
        return plan
    for_balls = basin_of(context, model.surface, plan.stand_in.particle.diameter_m)
    return _without_plugs(plan, basin, for_balls)


def _plan(basin: Basin, found: Drop, parameters: Parameters) -> FillPlan:
    # What the drop left inside fits, whatever the geometry says of gaps.
    n_candies = max(basin.candies_ml / usual_bulk_ml(parameters), float(found.n_in))
    stand_in = stand_in_for(n_candies, basin.mouth_m, parameters)
    extents_m = found.aabb_m[1, :2] - found.aabb_m[0, :2]
    apart_m = float(np.sqrt(np.prod(extents_m) / found.n_drop))
    footprint_m = found.drop_positions_m[found.retained, :2]
    radius_m = stand_in.particle.diameter_m / 2
    places_m = rain_places(basin, footprint_m, radius_m, apart_m) if len(footprint_m) else footprint_m
    return FillPlan(stand_in, places_m, n_candies / stand_in.scale**3, basin)


def _without_plugs(plan: FillPlan, basin: Basin, for_balls: Basin) -> FillPlan:
    """Count only what lies below the candies' rim, if balls close gaps that candies pass."""
    if for_balls.candies_ml <= _PLUGGED * basin.candies_ml or basin.candies_ml == 0:
        return plan
    return replace(plan, only_level=True)
