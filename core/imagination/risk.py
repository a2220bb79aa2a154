"""How surely each pour spills nothing: the most promising pours imagined again with errors of the set-up.

Where the next tries are spent: always on the pour that promises most, until one is sure or all are spent. A
pour that spills falls behind and is given up; one that stays clean is tried until its lower bound is reached.
Most objects need the tries of one pour, and a difficult one gets all there are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import hypot, sqrt
from pathlib import Path

import numpy as np

from core.collision import CollisionModel
from core.files import read_json, write_json
from core.geometry import BoolArray, FloatArray, make_pose, rotation_x, rotation_y, rotation_z
from core.imagination.choice import choose_pour, papers_order
from core.imagination.context import ImaginationContext
from core.imagination.packing import CupRuns, cup_holds
from core.imagination.pours import Pour, PourOutcome, replay_task
from core.imagination.results import NOT_TRIED, RISK_FILE, PourChoice, PourGrid, PourRisk, joined
from core.imagination.set_up import SetUp, as_planned
from core.parameters import Parameters
from core.parameters.risk import RiskParameters

STAGE = "risk"
CHOICE_FILE = "choice.json"
_STREAM = 2
"""Of the seed: 0 is the drop's, 1 the packings'."""
_CLOSER, _LEAST_STEP = 0.8, 0.002
"""Too large candies are brought closer to the planned size step by step."""
ROUND = 4
"""Tries at a time: a fixed number, so that the result does not depend on the number of workers."""


@dataclass(frozen=True)
class Tries:
    """What was tried of the pours, and the choice that follows.

    Attributes:
        risk: of the pours; none if no tries were asked for.
        choice: the surest pour, or the paper's if the risk is not known; none without pours.
    """

    risk: PourRisk | None
    choice: PourChoice | None

    def save(self, folder: Path) -> None:
        """Write `choice.json`, and `risk.json` if there were tries."""
        table = None if self.choice is None else self.choice.to_table()
        write_json(folder / CHOICE_FILE, {"choice": table})
        if self.risk is not None:
            self.risk.save(folder)

    @classmethod
    def load(cls, folder: Path) -> Tries:
        """Read what `save` wrote."""
        choice = read_json(folder / CHOICE_FILE)["choice"]
        return cls(
            PourRisk.load(folder) if (folder / RISK_FILE).is_file() else None,
            None if choice is None else PourChoice.from_table(choice),
        )


def try_pours(context: ImaginationContext, model: CollisionModel, grid: PourGrid, runs: CupRuns) -> Tries:
    """Try the most promising pours again with errors, and choose.

    Raises:
        StageError: the cup cannot hold N_pour.
    """
    risk = imagine_risk(context, model, grid, runs)
    return Tries(risk, choose_pour(grid, context.parameters.pouring.cup, risk=risk))


def imagine_risk(
    context: ImaginationContext,
    model: CollisionModel,
    grid: PourGrid,
    runs: CupRuns,
    known: PourRisk | None = None,
    feasible: BoolArray | None = None,
) -> PourRisk | None:
    """Try the most promising pours again with errors; none if the parameters ask for no tries.

    Cup and object are imagined one after the other, whatever `pouring.mode` says.

    Args:
        context: `risk` of its parameters says how often and with which errors.
        model: the object's body.
        grid: its imagined pours.
        runs: of the cup; objects may share them.
        known: earlier tries, to which these are added; none: there were none.
        feasible: (I, 3) which pours the arm can make; none: all of them.

    Raises:
        StageError: the cup cannot hold N_pour.
    """
    parameters, target = context.parameters, context.target(model)
    settings = parameters.risk
    if settings.n_tries == 0:
        return None
    race = Race(known or PourRisk.as_planned(grid), papers_order(grid, feasible), settings)
    center_m = target.aabb_m.mean(axis=0)
    spent = 0
    while (planned := race.next_round()) is not None:
        (i, j), tries = planned
        context.reporter.progress(STAGE, spent, settings.n_tries)
        set_ups = [draw_set_up(parameters, k, center_m) for k in tries]
        pour = Pour(grid.pivot_m[i, j], float(grid.theta_rad[i]))
        tasks = [
            replay_task(target, run, one.seen_from_object(pour.T_world_E), one.parameters(parameters), False)
            for one, run in zip(set_ups, runs.of(context, set_ups), strict=True)
        ]
        outcomes: list[PourOutcome] = context.run(tasks, STAGE)
        race.record((i, j), [outcome.n_spilled for outcome in outcomes])
        spent += len(tries)
    return race.risk


class Race:
    """The state of the tries of all pours; knows no physics.

    Attributes:
        tried: [i][j] spilled candies of each try so far.
    """

    def __init__(self, known: PourRisk, order: Sequence[tuple[int, int]], settings: RiskParameters) -> None:
        """Begin with what is known; the pours in `order` compete, of equals the first is preferred."""
        self._n_pour = known.n_pour
        self._settings = settings
        self._order = {pour: rank for rank, pour in enumerate(order)}
        self._spent = 0
        self.tried: list[list[list[int]]] = [
            [[n for n in pour if n != NOT_TRIED] for pour in row] for row in known.spilled.tolist()
        ]

    @property
    def risk(self) -> PourRisk:
        """What is known by now."""
        return PourRisk(self._n_pour, joined(self.tried))

    def next_round(self) -> tuple[tuple[int, int], range] | None:
        """Return the pour to try next and the numbers of its tries; none if the race is over."""
        if not self._order:
            return None
        risk = self.risk
        i, j = self._most_promising(risk)
        n_tries = min(ROUND, self._settings.n_tries - self._spent)
        if n_tries <= 0 or risk.clean_at_least[i, j] >= self._settings.sure:
            return None
        done = len(self.tried[i][j])
        return (i, j), range(done, done + n_tries)

    def record(self, pour: tuple[int, int], spilled: Sequence[int]) -> None:
        """Take the tries of the last round."""
        self.tried[pour[0]][pour[1]] += list(spilled)
        self._spent += len(spilled)

    def _most_promising(self, risk: PourRisk) -> tuple[int, int]:
        expected, mean = risk.expected_clean, risk.mean_spilled
        return min(self._order, key=lambda pour: (-expected[pour], mean[pour], self._order[pour]))


def draw_set_up(parameters: Parameters, packing: int, center_m: FloatArray) -> SetUp:
    """Draw one set-up; the same for the same seed and packing, whichever pour it is for.

    Candies of which the cup cannot hold N_pour are not drawn: they could not be poured.

    Args:
        parameters: how large the errors are, the seed, the cup and N_pour.
        packing: of the cup; gives the draw its number.
        center_m: (3,) what the object turns about.
    """
    risk = parameters.risk
    generator = np.random.default_rng([parameters.seed, _STREAM, packing])
    shift = np.array([*generator.normal(0, 1, 2), 0.0]) * risk.object_error_m
    turn = rotation_z(float(generator.normal()) * risk.object_error_rad)
    moved = make_pose(turn, shift + center_m - turn @ center_m)
    slip = generator.normal(0, 1, 3) * risk.cup_error_m
    lean = generator.normal(0, 1, 2) * risk.cup_error_rad
    slipped = make_pose(rotation_x(float(lean[0])) @ rotation_y(float(lean[1])), slip)
    scale = 1 + risk.candy_spread * float(generator.uniform(-1, 1))
    drawn = replace(as_planned(packing), candy_scale=scale, T_base_moved=moved, T_E_slipped=slipped)
    while drawn.candy_scale > 1 and not cup_holds(drawn.parameters(parameters)):
        drawn = replace(drawn, candy_scale=1 + _CLOSER * (drawn.candy_scale - 1) - _LEAST_STEP)
    return drawn


def with_scan_error(parameters: Parameters, pose_sd_m: float | None, n_views: int) -> Parameters:
    """Return the parameters with the risk's object error raised by what a scan's poses leave open.

    The surface is the mean of what the views say, so that their errors, taken as independent, fall with the
    square root of their number. An error that all views share is in `risk.object_error_m`.

    Args:
        parameters: of the imagination.
        pose_sd_m: SD of a view's position along an axis, as the table tells it; none if it is not known.
        n_views: of the scan.
    """
    if pose_sd_m is None or n_views == 0:
        return parameters
    error_m = hypot(parameters.risk.object_error_m, pose_sd_m / sqrt(n_views))
    return parameters.model_copy(
        update={"risk": parameters.risk.model_copy(update={"object_error_m": error_m})}
    )
