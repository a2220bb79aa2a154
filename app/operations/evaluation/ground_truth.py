"""The chosen pour in the ground-truth simulation: the cup, and the true object (Sec. IV-D)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle, islice

import numpy as np

from app.operations.evaluation.placed_object import PlacedObject
from core.geometry import FloatArray
from core.imagination.cup import pour_angle, pour_duration_s
from core.imagination.results import PourChoice
from core.motion.pour.cell import PourCell
from core.motion.pour.geometry import outer_cone, rotated_cups, upright_rad
from core.motion.pour.plan import PourTarget, Segment
from core.motion.pour.planning import plan_pour
from core.motion.trajectory import JointTrajectory
from core.parameters.bodies import CupParameters
from core.parameters.imagination import PouringParameters
from core.progress import Reporter
from core.workers import TaskRunner
from hardware.simulation.pour_outcome.candies import NO_CANDIES, Candies
from hardware.simulation.pour_outcome.driven_path import DrivenPath, driven_path
from hardware.simulation.pour_outcome.outcome import TableOutcome, simulate_outcome
from hardware.simulation.pour_outcome.settings import OutcomeSettings

_DRIVEN = (Segment.TILT, Segment.LOWER, Segment.POUR)
_OVER_M = 0.03
"""While it is tilted, the cup's lowest point is this far above the pour: as far as an arm's at least is."""
_TILT_S, _LOWER_S = 2.0, 0.6
_SAMPLE_S = 0.02
_POURS_PER_SEED = 1000


def pour_into(
    placed: PlacedObject,
    path: DrivenPath,
    pouring: PouringParameters,
    worlds: Sequence[OutcomeSettings],
    n_pours: int,
    runner: TaskRunner,
    reporter: Reporter,
) -> list[TableOutcome]:
    """Pour several times, into one world after the other, with other candies and other errors each time.

    Args:
        placed: the true object.
        path: the cup's.
        pouring: N_pour and the cup.
        worlds: their settings; the seed and the number of the pour make each pour's seed.
        n_pours: how often in all.
        runner: where to compute.
        reporter: receives the progress.

    Raises:
        InputError: the cup cannot hold the candies.
    """
    return [
        pour_once(placed, path, pouring, world, pour, runner, reporter)
        for pour, world in enumerate(islice(cycle(worlds), n_pours))
    ]


def pour_once(
    placed: PlacedObject,
    path: DrivenPath,
    pouring: PouringParameters,
    outcome: OutcomeSettings,
    pour: int,
    runner: TaskRunner,
    reporter: Reporter,
    lying: Candies = NO_CANDIES,
) -> TableOutcome:
    """Pour once along a path; `pour` is its number among those of one seed.

    Raises:
        InputError: the cup cannot hold the candies.
    """
    own = {"seed": outcome.seed * _POURS_PER_SEED + pour, "n_candies": pouring.n_pour}
    return simulate_outcome(
        placed.true,
        path,
        pouring.cup,
        placed.place.table_height_m,
        placed.platform,
        outcome.model_copy(update=own),
        runner,
        reporter,
        lying,
    )


def planned_path(
    cell: PourCell, aabb_m: FloatArray, choice: PourChoice, pouring: PouringParameters
) -> DrivenPath:
    """The cup's path as the arm is planned to drive it, from upright over the object to the pour's end.

    Carrying the cup there, upright and slowly, spills nothing and is left out.

    Raises:
        MotionError: the arm cannot make this pour.
    """
    target = PourTarget(aabb_m, choice.i, choice.j, choice.theta_rad, choice.pivot_m, pouring)
    plan = plan_pour(cell, target, np.array(cell.home_rad))
    driven = JointTrajectory.joined([move.trajectory for move in plan.moves if move.name in _DRIVEN])
    T_flange_cup = cell.T_flange_grasp @ plan.T_grasp_cup
    return driven_path(cell.arm, driven.times_s, driven.joints_rad, T_flange_cup)


def ideal_path(pouring: PouringParameters, pivot_m: FloatArray, theta_rad: float) -> DrivenPath:
    """The cup's path with an arm without limits: tilted as low as it can be, lowered, rotated as imagined.

    An arm's own path ends in the same rotation, never faster (`core.motion.pour.geometry.imagined_rate`).
    """
    lowered = 1 - _smooth(_LOWER_S)
    times = np.arange(0, pour_duration_s(pouring) + _SAMPLE_S, _SAMPLE_S)
    rotating = np.array([pour_angle(pouring, time)[0] for time in times])
    upright_to_ready = upright_rad(pouring.cup) * (1 - _smooth(_TILT_S))
    tilting = rotated_cups(pouring.cup, pivot_m, theta_rad, upright_to_ready)
    tilting[:, 2, 3] += _OVER_M + pivot_m[2] - _lowest_m(pouring.cup, tilting)
    pouring_poses = rotated_cups(
        pouring.cup, pivot_m, theta_rad, np.concatenate([np.zeros(len(lowered)), rotating])
    )
    above_m = tilting[-1, 2, 3] - pouring_poses[0, 2, 3]
    pouring_poses[: len(lowered), 2, 3] += above_m * lowered
    poses = np.concatenate([tilting, pouring_poses])
    return DrivenPath(_SAMPLE_S * np.arange(len(poses), dtype=float), poses)


def _lowest_m(cup: CupParameters, T_base_cup: FloatArray) -> FloatArray:
    """Height (N,) of the cup's lowest point, outside, at poses (N, 4, 4)."""
    cone = outer_cone(cup)
    upward = T_base_cup[:, 2, 2]
    across = np.sqrt(np.clip(1 - upward**2, 0, 1))
    base = T_base_cup[:, 2, 3] - cone.low_radius_m * across
    mouth = T_base_cup[:, 2, 3] + cone.height_m * upward - cone.high_radius_m * across
    lowest: FloatArray = np.minimum(base, mouth)
    return lowest


def _smooth(duration_s: float) -> FloatArray:
    """From 0 to 1 with the least jerk, without the last sample, with which the next part begins."""
    share = np.arange(0, duration_s, _SAMPLE_S) / duration_s
    smooth: FloatArray = share**3 * (10 - 15 * share + 6 * share**2)
    return smooth
