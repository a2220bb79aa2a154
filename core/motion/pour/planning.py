"""Which of the imagined pours this arm can make, and the plan for one of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.errors import MotionError
from core.geometry import FloatArray
from core.motion.pour.building import build_moves
from core.motion.pour.cell import PourCell
from core.motion.pour.checking import check_plan, examine
from core.motion.pour.geometry import grasp_of_cup
from core.motion.pour.plan import PourFeasibility, PourPlan
from core.motion.pour.scene import PourScene
from core.motion.pour.search import WaySearch
from core.motion.pour.station import Grip, find_grips
from core.motion.pour.turns import FINE, PourTask, Reasons
from core.parameters.imagination import PouringParameters
from core.progress import Reporter
from core.workers import Task, WorkerPool, report_fraction

_MOST_BUILT = 6


def judge_pours(
    cell: PourCell,
    object_aabb_m: FloatArray,
    theta_rad: FloatArray,
    pivot_m: FloatArray,
    pouring: PouringParameters,
    start_rad: FloatArray,
    pool: WorkerPool,
    reporter: Reporter,
) -> tuple[PourFeasibility, ...]:
    """Plan every pour and tell which can be made; a pour that can be made has passed every check.

    Args:
        cell: the arm and what stands around it.
        object_aabb_m: (2, 3) lower and upper corner of the object in the base frame.
        theta_rad: (I,) directions of the pours.
        pivot_m: (I, 3, 3) pivots, by direction and distance.
        pouring: the imagined pours' parameters.
        start_rad: (6,) where the joints are now.
        pool: workers.
        reporter: is told the progress.

    Returns:
        All pours, direction by direction; the same whatever the number of workers.

    Raises:
        MotionError: the cup cannot be taken at its station at all.
        Cancelled: the reporter was asked to stop.
    """
    scene = PourScene(cell, object_aabb_m, pouring.cup)
    grips = find_grips(scene, start_rad)
    pours = [
        PourTask(i, j, float(theta_rad[i]), pivot_m[i, j])
        for i in range(len(theta_rad))
        for j in range(pivot_m.shape[1])
    ]
    # what several pours ask is answered once in each task: as few tasks as there are workers
    n_chunks = min(len(pours), pool.workers)
    chunks = [pours[k::n_chunks] for k in range(n_chunks)]
    tasks = [Task(_judge_some, (cell, object_aabb_m, pouring, grips, chunk), len(chunk)) for chunk in chunks]
    found = [judged for some in pool.run(tasks, "motion", reporter) for judged in some]
    return tuple(sorted(found, key=lambda judged: (judged.i, judged.j)))


def plan_pour(
    cell: PourCell,
    object_aabb_m: FloatArray,
    i: int,
    j: int,
    theta_rad: float,
    pivot_m: FloatArray,
    pouring: PouringParameters,
    start_rad: FloatArray,
) -> PourPlan:
    """Plan one pour, check every sample of it, and return it.

    Args:
        cell: the arm and what stands around it.
        object_aabb_m: (2, 3) lower and upper corner of the object in the base frame.
        i: index of the direction.
        j: index of the distance.
        theta_rad: the direction.
        pivot_m: (3,) the pivot.
        pouring: the imagined pour's parameters.
        start_rad: (6,) where the joints are now.

    Raises:
        MotionError: why the arm cannot make this pour.
    """
    scene = PourScene(cell, object_aabb_m, pouring.cup)
    grips = find_grips(scene, start_rad)
    plan = _plan(
        WaySearch(scene, pouring, grips), PourTask(int(i), int(j), float(theta_rad), np.asarray(pivot_m))
    )
    check_plan(cell, object_aabb_m, pouring, plan, np.asarray(pivot_m), theta_rad)
    return plan


def _judge_some(
    cell: PourCell,
    object_aabb_m: FloatArray,
    pouring: PouringParameters,
    grips: Sequence[Grip],
    pours: Sequence[PourTask],
) -> list[PourFeasibility]:
    """In a worker: judge some of the pours."""
    search = WaySearch(PourScene(cell, object_aabb_m, pouring.cup), pouring, grips)
    judged = []
    for pour in pours:
        judged.append(_judge(search, pour))
        report_fraction(len(judged) / len(pours))
    return judged


def _judge(search: WaySearch, pour: PourTask) -> PourFeasibility:
    try:
        plan = _plan(search, pour)
    except MotionError as error:
        return PourFeasibility(pour.i, pour.j, False, str(error), 0.0, 0.0, 0.0)
    return PourFeasibility(pour.i, pour.j, True, "", plan.clearance_m, plan.turn_s, plan.duration_s)


def _plan(search: WaySearch, pour: PourTask) -> PourPlan:
    reasons = Reasons()
    cell, pouring = search.scene.cell, search.pouring
    n_built = 0
    for way in search.ways(pour, reasons):
        T_grasp_cup = grasp_of_cup(way.turn.psi_rad, cell.grip_height_m)
        try:
            moves = build_moves(search.scene, pouring, way)
            figures = examine(
                search.scene, pouring, moves, T_grasp_cup, pour.pivot_m, pour.theta_rad, way.grip.room
            )
        except MotionError as error:
            reasons.add(FINE, str(error))
            n_built += 1
            if n_built == _MOST_BUILT:
                break
            continue
        measured = figures.as_table()
        return PourPlan(pour.i, pour.j, moves, T_grasp_cup, imagined_turn_s=pouring.turn_s, **measured)
    raise MotionError(reasons.sentence)
