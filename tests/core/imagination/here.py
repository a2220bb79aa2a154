"""Imagining in the test's own process."""

from core.imagination.context import ImaginationContext
from core.imagination.object_at_rest import ObjectAtRest
from core.progress import Reporter
from core.workers import RunHere


def here(parameters) -> ImaginationContext:
    return ImaginationContext(parameters, RunHere(), Reporter())


def at_rest(model, body, parameters) -> ObjectAtRest:
    return ObjectAtRest.of(model.surface, body, parameters.collision.aabb_margin_m)
