"""Spills measured in the truth world, where no table is at hand: each pour is driven and counted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from app.evaluation.standing import mesh_of_content, stand
from app.evaluation.truth import pour_once
from core.errors import InputError
from core.evaluation.fitting.pours import PourTarget
from core.evaluation.fitting.spills import SpillMeasurement
from core.evaluation.labels import LabelledObject
from core.imagination.pouring import indentations_m, pivots_m, pour_directions_rad
from core.parameters import Parameters
from core.progress import Reporter
from core.workers import RunHere, Task, TaskRunner, WorkerReporter
from hardware.simulation.pour_outcome.settings import OutcomeSettings

STAGE = "measuring spills"


def measure_spills(
    objects: Sequence[LabelledObject],
    targets: Mapping[str, PourTarget],
    parameters: Parameters,
    outcome: OutcomeSettings,
    runner: TaskRunner,
    reporter: Reporter,
) -> tuple[SpillMeasurement, ...]:
    """Pour into each object from all directions at all distances, once, and count what is spilled.

    Args:
        objects: to pour into, as their meshes stand.
        targets: the same with their footprints.
        parameters: of the pours: which ones there are, the cup, N_pour, the seed.
        outcome: settings of the truth world but for the seed and the number of candies.
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
        Task(
            _spilled,
            (_content(one), one.mesh.suffix, pivot, theta, parameters, seeded, k),
        )
        for k, (one, pivot, theta, _) in enumerate(pours)
    ]
    counts: list[int] = runner.run(tasks, STAGE, reporter)
    return tuple(
        SpillMeasurement(one.name, theta, indent, count, parameters.pouring.n_pour)
        for (one, _, theta, indent), count in zip(pours, counts, strict=True)
    )


def _pours(
    target: PourTarget, parameters: Parameters
) -> list[tuple[tuple[float, float, float], float, float]]:
    """Pivot, direction and distance of each pour (Sec. III-B)."""
    margin = parameters.collision.aabb_margin_m
    aabb = np.array([target.model.aabb_min_m - margin, target.model.aabb_max_m + margin])
    thetas = pour_directions_rad(target.footprint, parameters.pouring)
    indents = indentations_m(aabb, parameters.pouring)
    pivots = pivots_m(target.footprint, thetas, indents)
    return [
        (tuple(pivots[i, j].tolist()), float(theta), float(indent))
        for i, theta in enumerate(thetas)
        for j, indent in enumerate(indents)
    ]


def _content(one: LabelledObject) -> bytes:
    try:
        return one.mesh.read_bytes()
    except OSError as error:
        raise InputError(f"The mesh {one.mesh} cannot be read ({error.strerror}); mend its name.") from error


def _spilled(
    content: bytes,
    ending: str,
    pivot_m: tuple[float, float, float],
    theta_rad: float,
    parameters: Parameters,
    outcome: OutcomeSettings,
    pour: int,
) -> int:
    """Pour once and return the candies spilled; in a worker."""
    standing = stand(mesh_of_content(content, ending), "mesh", parameters.seed)
    found = pour_once(
        standing, np.array(pivot_m), theta_rad, parameters.pouring, outcome, pour, RunHere(), WorkerReporter()
    )
    return found.n_spilled
