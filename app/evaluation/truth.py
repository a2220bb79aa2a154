"""The chosen pour in the truth world: the cup driven over the true object (Sec. IV-D, without an arm)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.evaluation.standing import StandingObject
from core.geometry import FloatArray
from core.imagination.cup import pour_angle, pour_duration_s
from core.imagination.results import PourChoice
from core.motion.pour.geometry import turned_cups, upright_rad
from core.parameters.imagination import PouringParameters
from core.progress import Reporter
from core.workers import TaskRunner
from hardware.simulation.pour_outcome.driven_path import DrivenPath
from hardware.simulation.pour_outcome.lying import NONE_LYING, LyingCandies
from hardware.simulation.pour_outcome.outcome import TableOutcome, simulate_outcome
from hardware.simulation.pour_outcome.settings import OutcomeSettings

_LAID_ABOVE_M = 0.25
"""The cup is laid this far above the pour, where neither it nor a candy can touch the object."""
_LAY_S, _LOWER_S = 2.0, 1.5
_SAMPLE_S = 0.02
_POURS_PER_SEED = 1000
_CUPS_APART = 1000
"""Between the seeds of two cups: more than there are seeds in an evaluation."""


def pour_into(
    standing: StandingObject,
    choice: PourChoice,
    pouring: PouringParameters,
    outcome: OutcomeSettings,
    n_pours: int,
    runner: TaskRunner,
    reporter: Reporter,
) -> list[TableOutcome]:
    """Pour several times, with other candies and other errors each time.

    Args:
        standing: the true object.
        choice: the pour.
        pouring: N_pour, the cup and how it is turned.
        outcome: the truth world's settings; its seed and the number of the pour make each pour's seed.
        n_pours: how often.
        runner: where to compute.
        reporter: receives the progress.

    Raises:
        InputError: the cup cannot hold the candies.
    """
    return [
        pour_once(standing, choice.pivot_m, choice.theta_rad, pouring, outcome, pour, runner, reporter)
        for pour in range(n_pours)
    ]


def pour_cups(
    standing: StandingObject,
    choice: PourChoice,
    pouring: PouringParameters,
    n_per_cup: Sequence[int],
    outcome: OutcomeSettings,
    pour: int,
    runner: TaskRunner,
    reporter: Reporter,
) -> list[TableOutcome]:
    """Pour several cups, one after the other, into the same object; what lies in it stays there.

    Raises:
        InputError: the cup cannot hold the candies.
    """
    poured: list[TableOutcome] = []
    for n_candies in n_per_cup:
        lying = poured[-1].lying if poured else NONE_LYING
        # Every cup has a packing and errors of its own.
        own = {"seed": outcome.seed + len(poured) * _CUPS_APART}
        poured.append(
            pour_once(
                standing,
                choice.pivot_m,
                choice.theta_rad,
                pouring.model_copy(update={"n_pour": n_candies}),
                outcome.model_copy(update=own),
                pour,
                runner,
                reporter,
                lying,
            )
        )
    return poured


def pour_once(
    standing: StandingObject,
    pivot_m: FloatArray,
    theta_rad: float,
    pouring: PouringParameters,
    outcome: OutcomeSettings,
    pour: int,
    runner: TaskRunner,
    reporter: Reporter,
    lying: LyingCandies = NONE_LYING,
) -> TableOutcome:
    """Pour once at a pivot (3,) from a direction; `pour` tells one pour of the same seed from another.

    Raises:
        InputError: the cup cannot hold the candies.
    """
    own = {"seed": outcome.seed * _POURS_PER_SEED + pour, "n_candies": pouring.n_pour}
    return simulate_outcome(
        standing.true,
        ideal_path(pouring, pivot_m, theta_rad),
        pouring.cup,
        standing.place.table_height_m,
        standing.platform,
        outcome.model_copy(update=own),
        runner,
        reporter,
        lying,
    )


def ideal_path(pouring: PouringParameters, pivot_m: FloatArray, theta_rad: float) -> DrivenPath:
    """The cup's way as an arm without limits would drive it: laid in the air, lowered, turned as imagined.

    An arm's own way ends in the same turn, never faster (`core.motion.pour.turning`).
    """
    laying, lowering = _smooth(_LAY_S), _smooth(_LOWER_S)
    times = np.arange(0, pour_duration_s(pouring) + _SAMPLE_S, _SAMPLE_S)
    turning = np.array([pour_angle(pouring, time)[0] for time in times])
    gamma = np.concatenate([upright_rad(pouring.cup) * (1 - laying), np.zeros(len(lowering)), turning])
    height = _LAID_ABOVE_M * np.concatenate([np.ones(len(laying)), 1 - lowering, np.zeros(len(turning))])
    poses = turned_cups(pouring.cup, pivot_m, theta_rad, gamma)
    poses[:, 2, 3] += height
    return DrivenPath(_SAMPLE_S * np.arange(len(gamma), dtype=float), poses)


def _smooth(duration_s: float) -> FloatArray:
    """From 0 to 1 with the least jerk, without the last sample, with which the next part begins."""
    share = np.arange(0, duration_s, _SAMPLE_S) / duration_s
    smooth: FloatArray = share**3 * (10 - 15 * share + 6 * share**2)
    return smooth
