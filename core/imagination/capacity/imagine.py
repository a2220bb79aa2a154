"""Capacity by imagined filling: how many candies stay, and what that is in ml."""

from __future__ import annotations

from dataclasses import dataclass, replace
from statistics import fmean, pstdev

import numpy as np

from core.collision import CollisionModel
from core.imagination.capacity.basin import ML, Basin
from core.imagination.capacity.filled import Filled, bulk_of_ml, fill
from core.imagination.capacity.filling import Filling, FillPlan
from core.imagination.capacity.finding import HALF, basin_of, find_beside
from core.imagination.capacity.result import Capacity
from core.imagination.capacity.stand_in import (
    bulk_ml,
)
from core.imagination.context import ImaginationContext
from core.imagination.results import Drop
from core.mesh import TriangleMesh
from core.mesh_topology import hull_volume_m3
from core.parameters import Parameters

ARCH = "Candies only arch over an opening that they can pass: smaller ones fall through."
_FALL_THROUGH = 0.5
"""Share of the hollow for candies, below which the hollow for half as large ones leaks."""


def imagine_capacity(context: ImaginationContext, model: CollisionModel, drop: Drop) -> Capacity:
    """Fill an object in imagination, and find its geometric volume.

    Args:
        context: its parameters say how it is filled.
        model: the object's body.
        drop: on the same object: candies rain where those that stayed had been dropped.
    """
    diameter_m = context.parameters.particle.diameter_m
    basin = basin_of(context, model.surface, diameter_m)
    half_m = HALF * diameter_m
    if drop.retained.any():
        find_beside(context, model.most_detailed, half_m)
    filled = fill(context, model, drop, basin)
    found = _told(context, model, filled)
    if filled.fillings and not filled.is_below_arch:
        for_half = basin_of(context, model.most_detailed, half_m)
        if for_half.candies_ml < _FALL_THROUGH * basin.candies_ml:
            found = replace(found, too_small_m=half_m)
    if model.surface_error_m == 0 or not found.n_kept:
        return found
    is_thin = model.surface.mean_thickness_m < _THIN_M
    least_ml, most_ml = between_ml(found.filled_ml, basin, model.surface_error_m, is_thin)
    found = replace(found, least_ml=least_ml, is_thin=is_thin)
    if model.unseen is not None:
        return replace(found, unseen_ml=model.unseen.unseen_ml)
    return replace(found, most_ml=most_ml)


def with_hidden(context: ImaginationContext, model: CollisionModel, found: Capacity) -> Capacity:
    """Return the capacity with what the hollow holds more if all that no view saw of it is hollow."""
    if model.unseen is None or not found.n_kept:
        return found
    roomy = basin_of(context, model.unseen.roomy, context.parameters.particle.diameter_m)
    return replace(found, hidden_ml=max(roomy.candies_ml - found.filled_ml, 0.0))


_INWARDS, _OUTWARDS, _OUTWARDS_THIN = 1 / 3, 1.0, 1.5
"""Shares of the surface's error by which a hollow comes out too large, or too small, which is likelier."""
_THIN_M = 0.003
"""Walls below 2 mm come out up to this thick, for voxels hold no thinner ones (decision 0057)."""
_RIM_M = 0.002
"""The uppermost layer of a hollow tells how wide its mouth is."""


def between_ml(volume_ml: float, basin: Basin, error_m: float, is_thin: bool) -> tuple[float, float]:
    """Return the least and the most that a level volume may truly be.

    All of the hollow's boundary, its mouth included, lies further in or out by a share of the error.

    Args:
        volume_ml: as told.
        basin: the hollow.
        error_m: how far the surface may lie from the true one.
        is_thin: whether its walls are about as thin as a scan can tell.
    """
    if not len(basin.volumes_ml):
        return volume_ml, volume_ml
    top_m = float(basin.heights_m[-1])
    below_ml = float(np.interp(top_m - _RIM_M, basin.heights_m, basin.volumes_ml))
    mouth_m2 = (basin.candies_ml - below_ml) / ML / min(_RIM_M, top_m - float(basin.heights_m[0]))
    shift_ml = (mouth_m2 + basin.around.floor_m2 + basin.around.side_m2) * error_m * ML
    outwards = _OUTWARDS_THIN if is_thin else _OUTWARDS
    return float(max(volume_ml - _INWARDS * shift_ml, 0.0)), float(volume_ml + outwards * shift_ml)


def imagine_filling(context: ImaginationContext, model: CollisionModel, drop: Drop) -> Capacity:
    """Return what stays in an object, without what a scan leaves open and which candies are too small."""
    basin = basin_of(context, model.surface, context.parameters.particle.diameter_m)
    return _told(context, model, fill(context, model, drop, basin))


def enclosed_share(surface: TriangleMesh, found: Capacity) -> float:
    """Return what stays as a share of the convex hull's volume; zero if not one candy lies below a rim.

    Friction alone holds a heap where nothing is closed all around (decision 0059).
    """
    return hull_share(surface, found.bulk_ml) if found.candy_hollow_ml > 0 else 0.0


def _told(context: ImaginationContext, model: CollisionModel, filled: Filled) -> Capacity:
    plan = filled.plan
    found = _result(plan, plan.basin, filled.fillings, model.surface, context.parameters)
    return replace(found, explanation=ARCH) if filled.is_below_arch else found


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
    # Candies that lie against the rim reach above it: no more than the hollow is level.
    volume = min(volume, basin.candies_ml)
    bulk = bulk_of_ml(plan, fillings, basin) if fillings else 0.0
    is_container = hull_share(surface, bulk) > parameters.containability.capacity_threshold
    is_hollow_told = plan.stand_in.scale > 1 and is_container
    told = basin.candies_ml if is_hollow_told else volume
    facts = _facts(plan, basin, fillings, told, bulk - volume, surface, parameters)
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
        stand_in_diameter_m=plan.stand_in.particle.diameter_m if plan.stand_in.scale > 1 else None,
        is_hollow_told=is_hollow_told,
        hollows=basin.hollow_map,
    )


def hull_share(surface: TriangleMesh, volume_ml: float) -> float:
    """Return a volume as a share of that of a surface's convex hull; zero without one."""
    hull_ml = ML * hull_volume_m3(surface)
    return float(volume_ml / hull_ml) if hull_ml > 0 else 0.0


def _facts(
    plan: FillPlan,
    basin: Basin,
    fillings: tuple[Filling, ...],
    filled_ml: float,
    heaped_ml: float,
    surface: TriangleMesh,
    parameters: Parameters,
) -> Facts:
    per_particle = bulk_ml(plan.stand_in.particle, basin.around)
    n = max(len(fillings), 1)
    lost = sum(filling.n_poured - filling.n_kept for filling in fillings)
    foot_m = float(surface.aabb_min_m[2])
    return Facts(
        filled_ml=filled_ml,
        heaped_ml=heaped_ml,
        has_stand_ins=plan.stand_in.scale > 1,
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


AGREE_SHARE = 0.15
"""Volumes that differ by less need no explanation."""
_COUNTS = 0.25
"""A reason is named when it accounts for at least this share of the difference."""
_NARROW_MOUTH = 2.0


@dataclass(frozen=True)
class Facts:
    """What is known of a filling, volumes in ml, lengths in m.

    Attributes:
        filled_ml: what is told to be filled level.
        heaped_ml: bulk volume of the candies above the rim.
        has_stand_ins: whether larger balls were filled in place of candies.
        water_ml: geometric volume.
        hollow_ml: geometric volume for what is as thick as a candy.
        narrow_ml: water where no candy goes.
        shaken_off_ml: bulk volume of what the perturbations took from below the rim.
        left_below: share of the candies lost that left lower than the rim.
        water_level_m: above the object's lowest point, where water runs out of the largest hollow; NaN.
        rim_m: the same for candies; NaN.
        mouth_m: width of the mouth.
        candy_m: diameter of a candy.
    """

    filled_ml: float
    heaped_ml: float
    has_stand_ins: bool
    water_ml: float
    hollow_ml: float
    narrow_ml: float
    shaken_off_ml: float
    left_below: float
    water_level_m: float
    rim_m: float
    mouth_m: float
    candy_m: float


def explain(facts: Facts) -> str:
    """Return sentences on the difference; empty when the volumes agree and hardly anything is heaped."""
    heap = ""
    if not facts.has_stand_ins and facts.heaped_ml > AGREE_SHARE * max(facts.filled_ml, facts.water_ml):
        where = "where nothing is closed all around" if np.isnan(facts.rim_m) else "above the rim"
        heap = f"Candies for {facts.heaped_ml:.0f} ml lie heaped {where}."
    return " ".join(sentence for sentence in (_difference(facts), heap) if sentence)


def _difference(facts: Facts) -> str:
    more = facts.filled_ml - facts.water_ml
    if abs(more) <= AGREE_SHARE * max(facts.filled_ml, facts.water_ml):
        return ""
    reasons = _of_more(facts, more) if more > 0 else _of_less(facts, -more)
    said = f"The candies stand for {facts.filled_ml:.0f} ml, water would be {facts.water_ml:.0f} ml: "
    return said + ("; ".join(reasons) or "neither gaps nor the shaking account for it") + "."


def _of_more(facts: Facts, more: float) -> list[str]:
    reasons = []
    if facts.hollow_ml - facts.water_ml >= _COUNTS * more:
        reasons.append(_gap(facts))
    return reasons


def _gap(facts: Facts) -> str:
    where = "at the bottom"
    if not np.isnan(facts.water_level_m):
        where = f"{1000 * facts.water_level_m:.0f} mm above the foot"
    return (
        f"water runs out {where} through a gap that candies do not pass (in a thin wall it may come from the "
        f"scan), where candies are held up to {1000 * facts.rim_m:.0f} mm"
    )


def _of_less(facts: Facts, less: float) -> list[str]:
    if facts.filled_ml == 0:
        return [
            "none of the candies that stay lies where water would"
            if facts.heaped_ml > 0
            else "no candy stays"
        ]
    reasons = []
    if facts.narrow_ml >= _COUNTS * less:
        reasons.append(f"{facts.narrow_ml:.0f} ml of water stand in hollows too narrow for a candy")
    if facts.shaken_off_ml >= _COUNTS * less:
        reasons.append(f"tilting and pushing take off candies for {facts.shaken_off_ml:.0f} ml")
    if facts.left_below >= _COUNTS:
        reasons.append(f"{100 * facts.left_below:.0f} % of the candies lost left lower than the rim")
    if 0 < facts.mouth_m < _NARROW_MOUTH * facts.candy_m:
        reasons.append(f"the mouth is {1000 * facts.mouth_m:.0f} mm wide, less than two candies")
    return reasons
