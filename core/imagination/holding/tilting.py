"""One direction of tilt, step by step, until everything has left.

To tilt the object is to turn gravity in its frame: the object stays a fixed body, which is quick and exact.
"""

from __future__ import annotations

from math import cos, floor, sin

import numpy as np

from core.geometry import FloatArray, IntArray
from core.imagination.bullet_world import GRAVITY_M_S2, BulletWorld
from core.imagination.containability import ObjectAtRest
from core.imagination.holding.watching import LOOK_STEPS, keep_inside
from core.parameters import Parameters
from core.parameters.holding import HoldingParameters
from core.workers import Task, report_fraction


def tilt_task(
    target: ObjectAtRest,
    load: FloatArray,
    direction_rad: float,
    parameters: Parameters,
    settings: HoldingParameters,
) -> Task:
    """Return the task whose result is (S,) how many candies are left after each of `tilt_angles_rad`.

    Args:
        target: the object, which stands at rest.
        load: (n, 7) poses of the candies in it.
        direction_rad: of the side that sinks, against the x-axis.
        parameters: of the imagination: candy, contact and solver.
        settings: of the tilt.
    """
    return Task(_tilt, (target, load, direction_rad, parameters, settings))


def tilt_angles_rad(settings: HoldingParameters) -> FloatArray:
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
    settings: HoldingParameters,
) -> IntArray:
    contact = parameters.containability.contact
    angles = tilt_angles_rad(settings)
    left = np.zeros(len(angles), dtype=np.int64)
    with BulletWorld(parameters.solver, parameters.particle, contact, target.aabb_m) as world:
        world.add_fixed_body(target.body, contact.restitution)
        for pose in load:
            world.add_particle(pose)
        for index, angle in enumerate(angles.tolist()):
            report_fraction(index / len(angles))
            world.set_gravity(tilted_gravity_m_s2(angle, direction_rad))
            _hold(world, target.aabb_m, parameters, settings)
            left[index] = keep_inside(world, target.aabb_m)
            if left[index] == 0:
                break
    return left


def _hold(
    world: BulletWorld, aabb_m: FloatArray, parameters: Parameters, settings: HoldingParameters
) -> None:
    """Let the candies move until they rest, or the time is over."""
    # What is farther out than its own size does not come back; what is nearer may be on its way over another.
    beyond_m = parameters.particle.diameter_m
    grown_m = aabb_m + np.array([[-beyond_m], [beyond_m]])
    looks = max(round(settings.hold_s * parameters.solver.rate_hz / LOOK_STEPS), 1)
    for _ in range(looks):
        for _ in range(LOOK_STEPS):
            world.step()
        keep_inside(world, grown_m)
        if world.top_speed_m_s() < settings.rest_m_s:
            return
