"""Pouring imagination: 8 directions at 3 distances, each with several packings (Sec. III-B).

The exits of a cup run are replayed onto the object, or cup and object are simulated together.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from core.collision import CollisionModel
from core.geometry import FloatArray, make_pose, rotation_z, transform_points
from core.imagination.body import BodyFile
from core.imagination.bullet_world import CHECK_STEPS, RESTING_M_S, BulletWorld
from core.imagination.capacity.finding import hollows_of_body
from core.imagination.context import ImaginationContext
from core.imagination.cup import pour_duration_s
from core.imagination.cup_run import CupRun, PouringCup
from core.imagination.cup_runs import CupRuns
from core.imagination.object_at_rest import ObjectAtRest, inside_aabb
from core.imagination.packing import pack_cup
from core.imagination.recording import Recorder, Recording
from core.imagination.results import Footprint, PourGrid, PoursSoFar
from core.imagination.rotations import multiply_quaternions, quaternion_of, yaw_quaternion
from core.parameters import Parameters
from core.parameters.imagination import N_INDENT, N_THETA, PouringParameters
from core.workers import Task, report_fraction

STAGE = "pouring"
_REPORT_STEPS = 25
_LOOKS_STILL_M_S = 0.2
"""A recording ends with candies that jump no higher than 2 mm any more."""


@dataclass(frozen=True)
class Pour:
    """Where and from which side: r_pivot (3,) and the direction theta of the ray from p_E to it."""

    pivot_m: FloatArray
    theta_rad: float

    @property
    def T_world_E(self) -> FloatArray:
        """(4, 4) pose of the E-local frame."""
        return make_pose(rotation_z(self.theta_rad), self.pivot_m)


@dataclass(frozen=True)
class PouredCup:
    """A cup's run and `T_world_E` (4, 4), where it is poured."""

    run: CupRun
    T_world_E: FloatArray


@dataclass(frozen=True)
class PourOutcome:
    """What became of the candies.

    Attributes:
        n_in: those that count as poured in.
        n_spilled: those that left the cup and fell beside the object; one on a heap above the rim did not.
        recording: none if none was asked for.
    """

    n_in: int
    n_spilled: int
    recording: Recording | None


def imagine_pours(
    context: ImaginationContext, model: CollisionModel, footprint: Footprint, runs: CupRuns, n_cups: int = 1
) -> PourGrid:
    """Imagine all pours into an object of which some candies stayed: of the first cup, if there are several.

    Raises:
        StageError: the cup cannot hold N_pour.
    """
    parameters, target = context.parameters, target_of_pours(context, model)
    pouring = parameters.pouring
    thetas = pour_directions_rad(footprint, pouring)
    indents = indentations_m(target.aabb_m, pouring)
    pivots = pivots_m(footprint.raised(pouring.pivot_height_m), thetas, indents)
    cup_runs = runs.of_packings(context)
    tasks = []
    for i, theta in enumerate(thetas):
        for j in range(N_INDENT):
            pour = Pour(pivots[i, j], float(theta))
            for packing in range(pouring.n_packings):
                record = packing == 0
                if pouring.mode == "full":
                    tasks.append(full_task(target, context.cup(), packing, pour, parameters, record))
                else:
                    tasks.append(replay_task(target, cup_runs[packing], pour.T_world_E, parameters, record))
    shape = len(thetas), N_INDENT, pouring.n_packings
    so_far = np.full(shape, np.nan)

    def tell(index: int, outcome: PourOutcome) -> None:
        so_far.reshape(-1)[index] = outcome.n_in / pouring.n_pour
        is_known = ~np.isnan(so_far)
        p = np.divide(
            np.nansum(so_far, axis=2),
            is_known.sum(axis=2),
            out=np.full(shape[:2], np.nan),
            where=is_known.any(axis=2),
        )
        context.reporter.tell(PoursSoFar(thetas, indents, p))

    outcomes: list[PourOutcome] = context.run(tasks, STAGE, tell)
    n_in = np.array([outcome.n_in for outcome in outcomes], dtype=np.int64).reshape(shape)
    n_spilled = np.array([outcome.n_spilled for outcome in outcomes], dtype=np.int64).reshape(shape)
    recordings = [outcome.recording for outcome in outcomes if outcome.recording is not None]
    rows = tuple(tuple(recordings[i * N_INDENT : (i + 1) * N_INDENT]) for i in range(len(thetas)))
    return PourGrid(pouring.n_pour, n_in, n_spilled, thetas, indents, pivots, rows, n_cups)


def target_of_pours(context: ImaginationContext, model: CollisionModel) -> ObjectAtRest:
    """Return an object, with the hollows that tell when a pour into it is over."""
    return replace(context.target(model), hollows=hollows_of_body(context, model))


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


def pivots_m(plane_E: Footprint, thetas_rad: FloatArray, indents_m: FloatArray) -> FloatArray:
    """r_pivot(i, j), (I, 3, 3): on rays from p_E, in the plane E, which is a raised footprint (Eq. 3)."""
    rays = np.stack([np.cos(thetas_rad), np.sin(thetas_rad), np.zeros_like(thetas_rad)], axis=-1)
    pivots: FloatArray = plane_E.center_m + rays[:, None, :] * indents_m[None, :, None]
    return pivots


def replay_task(
    target: ObjectAtRest, run: CupRun, T_world_E: FloatArray, parameters: Parameters, record: bool
) -> Task:
    """Return the task whose result is the `PourOutcome` of a cup run replayed at a pose (4, 4)."""
    return Task(_replay, (target, run, T_world_E, parameters, record))


def in_turn_task(target: ObjectAtRest, cups: Sequence[PouredCup], parameters: Parameters) -> Task:
    """Return the task whose result is the `PourOutcome` of cups that are poured one after the other."""
    return Task(_replay_in_turn, (target, cups, parameters), weight=float(len(cups)))


def full_task(
    target: ObjectAtRest, cup: BodyFile, packing: int, pour: Pour, parameters: Parameters, record: bool
) -> Task:
    """Return the task whose result is the `PourOutcome` of cup and object simulated together."""
    return Task(_pour_fully, (target, cup, packing, pour, parameters, record))


def _replay(
    target: ObjectAtRest, run: CupRun, T_world_E: FloatArray, parameters: Parameters, record: bool
) -> PourOutcome:
    record_steps = max(round(parameters.evidence.record_interval_s * parameters.solver.rate_hz), 1)
    frames: list[tuple[int, FloatArray]] = []

    def look(step: int) -> None:
        if step % _REPORT_STEPS == 0:
            report_fraction(step / _n_steps(parameters))
        if record and step % record_steps == 0:
            frames.append((step // record_steps, world.poses()))

    with BulletWorld(
        parameters.solver, parameters.particle, parameters.pouring.contact, target.aabb_m
    ) as world:
        world.add_fixed_body(target.body)
        still_m_s = _LOOKS_STILL_M_S if record else np.inf
        in_world = _let_fall(world, target, PouredCup(run, T_world_E), parameters, still_m_s, look)
        final = world.poses()

    n_in = _count(final, parameters.pouring.n_pour, target, parameters)
    recording = _whole_recording(run, T_world_E, frames, in_world, final) if record else None
    return PourOutcome(n_in, _n_fallen(final, target), recording)


def _replay_in_turn(target: ObjectAtRest, cups: Sequence[PouredCup], parameters: Parameters) -> PourOutcome:
    with BulletWorld(
        parameters.solver, parameters.particle, parameters.pouring.contact, target.aabb_m
    ) as world:
        world.add_fixed_body(target.body)
        for index, cup in enumerate(cups):
            report_fraction(index / len(cups))
            still_m_s = np.inf if cup is cups[-1] else RESTING_M_S
            _let_fall(world, target, cup, parameters, still_m_s)
        final = world.poses()
    n_poured = parameters.pouring.n_pour * len(cups)
    return PourOutcome(_count(final, n_poured, target, parameters), _n_fallen(final, target), None)


def _let_fall(
    world: BulletWorld,
    target: ObjectAtRest,
    cup: PouredCup,
    parameters: Parameters,
    still_m_s: float,
    look: Callable[[int], None] = lambda _: None,
) -> list[int]:
    """Let a cup's candies into the world as they left the cup, until all rest or the pour is over.

    Args:
        world: with the object, and what was poured into it before.
        target: the object.
        cup: whose candies fall.
        parameters: of the pour.
        still_m_s: slower than that is still enough for candies of which it is known that they stay.
        look: called with each step's number before it is made.

    Returns:
        The cup's candies in the order in which they entered the world.
    """
    run, steps = cup.run, _n_steps(parameters)
    poses, velocities = _in_world(run, cup.T_world_E)
    order = [int(k) for k in np.argsort(run.release_steps, kind="stable") if run.release_steps[k] >= 0]
    in_world: list[int] = []
    for step in range(run.release_steps[order[0]] if order else steps, steps):
        while len(in_world) < len(order) and run.release_steps[order[len(in_world)]] <= step:
            candy = order[len(in_world)]
            world.add_particle(poses[candy], velocities[candy])
            in_world.append(candy)
        look(step)
        if step % CHECK_STEPS == 0 and len(in_world) == len(order) and _is_over(world, target, still_m_s):
            break
        world.step()
    return in_world


def _is_over(world: BulletWorld, target: ObjectAtRest, still_m_s: float) -> bool:
    """Whether candies rest, or those that did not fall past the object cannot leave it and are still."""
    speeds_m_s = world.speeds_m_s()
    top_speed_m_s = float(np.nanmax(speeds_m_s, initial=0.0))
    if target.hollows is None or not RESTING_M_S <= top_speed_m_s < still_m_s:
        return top_speed_m_s < RESTING_M_S
    kept = target.hollows.keeps(world.poses()[:, :3], speeds_m_s)
    return bool(kept[np.isfinite(speeds_m_s)].all())


def _n_steps(parameters: Parameters) -> int:
    return round(pour_duration_s(parameters.pouring) * parameters.solver.rate_hz)


def _in_world(run: CupRun, T_world_E: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Take the release states from the E-local frame to the world."""
    positions = transform_points(T_world_E, run.poses[:, :3])
    rotation = T_world_E[:3, :3]
    quaternions = multiply_quaternions(quaternion_of(rotation), run.poses[:, 3:])
    velocities = [run.velocities[:, :3] @ rotation.T, run.velocities[:, 3:] @ rotation.T]
    return np.hstack([positions, quaternions]), np.hstack(velocities)


def _count(final: FloatArray, n_pour: int, target: ObjectAtRest, parameters: Parameters) -> int:
    """Count the candies poured in, given the poses of those that left the cup."""
    if parameters.pouring.counted == "inside":
        return int(inside_aabb(final[:, :3], target.aabb_m).sum())
    return n_pour - _n_fallen(final, target)  # those still in the cup are above the floor too


def _n_fallen(final: FloatArray, target: ObjectAtRest) -> int:
    with np.errstate(invalid="ignore"):
        return len(final) - int((final[:, 2] >= target.aabb_m[0, 2]).sum())


def _whole_recording(
    run: CupRun,
    T_world_E: FloatArray,
    frames: list[tuple[int, FloatArray]],
    in_world: list[int],
    final: FloatArray,
) -> Recording:
    """Join what the cup run recorded before each candy's release with what the replay recorded after."""
    before = run.recording
    positions = transform_points(T_world_E, before.positions_m).astype(np.float32)
    quaternions = multiply_quaternions(quaternion_of(T_world_E[:3, :3]), before.quaternions)
    after = dict(frames)
    for moment in range(len(before.time_s)):
        # Once all candies rest the replay ends: from then on they stay where they are.
        poses = after.get(moment, final if not after or moment > max(after) else None)
        if poses is not None and len(poses):
            candies = in_world[: len(poses)]
            positions[moment, candies] = poses[:, :3]
            quaternions[moment, candies] = np.nan_to_num(poses[:, 3:])
    return Recording(
        before.time_s,
        positions,
        quaternions.astype(np.float32),
        (T_world_E @ before.T_world_body).astype(np.float32),
    )


def _pour_fully(
    target: ObjectAtRest, cup_body: BodyFile, packing: int, pour: Pour, parameters: Parameters, record: bool
) -> PourOutcome:
    pouring, rate_hz = parameters.pouring, parameters.solver.rate_hz
    steps = round(pour_duration_s(pouring) * rate_hz)
    record_steps = max(round(parameters.evidence.record_interval_s * rate_hz), 1)
    recorder = Recorder(pouring.n_pour)
    reach = np.array([1.0, 1.0, 0.0]) * pouring.cup.length_m
    around = np.array([target.aabb_m[0] - reach, target.aabb_m[1] + pouring.cup.length_m])
    with BulletWorld(parameters.solver, parameters.particle, pouring.contact, around) as world:
        world.add_fixed_body(target.body)
        cup = PouringCup(world, cup_body, parameters, pour.pivot_m, pour.theta_rad)
        for start in transform_points(pour.T_world_E, pack_cup(parameters, packing)):
            world.add_particle(np.array([*start, *yaw_quaternion(pour.theta_rad)]))
        for step in range(steps):
            T_world_cup = cup.move(step / rate_hz)
            if step % _REPORT_STEPS == 0:
                report_fraction(step / steps)
            if record and step % record_steps == 0:
                recorder.add(step / rate_hz, world.poses(), T_world_cup)
            world.step()
        final = world.poses()
        recorder.add(steps / rate_hz, final, cup.move(steps / rate_hz))
    n_in = _count(final, pouring.n_pour, target, parameters)
    return PourOutcome(n_in, _n_fallen(final, target), recorder.recording() if record else None)
