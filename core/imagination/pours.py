"""One imagined pour: the exits of a cup run replayed onto the object, or cup and object together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray, make_pose, rotation_z, transform_points
from core.imagination.body import BodyFile
from core.imagination.bullet_world import CHECK_STEPS, BulletWorld
from core.imagination.containability import ObjectAtRest, inside_aabb
from core.imagination.cup import pour_duration_s
from core.imagination.packing import CupRun, PouringCup, pack_cup
from core.imagination.recording import Recorder, Recording
from core.imagination.rotations import multiply_quaternions, quaternion_of, yaw_quaternion
from core.parameters import Parameters
from core.workers import Task, report_fraction

_RESTING_M_S = 0.03
"""Slower than that nothing leaves any more: the same counts as with 0.01 m/s, up to 1.6 times faster."""
_REPORT_STEPS = 25


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


def replay_task(
    target: ObjectAtRest, run: CupRun, T_world_E: FloatArray, parameters: Parameters, record: bool
) -> Task:
    """Return the task whose result is the `PourOutcome` of a cup run replayed at a pose (4, 4)."""
    return Task(_replay, (target, run, T_world_E, parameters, record))


def full_task(
    target: ObjectAtRest, cup: BodyFile, packing: int, pour: Pour, parameters: Parameters, record: bool
) -> Task:
    """Return the task whose result is the `PourOutcome` of cup and object simulated together."""
    return Task(_pour_fully, (target, cup, packing, pour, parameters, record))


def _replay(
    target: ObjectAtRest, run: CupRun, T_world_E: FloatArray, parameters: Parameters, record: bool
) -> PourOutcome:
    poses, velocities = _in_world(run, T_world_E)
    steps = round(pour_duration_s(parameters.pouring) * parameters.solver.rate_hz)
    record_steps = max(round(parameters.evidence.record_interval_s * parameters.solver.rate_hz), 1)
    order = [int(k) for k in np.argsort(run.release_steps, kind="stable") if run.release_steps[k] >= 0]
    in_world: list[int] = []  # candies in the order in which they entered the world
    frames: list[tuple[int, FloatArray]] = []

    with BulletWorld(
        parameters.solver, parameters.particle, parameters.pouring.contact, target.aabb_m
    ) as world:
        world.add_fixed_body(target.body, parameters.pouring.contact.restitution)
        first = run.release_steps[order[0]] if order else steps
        for step in range(first, steps):
            if step % _REPORT_STEPS == 0:
                report_fraction(step / steps)
            while len(in_world) < len(order) and run.release_steps[order[len(in_world)]] <= step:
                candy = order[len(in_world)]
                world.add_particle(poses[candy], velocities[candy])
                in_world.append(candy)
            if record and step % record_steps == 0:
                frames.append((step // record_steps, world.poses()))
            if step % CHECK_STEPS == 0 and _is_over(world, in_world, order):
                break
            world.step()
        final = world.poses()

    n_in = _count(final, parameters.pouring.n_pour, target, parameters)
    recording = _whole_recording(run, T_world_E, frames, in_world, final) if record else None
    return PourOutcome(n_in, _n_fallen(final, target), recording)


def _is_over(world: BulletWorld, in_world: list[int], order: list[int]) -> bool:
    return len(in_world) == len(order) and world.top_speed_m_s() < _RESTING_M_S


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
        world.add_fixed_body(target.body, pouring.contact.restitution)
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
