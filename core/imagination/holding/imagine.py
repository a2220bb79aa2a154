"""Holding strength of one object: the load, then eight tilts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.collision import CollisionModel
from core.geometry import FloatArray, IntArray
from core.imagination.body import body_files
from core.imagination.containability import ObjectAtRest, object_at_rest
from core.imagination.holding.load import load_task
from core.imagination.holding.result import Holding
from core.imagination.holding.tilting import tilt_angles_rad, tilt_task
from core.imagination.results import Containability
from core.parameters import Parameters
from core.parameters.holding import N_TILT_DIRECTIONS, HoldingParameters
from core.progress import Reporter
from core.workers import Task, TaskRunner

STAGE = "holding"


def imagine_holding(
    model: CollisionModel,
    found: Containability,
    parameters: Parameters,
    settings: HoldingParameters,
    runner: TaskRunner,
    reporter: Reporter,
) -> Holding:
    """Tilt an object with candies in it, in 8 directions, until they leave.

    Args:
        model: the object's body.
        found: its containability; with a footprint.
        parameters: of the imagination: seed, candy, contact of the drop and solver.
        settings: of the load and the tilt.
        runner: where to compute.
        reporter: receives the progress.

    Raises:
        ValueError: no candy stayed in the drop.
    """
    directions = tilt_directions_rad(found)
    with body_files(object=(model.parts, not model.is_convex)) as files:
        target = object_at_rest(model, files["object"], parameters)
        load = runner.run([load_task(target, found, parameters, settings)], STAGE, reporter)[0]
        n_left = runner.run(holding_tasks(target, load, directions, parameters, settings), STAGE, reporter)
    return holding_of(load, n_left, directions, settings)


def tilt_directions_rad(found: Containability) -> FloatArray:
    """Return (8,) the sides that sink, against the x-axis: i pi/4 from the footprint's principal axis.

    Raises:
        ValueError: no candy stayed in the drop.
    """
    if found.footprint is None:
        raise ValueError("no candy stayed: there is no footprint to pour onto")
    step = 2 * np.pi / N_TILT_DIRECTIONS
    directions: FloatArray = found.footprint.axis_rad + step * np.arange(N_TILT_DIRECTIONS, dtype=np.float64)
    return directions


def holding_tasks(
    target: ObjectAtRest,
    load: FloatArray,
    directions_rad: FloatArray,
    parameters: Parameters,
    settings: HoldingParameters,
) -> list[Task]:
    """Return one task a direction; they need the load (n, 7) that `load_task` gives."""
    return [tilt_task(target, load, angle, parameters, settings) for angle in directions_rad.tolist()]


def holding_of(
    load: FloatArray, n_left: Sequence[IntArray], directions_rad: FloatArray, settings: HoldingParameters
) -> Holding:
    """Gather the results of `holding_tasks`."""
    return Holding(settings.n_load, len(load), tilt_angles_rad(settings), directions_rad, np.array(n_left))
