"""What is prepared before a fit: the bodies of all cases, what was poured into, measured spills."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from app.operations.evaluation.ground_truth import ideal_path, pour_once
from app.operations.evaluation.placed_object import Input, known_surface, mesh_of_content, place_object
from core.collision import CollisionModel, build_collision_model
from core.errors import Cancelled, InputError, PoursightError
from core.evaluation.fitting.containability import FitCase
from core.evaluation.fitting.pours import PourTarget
from core.evaluation.fitting.spills import SpillMeasurement
from core.evaluation.labels import LabelledObject
from core.imagination.context import ImaginationContext
from core.imagination.drop import imagine_drop
from core.imagination.pours import indentations_m, pivots_m, pour_directions_rad
from core.parameters import Parameters
from core.progress import Reporter
from core.workers import RunHere, Task, TaskRunner, WorkerReporter
from hardware.simulation.pour_outcome.settings import OutcomeSettings

STAGE, POURED_STAGE, SPILLS_STAGE = "preparing", "preparing pours", "measuring spills"


@dataclass(frozen=True)
class PreparedCases:
    """What can be fitted to.

    Attributes:
        cases: in the order of the objects, then of the seeds.
        left_out: why a case could not be prepared, by the object's name and seed.
    """

    cases: tuple[FitCase, ...]
    left_out: Mapping[str, str]


def prepare_cases(
    objects: Sequence[LabelledObject],
    source: Input,
    seeds: Sequence[int],
    parameters: Parameters,
    runner: TaskRunner,
    reporter: Reporter,
) -> PreparedCases:
    """Scan all objects with each seed, or read their meshes, and build their bodies.

    What cannot be prepared is warned of and left out.

    Raises:
        Cancelled: somebody asked to stop.
        WorkerError: a worker died.
    """
    # A mesh is the same with every seed: its body is built once.
    built_for = list(seeds) if source == "scan" else [seeds[0]]
    wanted = [(one, seed) for one in objects for seed in built_for]
    tasks = [
        Task(_build, (_content(one), one.mesh.suffix, source, parameters.model_copy(update={"seed": seed})))
        for one, seed in wanted
    ]
    found: list[CollisionModel | str] = runner.run(tasks, STAGE, reporter)
    cases: list[FitCase] = []
    left_out: dict[str, str] = {}
    for (one, seed), model in zip(wanted, found, strict=True):
        if isinstance(model, str):
            name = f"{one.name}, seed {seed}" if source == "scan" else one.name
            left_out[name] = model
            reporter.warn(f"{name} is left out: {model}")
            continue
        own = [seed] if source == "scan" else seeds
        cases += [FitCase(one.name, one.label == "container", each, model) for each in own]
    return PreparedCases(tuple(cases), left_out)


def prepare_targets(
    objects: Sequence[LabelledObject], parameters: Parameters, runner: TaskRunner, reporter: Reporter
) -> dict[str, PourTarget]:
    """Find the footprints of objects that are poured into, upright as their meshes are; by their names.

    Raises:
        InputError: an object cannot be used, or keeps no candy.
        Cancelled: somebody asked to stop.
        WorkerError: a worker died.
    """
    tasks = [Task(_target, (_content(one), one.mesh.suffix, parameters)) for one in objects]
    found: list[PourTarget | str] = runner.run(tasks, POURED_STAGE, reporter)
    targets = {}
    for one, target in zip(objects, found, strict=True):
        if isinstance(target, str):
            raise InputError(f"Pours into '{one.name}' cannot be imagined: {target}")
        targets[one.name] = target
    return targets


def measure_spills(
    objects: Sequence[LabelledObject],
    targets: Mapping[str, PourTarget],
    parameters: Parameters,
    outcome: OutcomeSettings,
    runner: TaskRunner,
    reporter: Reporter,
) -> tuple[SpillMeasurement, ...]:
    """Pour into each object from all directions at all distances, once, in the ground-truth simulation.

    Args:
        objects: to pour into, upright as their meshes are.
        targets: the same with their footprints.
        parameters: of the pours: which ones there are, the cup, N_pour, the seed.
        outcome: settings of the ground-truth simulation but for the seed and the number of candies.
        runner: where to compute, each pour by itself.
        reporter: receives the progress.

    Raises:
        InputError: a mesh cannot be read, or the cup cannot hold the candies.
        Cancelled: somebody asked to stop.
        WorkerError: a worker died.
    """
    seeded = outcome.model_copy(update={"seed": parameters.seed})
    pours = [(one, *pour) for one in objects for pour in _pours(targets[one.name], parameters)]
    tasks = [
        Task(_spilled, (_content(one), one.mesh.suffix, pivot, theta, parameters, seeded, k))
        for k, (one, pivot, theta, _) in enumerate(pours)
    ]
    counts: list[int] = runner.run(tasks, SPILLS_STAGE, reporter)
    return tuple(
        SpillMeasurement(one.name, theta, indent, count, parameters.pouring.n_pour)
        for (one, _, theta, indent), count in zip(pours, counts, strict=True)
    )


def _content(one: LabelledObject) -> bytes | str:
    """The mesh's file, for a worker; or why it cannot be read."""
    try:
        return one.mesh.read_bytes()
    except OSError as error:
        return f"Its mesh {one.mesh} cannot be read ({error.strerror})."


def _build(content: bytes | str, ending: str, source: Input, parameters: Parameters) -> CollisionModel | str:
    """Return a body, or why there is none; in a worker."""
    if isinstance(content, str):
        return content
    reporter = WorkerReporter()
    try:
        mesh = mesh_of_content(content, ending)
        surface = known_surface(
            mesh, place_object(mesh, source, parameters.seed), source, parameters, reporter
        )
        return build_collision_model(surface.mesh, parameters.collision, reporter)
    except Cancelled:
        raise
    except PoursightError as error:
        return str(error)


def _target(content: bytes | str, ending: str, parameters: Parameters) -> PourTarget | str:
    """Return an object with its footprint, or why there is none; in a worker."""
    model = _build(content, ending, "mesh", parameters)
    if isinstance(model, str):
        return model
    try:
        found = imagine_drop(ImaginationContext(parameters, RunHere(), WorkerReporter()), model)
    except Cancelled:
        raise
    except PoursightError as error:
        return str(error)
    if found.footprint is None:
        return "no candy stays in it, so there is no footprint to pour at."
    return PourTarget(model, found.footprint)


def _pours(
    target: PourTarget, parameters: Parameters
) -> list[tuple[tuple[float, float, float], float, float]]:
    """Pivot, direction and distance of each pour (Sec. III-B)."""
    margin = parameters.collision.aabb_margin_m
    aabb = np.array([target.model.aabb_min_m - margin, target.model.aabb_max_m + margin])
    thetas = pour_directions_rad(target.footprint, parameters.pouring)
    indents = indentations_m(aabb, parameters.pouring)
    pivots = pivots_m(target.footprint.raised(parameters.pouring.pivot_height_m), thetas, indents)
    return [
        (tuple(pivots[i, j].tolist()), float(theta), float(indent))
        for i, theta in enumerate(thetas)
        for j, indent in enumerate(indents)
    ]


def _spilled(
    content: bytes | str,
    ending: str,
    pivot_m: tuple[float, float, float],
    theta_rad: float,
    parameters: Parameters,
    outcome: OutcomeSettings,
    pour: int,
) -> int:
    """Pour once and return the candies spilled; in a worker."""
    if isinstance(content, str):
        raise InputError(content)
    placed = place_object(mesh_of_content(content, ending), "mesh", parameters.seed)
    path = ideal_path(parameters.pouring, np.array(pivot_m), theta_rad)
    return pour_once(placed, path, parameters.pouring, outcome, pour, RunHere(), WorkerReporter()).n_spilled
