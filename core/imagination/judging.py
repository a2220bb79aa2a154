"""What an object holds and how firmly, and the verdict from it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from core.collision import CollisionModel
from core.imagination.body import body_files
from core.imagination.capacity.basin import ML
from core.imagination.capacity.imagine import imagine_capacity
from core.imagination.capacity.result import Capacity
from core.imagination.containability import object_at_rest
from core.imagination.holding.imagine import imagine_holding
from core.imagination.holding.result import Holding
from core.imagination.results import Containability
from core.imagination.verdict import Verdict
from core.mesh import TriangleMesh
from core.mesh_topology import hull_volume_m3
from core.parameters import Parameters
from core.progress import Reporter
from core.workers import TaskRunner


@dataclass(frozen=True)
class Judged:
    """An object after the drop.

    Attributes:
        containability: the drop, with the verdict.
        capacity: none if Omega decides, or nothing stayed in the drop.
        holding: the same.
    """

    containability: Containability
    capacity: Capacity | None = None
    holding: Holding | None = None


def judge(
    model: CollisionModel,
    found: Containability,
    parameters: Parameters,
    runner: TaskRunner,
    reporter: Reporter,
) -> Judged:
    """Find what an object holds and how firmly, if that decides and any candy stayed in the drop.

    Args:
        model: the object's body.
        found: its containability.
        parameters: of the imagination.
        runner: where to compute.
        reporter: receives the progress.
    """
    settings = parameters.containability
    if settings.verdict == "omega":
        return Judged(found)
    if found.footprint is None:
        nothing = Verdict(0.0, settings.capacity_threshold, 0.0, 0.0, 0, 0.0)
        return Judged(replace(found, verdict=nothing))
    capacity = _capacity(model, found, parameters, runner, reporter)
    holding = imagine_holding(model, found, parameters, parameters.holding, runner, reporter)
    verdict = Verdict(
        _share(model.surface, capacity),
        settings.capacity_threshold,
        capacity.n_candies,
        float(capacity.bulk_ml),
        holding.n_load,
        holding.holds_rad,
    )
    return Judged(replace(found, verdict=verdict), capacity, holding)


def capacity_share(
    model: CollisionModel,
    found: Containability,
    parameters: Parameters,
    runner: TaskRunner,
    reporter: Reporter,
) -> float:
    """Return the `capacity_share` of the verdict that `judge` reaches, without how firmly the object holds.

    Args:
        model: the object's body.
        found: its containability; of an object in which nothing stayed the share is zero.
        parameters: of the imagination.
        runner: where to compute.
        reporter: receives the progress.
    """
    if found.footprint is None:
        return 0.0
    return _share(model.surface, _capacity(model, found, parameters, runner, reporter))


def _capacity(
    model: CollisionModel,
    found: Containability,
    parameters: Parameters,
    runner: TaskRunner,
    reporter: Reporter,
) -> Capacity:
    with body_files(object=(model.parts, not model.is_convex)) as files:
        target = object_at_rest(model, files["object"], parameters)
        return imagine_capacity(
            model.surface, target, found, parameters, parameters.capacity, runner, reporter
        )


def _share(surface: TriangleMesh, capacity: Capacity) -> float:
    hull_ml = ML * hull_volume_m3(surface)
    return float(capacity.bulk_ml) / hull_ml if hull_ml > 0 else 0.0
