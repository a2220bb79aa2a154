"""Which of the imagined pours this arm can make, and the plan for one of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.errors import MotionError
from core.geometry import FloatArray
from core.motion.pour.cell import PourCell
from core.motion.pour.checking import check_plan, checked_plan
from core.motion.pour.feasibility import PourFeasibility
from core.motion.pour.geometry import grasp_of_cup, imagined_rate, pouring_grasps, tilting_grasps
from core.motion.pour.plan import MOVES, PlannedMove, PourPlan, PourTarget
from core.motion.pour.scene import PourScene
from core.motion.pour.search import PathSearch, PourPath, Reasons, Stage
from core.motion.pour.station import Grip, find_grips
from core.motion.pour.tool_path import SpeedLimits, ToolPath
from core.motion.trajectory import JointTrajectory
from core.parameters.imagination import PouringParameters
from core.progress import Reporter
from core.workers import Task, TaskRunner, report_fraction

_MOST_BUILT = 6
_ROTATION_POINTS = 200


def judge_pours(
    cell: PourCell,
    object_aabb_m: FloatArray,
    theta_rad: FloatArray,
    pivot_m: FloatArray,
    pouring: PouringParameters,
    start_rad: FloatArray,
    runner: TaskRunner,
    reporter: Reporter,
) -> tuple[PourFeasibility, ...]:
    """Plan every pour and return which are feasible; a feasible pour has passed every check.

    Args:
        cell: the arm and its surroundings.
        object_aabb_m: (2, 3) lower and upper corner of the object in the base frame.
        theta_rad: (I,) directions of the pours.
        pivot_m: (I, 3, 3) pivots, by direction and distance.
        pouring: the imagined pours' parameters.
        start_rad: (6,) the present configuration.
        runner: where to compute.
        reporter: of the progress.

    Returns:
        All pours, direction by direction; the same whatever the number of workers.

    Raises:
        MotionError: the cup cannot be taken at its station at all.
        Cancelled: the reporter was asked to stop.
    """
    grips = find_grips(PourScene(cell, object_aabb_m, pouring.cup), start_rad)
    targets = [
        PourTarget(object_aabb_m, i, j, float(theta_rad[i]), pivot_m[i, j], pouring)
        for i in range(len(theta_rad))
        for j in range(pivot_m.shape[1])
    ]
    # what several pours need is computed once in each task: as few tasks as there are workers
    n_chunks = min(len(targets), runner.workers)
    chunks = [targets[k::n_chunks] for k in range(n_chunks)]
    tasks = [Task(_judge_some, (cell, grips, chunk), len(chunk)) for chunk in chunks]
    found = [judged for some in runner.run(tasks, "motion", reporter) for judged in some]
    return tuple(sorted(found, key=lambda judged: (judged.i, judged.j)))


def plan_pour(cell: PourCell, target: PourTarget, start_rad: FloatArray) -> PourPlan:
    """Plan a pour from a configuration (6,), check every sample of the plan, and return it.

    Raises:
        MotionError: why the arm cannot make this pour.
    """
    scene = PourScene(cell, target.object_aabb_m, target.pouring.cup)
    plan = _plan(PathSearch(scene, find_grips(scene, start_rad)), target)
    check_plan(cell, target, plan)
    return plan


def _judge_some(
    cell: PourCell, grips: Sequence[Grip], targets: Sequence[PourTarget]
) -> list[PourFeasibility]:
    """In a worker: judge some pours onto one object."""
    search = PathSearch(PourScene(cell, targets[0].object_aabb_m, targets[0].pouring.cup), grips)
    judged = []
    for target in targets:
        judged.append(_judge(search, target))
        report_fraction(len(judged) / len(targets))
    return judged


def _judge(search: PathSearch, target: PourTarget) -> PourFeasibility:
    try:
        plan = _plan(search, target)
    except MotionError as error:
        return PourFeasibility(target.i, target.j, False, str(error), 0.0, 0.0, 0.0)
    return PourFeasibility(target.i, target.j, True, "", plan.clearance_m, plan.turn_s, plan.duration_s)


def _plan(search: PathSearch, target: PourTarget) -> PourPlan:
    reasons = Reasons()
    n_built = 0
    for path in search.paths(target, reasons):
        T_grasp_cup = grasp_of_cup(path.grasp.psi_rad, search.scene.cell.grip_height_m)
        try:
            moves = _build_moves(search.scene, path)
            return checked_plan(search.scene, target, moves, T_grasp_cup, path.grip.clearance)
        except MotionError as error:
            reasons.add(Stage.CHECK, str(error))
            n_built += 1
            if n_built == _MOST_BUILT:
                break
    raise MotionError(reasons.sentence)


def _build_moves(scene: PourScene, path: PourPath) -> tuple[PlannedMove, ...]:
    """Return all moves of a path with their times; the moves back are the moves out, reversed.

    Raises:
        MotionError: the arm cannot follow between the points that were checked.
    """
    grip, branch, pouring = path.grip, path.grasp.branch, path.target.pouring
    transfer, fast = SpeedLimits.of_transfer(scene.cell.limits), SpeedLimits.of_pour(scene.cell.limits)
    here = grip.lift.end_rad
    stretches = []
    for stretch in path.carry:
        stretches.append(stretch.tool_path.trajectory(scene, branch, here, transfer))
        here = stretches[-1].end_rad
    carry = JointTrajectory.joined(stretches) if stretches else JointTrajectory.at_rest(here, 0.0)
    tilt = _tilting(path).trajectory(scene, branch, carry.end_rad, transfer)
    lower = _lowering(path).trajectory(scene, branch, tilt.end_rad, transfer)
    rotation = _pour_rotation(scene, path).trajectory(scene, branch, lower.end_rad, fast)
    settle = JointTrajectory.at_rest(rotation.start_rad, pouring.settle_s)
    wait = JointTrajectory.at_rest(rotation.end_rad, pouring.wait_s)
    pour = JointTrajectory.joined([settle, rotation, wait])
    out = [grip.approach, grip.grasp, grip.lift, carry, tilt, lower, pour]
    back = [part.reversed() for part in (rotation, lower, tilt, carry, grip.lift, grip.grasp)]
    return tuple(
        PlannedMove(segment, phase, trajectory, holds_cup, gripper_after)
        for (segment, phase, holds_cup, gripper_after), trajectory in zip(
            MOVES, [*out, *back, grip.home], strict=True
        )
    )


def _tilting(path: PourPath) -> ToolPath:
    def poses(shares: FloatArray) -> FloatArray:
        return tilting_grasps(
            path.target, path.grasp.psi_rad, path.upright_m, path.spin_rad, path.ready_m, shares
        )

    length = float(np.linalg.norm(path.ready_m - path.upright_m))
    return ToolPath.of_length(poses, length, np.pi / 2 + abs(path.spin_rad))


def _lowering(path: PourPath) -> ToolPath:
    down = path.initial_m - path.ready_m
    tilted = tilting_grasps(path.target, path.grasp.psi_rad, path.ready_m, 0.0, path.ready_m, np.ones(1))

    def poses(shares: FloatArray) -> FloatArray:
        lowered = np.repeat(tilted, len(shares), axis=0)
        lowered[:, :3, 3] = path.ready_m + shares[:, None] * down
        return lowered

    return ToolPath.of_length(poses, float(np.linalg.norm(down)), 0.0)


def _pour_rotation(scene: PourScene, path: PourPath) -> ToolPath:
    """The rotation about the pivot; its parameter is the pour angle gamma, its top rate the imagined one."""
    pouring = path.target.pouring

    def poses(gammas: FloatArray) -> FloatArray:
        return pouring_grasps(path.target, scene.cell.grip_height_m, path.grasp.psi_rad, gammas)

    gammas = np.linspace(0, pouring.gamma_0_rad, _ROTATION_POINTS + 1)
    return ToolPath(poses, gammas, imagined_rate(pouring, gammas))
