"""Retention of one object: a load is poured in, then tilted in eight directions until it leaves."""

from __future__ import annotations

from math import cos, floor, sin

import numpy as np

from core.collision import CollisionModel
from core.geometry import FloatArray, IntArray
from core.imagination.bullet_world import GRAVITY_M_S2, BulletWorld
from core.imagination.context import ImaginationContext
from core.imagination.drop import pitch_m
from core.imagination.object_at_rest import ObjectAtRest, has_room_above, inside_aabb
from core.imagination.results import Drop
from core.imagination.retention.result import Retention
from core.parameters import Parameters
from core.parameters.imagination import N_TILT_DIRECTIONS, RetentionParameters
from core.workers import Task, report_fraction

STAGE = "retention"
_SEED_STREAM = 2
"""The drop and the packings draw from streams 0 and 1 of the seed."""
_ROUNDS = 3
"""What missed the object is poured again: twice."""
_FALL_S = 0.2
"""Until then a candy may be slow because it has only begun to fall."""


def imagine_retention(context: ImaginationContext, model: CollisionModel, drop: Drop) -> Retention:
    """Tilt an object with candies in it, in 8 directions, until they leave.

    Args:
        context: its parameters say how large the load is and how it is tilted.
        model: the object's body.
        drop: on the same object; with a footprint.

    Raises:
        ValueError: no candy stayed in the drop.
    """
    parameters, target = context.parameters, context.target(model)
    directions = tilt_directions_rad(drop)
    load = context.run([load_task(target, drop, parameters)], STAGE)[0]
    tasks = [tilt_task(target, load, angle, parameters) for angle in directions.tolist()]
    n_left = np.array(context.run(tasks, STAGE))
    settings = parameters.holding
    return Retention(settings.n_load, len(load), tilt_angles_rad(settings), directions, n_left)


def tilt_directions_rad(drop: Drop) -> FloatArray:
    """Return (8,) the sides that sink, against the x-axis: i pi/4 from the footprint's principal axis.

    Raises:
        ValueError: no candy stayed in the drop.
    """
    if drop.footprint is None:
        raise ValueError("no candy stayed: there is no footprint to pour onto")
    step = 2 * np.pi / N_TILT_DIRECTIONS
    directions: FloatArray = drop.footprint.axis_rad + step * np.arange(N_TILT_DIRECTIONS, dtype=np.float64)
    return directions


def load_task(target: ObjectAtRest, drop: Drop, parameters: Parameters) -> Task:
    """Return the task whose result is the load: poses (n, 7) of the candies at rest inside the object.

    The load is a fixed number, the same for each object where it fits, and not what stayed in the drop: that
    grows with the object's width, and a bowl which is full loses candies at the first degree. It is poured
    anew, because few candies taken out of many would no longer lie as the many held them. What falls off is
    replaced twice, so that a miss is no fault of the object; what still does not fit is no part of the load.
    Which candies lie inside is decided at rest as in the drop (`containability.counted`): one that fills a
    hollow to the brim is taken out. Afterwards, against a tilted wall, a candy is in while its centre is.
    """
    return Task(_pour_load, (target, drop, parameters), 2.0)


def load_starts(drop: Drop, parameters: Parameters) -> FloatArray:
    """Return (n_load, 3) where they fall from: in layers above the middle of the footprint.

    Raises:
        ValueError: no candy stayed in the drop.
    """
    if drop.footprint is None:
        raise ValueError("no candy stayed: there is no footprint to pour onto")
    settings = parameters.holding
    apart_m = float(pitch_m(parameters.particle, parameters.containability)[0]) / 2
    places = _distinct(drop.drop_positions_m[drop.retained, :2], apart_m)
    # As a pour does: what falls near the rim of a bowl slides through it and out on the other side.
    from_middle = np.linalg.norm(places - drop.footprint.center_m[:2], axis=1)
    places = places[np.argsort(from_middle, kind="stable")][: -(-len(places) // 2)]
    generator = np.random.default_rng([parameters.seed, _SEED_STREAM])
    n_layers = -(-settings.n_load // len(places))
    order = np.concatenate([generator.permutation(len(places)) for _ in range(n_layers)])[: settings.n_load]
    layers = np.arange(settings.n_load) // len(places)
    bottom_m = drop.aabb_m[1, 2] + parameters.containability.layer_height_m
    starts = np.column_stack([places[order], bottom_m + layers * settings.layer_spacing_m])
    jitter_m = parameters.containability.jitter_m
    jittered: FloatArray = starts + generator.uniform(-jitter_m, jitter_m, starts.shape)
    return jittered


def _distinct(positions_m: FloatArray, apart_m: float) -> FloatArray:
    """Keep of (n, 2) positions the first of those that lie less than `apart_m` from each other."""
    kept: list[FloatArray] = []
    for position in positions_m:
        if all(np.hypot(*(position - other)) > apart_m for other in kept):
            kept.append(position)
    return np.array(kept).reshape(-1, 2)


def _pour_load(target: ObjectAtRest, drop: Drop, parameters: Parameters) -> FloatArray:
    settings, contact = parameters.holding, parameters.containability.contact
    starts = load_starts(drop, parameters)
    with BulletWorld(parameters.solver, parameters.particle, contact, target.aabb_m) as world:
        world.add_fixed_body(target.body)
        n_inside = 0
        for round_ in range(_ROUNDS):
            report_fraction(round_ / _ROUNDS)
            for start in starts[: settings.n_load - n_inside]:
                world.add_particle(np.array([*start, 0, 0, 0, 1]))
            _settle(world, parameters)
            n_inside = keep_inside(world, target.aabb_m)
            if n_inside == settings.n_load:
                break
        poses = world.poses()
    load = poses[np.isfinite(poses[:, 0])]
    if parameters.containability.counted == "room_above":
        load = load[has_room_above(load, target.aabb_m, parameters.particle)]
    return load


def _settle(world: BulletWorld, parameters: Parameters) -> None:
    settings, rate_hz = parameters.holding, parameters.solver.rate_hz
    for step in range(1, round(settings.settle_s * rate_hz) + 1):
        world.step()
        falling = step < _FALL_S * rate_hz
        if not falling and step % LOOK_STEPS == 0 and world.is_at_rest(settings.rest_m_s):
            return


LOOK_STEPS = 12
"""Steps between two looks at whether the candies rest."""


def keep_inside(world: BulletWorld, box_m: FloatArray) -> int:
    """Take out the candies whose centre is outside the box (2, 3); return how many are left."""
    inside = inside_aabb(world.poses()[:, :3], box_m)
    for index in np.flatnonzero(~inside).tolist():
        if world.particle_ids[index] is not None:
            world.remove_particle(index)
    return int(inside.sum())


def tilt_task(
    target: ObjectAtRest,
    load: FloatArray,
    direction_rad: float,
    parameters: Parameters,
) -> Task:
    """Return the task whose result is (S,) how many candies are left after each of `tilt_angles_rad`.

    Args:
        target: the object, which stands at rest.
        load: (n, 7) poses of the candies in it.
        direction_rad: of the side that sinks, against the x-axis.
        parameters: candy, contact, solver and tilt.
    """
    return Task(_tilt, (target, load, direction_rad, parameters))


def tilt_angles_rad(settings: RetentionParameters) -> FloatArray:
    """Return (S,) the angles held at, from 0."""
    # A share of a step more, so that rounding does not lose the last.
    n_steps = floor(settings.tilt_max_rad / settings.tilt_step_rad + 1e-9)
    angles: FloatArray = settings.tilt_step_rad * np.arange(n_steps + 1, dtype=np.float64)
    return angles


def tilted_gravity_m_s2(tilt_rad: float, direction_rad: float) -> FloatArray:
    """Return gravity (3,) in the frame of an object whose side at `direction_rad` has sunk by `tilt_rad`."""
    across = sin(tilt_rad)
    return GRAVITY_M_S2 * np.array([across * cos(direction_rad), across * sin(direction_rad), -cos(tilt_rad)])


def _tilt(
    target: ObjectAtRest,
    load: FloatArray,
    direction_rad: float,
    parameters: Parameters,
) -> IntArray:
    contact = parameters.containability.contact
    angles = tilt_angles_rad(parameters.holding)
    left = np.zeros(len(angles), dtype=np.int64)
    with BulletWorld(parameters.solver, parameters.particle, contact, target.aabb_m) as world:
        world.add_fixed_body(target.body)
        for pose in load:
            world.add_particle(pose)
        for index, angle in enumerate(angles.tolist()):
            report_fraction(index / len(angles))
            world.set_gravity(tilted_gravity_m_s2(angle, direction_rad))
            _hold(world, target.aabb_m, parameters)
            left[index] = keep_inside(world, target.aabb_m)
            if left[index] == 0:
                break
    return left


def _hold(world: BulletWorld, aabb_m: FloatArray, parameters: Parameters) -> None:
    """Let the candies move until they rest, or the time is over."""
    # What is farther out than its own size does not come back; what is nearer may be on its way over another.
    beyond_m = parameters.particle.diameter_m
    grown_m = aabb_m + np.array([[-beyond_m], [beyond_m]])
    settings = parameters.holding
    looks = max(round(settings.hold_s * parameters.solver.rate_hz / LOOK_STEPS), 1)
    for _ in range(looks):
        for _ in range(LOOK_STEPS):
            world.step()
        keep_inside(world, grown_m)
        if world.is_at_rest(settings.rest_m_s):
            return
