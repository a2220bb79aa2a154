"""What is prepared once before anything is fitted: the bodies of all cases, and what was poured into."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from app.evaluation.standing import Input, known_surface, mesh_of_content, stand
from core.collision import CollisionModel, build_collision_model
from core.errors import Cancelled, InputError, PoursightError
from core.evaluation.fitting.containability import FitCase
from core.evaluation.fitting.pours import PourTarget
from core.evaluation.labels import LabelledObject
from core.imagination.imagine import imagine_containability
from core.parameters import Parameters
from core.progress import Reporter
from core.workers import Task, TaskRunner, WorkerReporter

STAGE, POURED_STAGE = "preparing", "preparing pours"


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
    """Find the footprints of objects that are poured into as their meshes stand; by their names.

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
        surface = known_surface(mesh, stand(mesh, source, parameters.seed), source, parameters, reporter)
        return build_collision_model(surface, parameters.collision, reporter)
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
        found = imagine_containability(model, parameters)
    except Cancelled:
        raise
    except PoursightError as error:
        return str(error)
    if found.footprint is None:
        return "no candy stays in it, so there is no footprint to pour at."
    return PourTarget(model, found.footprint)
