"""Capacity by imagined filling: how many candies stay, and what that is in ml."""

from __future__ import annotations

from dataclasses import replace
from statistics import fmean, pstdev

import numpy as np

from core.imagination.capacity.basin import ML, Basin
from core.imagination.capacity.explain import Facts, explain
from core.imagination.capacity.filling import Filling, FillPlan, filling_task
from core.imagination.capacity.packing import bulk_ml
from core.imagination.capacity.places import rain_places
from core.imagination.capacity.result import Capacity
from core.imagination.capacity.stand_in import (
    ball_diameter_m,
    ball_of,
    candy_itself,
    particle_volume_m3,
)
from core.imagination.containability import ObjectAtRest
from core.imagination.results import Containability
from core.mesh import TriangleMesh
from core.parameters import Parameters
from core.parameters.capacity import CapacityParameters
from core.progress import Reporter
from core.workers import Task, TaskRunner

STAGE = "capacity"
_SMALLEST_CANDIES = 1.0
"""A hollow counts when its bulk holds so many."""
_USUAL_FRACTION = 0.6
_MOST_FOR_MOUTH = 1.5
"""Times the balls aimed at that a narrow mouth may lead to: then they become larger than it would like."""
_PLUGGED = 1.1
"""Gaps matter when the hollow is by so much larger for what is as thick as the balls."""


def imagine_capacity(
    surface: TriangleMesh,
    target: ObjectAtRest,
    found: Containability,
    parameters: Parameters,
    settings: CapacityParameters,
    runner: TaskRunner,
    reporter: Reporter,
) -> Capacity:
    """Fill an object in imagination, and find its geometric volume.

    Args:
        surface: of the object, in the frame of `target`.
        target: its body, as the drop had it.
        found: its containability: candies rain where those that stayed had been dropped.
        parameters: of the imagination.
        settings: of the filling.
        runner: where to compute.
        reporter: receives the progress.
    """
    task = _basin_task(surface, parameters.particle.diameter_m, parameters, settings)
    basin: Basin = runner.run([task], STAGE, reporter)[0]
    plan = _plan(basin, found, parameters, settings)
    if not found.retained.any():
        return _result(plan, basin, (), surface, parameters)
    if plan.stand_in.scale > 1:
        task = _basin_task(surface, plan.stand_in.particle.diameter_m, parameters, settings)
        plan = _without_plugs(plan, basin, runner.run([task], STAGE, reporter)[0])
    tasks = [filling_task(target, plan, k, parameters, settings) for k in range(settings.n_fillings)]
    fillings: list[Filling] = runner.run(tasks, STAGE, reporter)
    return _result(plan, basin, tuple(fillings), surface, parameters)


def _basin_task(
    surface: TriangleMesh, thickness_m: float, parameters: Parameters, settings: CapacityParameters
) -> Task:
    smallest_ml = _SMALLEST_CANDIES * _usual_bulk_ml(parameters)
    return Task(_find_basin, (surface, thickness_m, smallest_ml, settings.lattice_points), 1.0)


def _find_basin(surface: TriangleMesh, thickness_m: float, smallest_ml: float, points: int) -> Basin:
    from core.imagination.capacity.water import find_basin  # loads numba: in the worker alone

    return find_basin(surface, thickness_m, smallest_ml, points)


def _plan(
    basin: Basin, found: Containability, parameters: Parameters, settings: CapacityParameters
) -> FillPlan:
    # What the drop left inside fits, whatever the geometry says of gaps.
    n_candies = max(basin.candies_ml / _usual_bulk_ml(parameters), float(found.n_in))
    stand_in = candy_itself(parameters)
    if n_candies > settings.n_real:
        scale = (n_candies / settings.n_aimed) ** (1 / 3)
        widest = basin.mouth_m / settings.widths_in_mouth / ball_diameter_m(parameters.particle)
        least = (n_candies / settings.n_aimed / _MOST_FOR_MOUTH) ** (1 / 3)
        stand_in = ball_of(parameters, max(min(scale, widest), least, 1.0))
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


def _usual_bulk_ml(parameters: Parameters) -> float:
    """What a candy takes up in a container of usual size."""
    return particle_volume_m3(parameters.particle) * ML / _USUAL_FRACTION


def _result(
    plan: FillPlan,
    basin: Basin,
    fillings: tuple[Filling, ...],
    surface: TriangleMesh,
    parameters: Parameters,
) -> Capacity:
    per_candy = bulk_ml(parameters.particle, basin.around)
    per_particle = bulk_ml(plan.stand_in.particle, basin.around)
    counts = [filling.n_kept * per_particle / per_candy for filling in fillings] or [0.0]
    volume = fmean([filling.n_level for filling in fillings] or [0.0]) * per_particle
    facts = _facts(basin, fillings, per_particle, volume, surface, parameters)
    heights = basin.heights_m - basin.heights_m[0] if len(basin.heights_m) else np.empty(0)
    return Capacity(
        n_candies=fmean(counts),
        spread=pstdev(counts),
        volume_ml=volume,
        heaped_ml=facts.heaped_ml,
        geometric_volume_ml=basin.water_ml,
        candy_hollow_ml=basin.candies_ml,
        candy_scale=plan.stand_in.scale,
        n_poured=tuple(filling.n_poured for filling in fillings),
        n_full=tuple(filling.n_full for filling in fillings),
        n_kept=tuple(filling.n_kept for filling in fillings),
        rim_height_m=float(heights[-1]) if len(heights) else 0.0,
        fill_height_m=float(np.interp(volume, basin.volumes_ml, heights)) if len(heights) else 0.0,
        explanation=explain(facts),
        heights_m=heights,
        volumes_ml=basin.volumes_ml,
        candies_per_ml=1 / per_candy,
        recording=fillings[0].recording if fillings else None,
    )


def _facts(
    basin: Basin,
    fillings: tuple[Filling, ...],
    per_particle: float,
    volume_ml: float,
    surface: TriangleMesh,
    parameters: Parameters,
) -> Facts:
    n = max(len(fillings), 1)
    lost = sum(filling.n_poured - filling.n_kept for filling in fillings)
    foot_m = float(surface.aabb_min_m[2])
    return Facts(
        imagined_ml=volume_ml,
        heaped_ml=fmean([one.n_kept - one.n_level for one in fillings] or [0.0]) * per_particle,
        water_ml=basin.water_ml,
        hollow_ml=basin.candies_ml,
        narrow_ml=basin.narrow_ml,
        shaken_off_ml=sum(filling.n_level_full - filling.n_level for filling in fillings) * per_particle / n,
        left_below=sum(filling.n_below for filling in fillings) / max(lost, 1),
        water_level_m=basin.water_level_m - foot_m,
        rim_m=basin.rim_m - foot_m,
        mouth_m=basin.mouth_m,
        candy_m=parameters.particle.diameter_m,
    )
