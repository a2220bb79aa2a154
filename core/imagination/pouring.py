"""Pouring imagination: 8 directions at 3 distances, each with several packings (Sec. III-B)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.geometry import FloatArray
from core.imagination.body import BodyFile
from core.imagination.containability import ObjectAtRest
from core.imagination.packing import CupRun
from core.imagination.pours import Pour, PourOutcome, full_task, replay_task
from core.imagination.results import Footprint, PourGrid
from core.parameters import Parameters
from core.parameters.imagination import N_INDENT, N_THETA, PouringParameters
from core.progress import Reporter
from core.workers import TaskRunner


def imagine_pours(
    target: ObjectAtRest,
    footprint: Footprint,
    cup: BodyFile,
    cup_runs: Sequence[CupRun],
    parameters: Parameters,
    pool: TaskRunner,
    reporter: Reporter,
) -> PourGrid:
    """Imagine all pours; `cup_runs` holds one run per packing (none are needed in mode `full`)."""
    pouring = parameters.pouring
    thetas = pour_directions_rad(footprint, pouring)
    indents = indentations_m(target.aabb_m, pouring)
    pivots = pivots_m(footprint, thetas, indents)
    tasks = []
    for i, theta in enumerate(thetas):
        for j in range(N_INDENT):
            pour = Pour(pivots[i, j], float(theta))
            for packing in range(pouring.n_packings):
                record = packing == 0
                if pouring.mode == "full":
                    tasks.append(full_task(target, cup, packing, pour, parameters, record))
                else:
                    tasks.append(replay_task(target, cup_runs[packing], pour.T_world_E, parameters, record))
    outcomes: list[PourOutcome] = pool.run(tasks, "pouring", reporter)
    shape = len(thetas), N_INDENT, pouring.n_packings
    n_in = np.array([outcome.n_in for outcome in outcomes], dtype=np.int64).reshape(shape)
    n_spilled = np.array([outcome.n_spilled for outcome in outcomes], dtype=np.int64).reshape(shape)
    recordings = [outcome.recording for outcome in outcomes if outcome.recording is not None]
    rows = tuple(tuple(recordings[i * N_INDENT : (i + 1) * N_INDENT]) for i in range(len(thetas)))
    return PourGrid(pouring.n_pour, n_in, n_spilled, thetas, indents, pivots, rows)


def pour_directions_rad(footprint: Footprint, pouring: PouringParameters) -> FloatArray:
    """theta_pour(i) against the world's x-axis: i pi/4 from the principal axis, or the fixed one."""
    if pouring.theta_fixed_rad is not None:
        return np.array([pouring.theta_fixed_rad])
    thetas: FloatArray = footprint.axis_rad + np.arange(N_THETA) * 2 * np.pi / N_THETA
    return thetas


def indentations_m(aabb_m: FloatArray, pouring: PouringParameters) -> FloatArray:
    """L_idt(j) = L_0 + j Delta L, (3,)."""
    diagonal = np.hypot(*(aabb_m[1] - aabb_m[0])[:2])
    indents: FloatArray = pouring.indent_0_m + np.arange(N_INDENT) * pouring.indent_step_ratio * diagonal
    return indents


def pivots_m(footprint: Footprint, thetas_rad: FloatArray, indents_m: FloatArray) -> FloatArray:
    """r_pivot(i, j), (I, 3, 3): on the ray from p_E, in the plane E (Eq. 3)."""
    rays = np.stack([np.cos(thetas_rad), np.sin(thetas_rad), np.zeros_like(thetas_rad)], axis=-1)
    pivots: FloatArray = footprint.center_m + rays[:, None, :] * indents_m[None, :, None]
    return pivots
