"""The hollows of a surface, found by workers: when asked for, beside other tasks, or ahead of both."""

from __future__ import annotations

from functools import partial

from core.collision import CollisionModel
from core.imagination.capacity.basin import ML, Basin
from core.imagination.capacity.stand_in import stand_in_for
from core.imagination.context import ImaginationContext
from core.imagination.hollow_map import HollowMap
from core.imagination.particle_shape import particle_extents_m, particle_volume_m3
from core.mesh import TriangleMesh
from core.parameters import Parameters
from core.workers import Task

STAGE = "capacity"
HOLLOWS_STAGE = "hollows"
"""Another word: what only ends pours earlier is no filling."""
HALF = 0.5
"""Candies half as large are asked about; a scan has gaps of its own that smaller ones would pass.

It is asked of the surface before it was simplified, where that is at hand: pinholes grow with fewer faces.
"""
_SMALLEST_CANDIES = 1.0
"""A hollow counts when its bulk holds so many."""
_USUAL_FRACTION = 0.6
_THINNER = 0.9
"""What cannot leave is asked of something thinner than a candy: drawn ones are up to 5 % smaller."""
_COARSE_POINTS = 200_000
"""0.06 s; of the hollows that a million points find, the volume is the same within 1.5 %."""

Question = tuple[float, float, int]
"""Of a surface: thickness of what it shall hold (m), least volume that counts (ml), points of the lattice."""


def basin_of(context: ImaginationContext, surface: TriangleMesh, thickness_m: float) -> Basin:
    """Return what a surface holds of something so thick (m)."""
    question = _question(thickness_m, context.parameters)
    made: Basin | None = context.ahead.of(surface, question)
    return context.run([_task(surface, question)], STAGE)[0] if made is None else made


def find_beside(context: ImaginationContext, surface: TriangleMesh, thickness_m: float) -> None:
    """Let the same be found beside the next tasks, unless it is known."""
    question = _question(thickness_m, context.parameters)
    if context.ahead.of(surface, question) is None:
        context.spare.append((_task(surface, question), partial(context.ahead.keep, surface, question)))


def hollows_of_body(context: ImaginationContext, model: CollisionModel) -> HollowMap | None:
    """Return where a body keeps candies that nothing moves, whichever way they lie; none if it is not known.

    Asked of the surface that the physics has, on a lattice that costs less than what it saves. Not known of
    convex parts, which are another surface, and not asked where steps are never cut: the released code's
    physics stays as it was.
    """
    parameters = context.parameters
    if model.is_convex or parameters.solver.substeps == 1:
        return None
    thickness_m = _THINNER * float(particle_extents_m(parameters.particle).min())
    question = thickness_m, _SMALLEST_CANDIES * usual_bulk_ml(parameters), _COARSE_POINTS
    made: Basin | None = context.ahead.of(model.surface, question)
    if made is None:
        made = context.run([_task(model.surface, question)], HOLLOWS_STAGE)[0]
        context.ahead.keep(model.surface, question, made)
    return made.hollow_map


def find_ahead(context: ImaginationContext, model: CollisionModel) -> None:
    """Let idle processors find what the capacity of an object needs, whatever stays of a drop."""
    parameters, ahead, unseen = context.parameters, context.ahead, model.unseen
    to_be_filled, wanted = [model.surface], [(model.most_detailed, HALF)]
    if unseen is not None:
        wanted.append((unseen.roomy, 1.0))
        if unseen.leaky is not None:
            to_be_filled.append(unseen.leaky)

    def keep(surface: TriangleMesh, found: list[tuple[Question, Basin]]) -> None:
        for question, basin in found:
            ahead.keep(surface, question, basin)

    for surface in to_be_filled:
        context.spare.append((Task(_find_for_filling, (surface, parameters)), partial(keep, surface)))
    for surface, scale in wanted:
        question = _question(scale * parameters.particle.diameter_m, parameters)
        context.spare.append((_task(surface, question), partial(ahead.keep, surface, question)))


def usual_bulk_ml(parameters: Parameters) -> float:
    """What a candy takes up in a container of usual size."""
    return particle_volume_m3(parameters.particle) * ML / _USUAL_FRACTION


def _question(thickness_m: float, parameters: Parameters) -> Question:
    smallest_ml = _SMALLEST_CANDIES * usual_bulk_ml(parameters)
    return thickness_m, smallest_ml, parameters.capacity.lattice_points


def _task(surface: TriangleMesh, question: Question) -> Task:
    return Task(_find, (surface, question))


def _find_for_filling(surface: TriangleMesh, parameters: Parameters) -> list[tuple[Question, Basin]]:
    """Find the hollow for candies, and that for the balls that stand for them if they are too many."""
    for_candies = _question(parameters.particle.diameter_m, parameters)
    basin = _find(surface, for_candies)
    stand_in = stand_in_for(basin.candies_ml / usual_bulk_ml(parameters), basin.mouth_m, parameters)
    if stand_in.scale == 1:
        return [(for_candies, basin)]
    for_balls = _question(stand_in.particle.diameter_m, parameters)
    return [(for_candies, basin), (for_balls, _find(surface, for_balls))]


def _find(surface: TriangleMesh, question: Question) -> Basin:
    from core.imagination.capacity.water import find_basin  # loads numba: in the worker alone

    return find_basin(surface, *question)
