"""Open containability imagination: would candies dropped on the object stay? (Sec. III-A)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.collision import CollisionModel
from core.geometry import BoolArray, FloatArray
from core.imagination.body import BodyFile
from core.imagination.bullet_world import BulletWorld
from core.imagination.drop_grid import drop_positions
from core.imagination.particle_shape import half_heights_m
from core.imagination.perturbation import Perturbation, move_object
from core.imagination.recording import Recorder
from core.imagination.results import Containability, Footprint
from core.parameters import Parameters
from core.parameters.imagination import ParticleParameters
from core.workers import Task, report_fraction

_REPORT_STEPS = 25
DROP_WEIGHT = 30.0
"""Time of the drop compared with one pour, for the progress shown."""


@dataclass(frozen=True)
class ObjectAtRest:
    """What the physics needs to know of the object: its body, AABB (2, 3) and centre of mass (3,)."""

    body: BodyFile
    aabb_m: FloatArray
    center_of_mass_m: FloatArray


def object_at_rest(model: CollisionModel, body: BodyFile, parameters: Parameters) -> ObjectAtRest:
    """Gather what the physics needs to know of the object."""
    margin = parameters.collision.aabb_margin_m
    aabb = np.array([model.surface.aabb_min_m - margin, model.surface.aabb_max_m + margin])
    return ObjectAtRest(body, aabb, model.surface.center_of_mass_m)


def drop_task(target: ObjectAtRest, parameters: Parameters) -> Task:
    """Return the task whose result is the object's `Containability`."""
    return Task(_imagine_drop, (target, parameters), DROP_WEIGHT)


def inside_aabb(positions_m: FloatArray, aabb_m: FloatArray) -> BoolArray:
    """Return (n,) whether each of (n, 3) centres lies inside; absent particles (NaN) do not."""
    with np.errstate(invalid="ignore"):
        inside: BoolArray = ((positions_m > aabb_m[0]) & (positions_m < aabb_m[1])).all(axis=1)
    return inside


def has_room_above(poses: FloatArray, aabb_m: FloatArray, particle: ParticleParameters) -> BoolArray:
    """Return (n,) whether another particle on top of each at (n, 7) would have its centre inside; NaN: no.

    A hollow that one layer fills to the brim, such as a can's rim, holds candies but takes no pour.
    """
    with np.errstate(invalid="ignore"):
        above_m = poses[:, 2] + 2 * half_heights_m(particle, poses[:, 3:])
        has_room: BoolArray = above_m < aabb_m[1, 2]
    return has_room


def _imagine_drop(target: ObjectAtRest, parameters: Parameters) -> Containability:
    settings = parameters.containability
    generator = np.random.default_rng([parameters.seed, 0])
    starts = drop_positions(target.aabb_m, parameters.particle, settings, generator)
    perturbation = Perturbation(settings, target.center_of_mass_m)
    rate_hz = parameters.solver.rate_hz
    steps = round(perturbation.duration_s * rate_hz)
    record_steps = max(round(parameters.evidence.record_interval_s * rate_hz), 1)
    recorder = Recorder(len(starts))

    reach_m = perturbation.reach_m(target.aabb_m)
    with BulletWorld(parameters.solver, parameters.particle, settings.contact, reach_m) as world:
        body_id = world.add_driven_body(target.body, settings.contact.restitution)
        for start in starts:
            world.add_particle(np.array([*start, 0, 0, 0, 1]))
        for step in range(steps):
            motion = perturbation.at(step / rate_hz)
            if step % record_steps == 0:
                recorder.add(step / rate_hz, world.poses(), motion.T_world_object)
            if step % _REPORT_STEPS == 0:
                report_fraction(step / steps)
            move_object(world, body_id, motion, target.center_of_mass_m)
            world.step()
        poses = world.poses()
        recorder.add(steps / rate_hz, poses, np.eye(4))

    retained = inside_aabb(poses[:, :3], target.aabb_m)
    if settings.counted == "room_above":
        retained &= has_room_above(poses, target.aabb_m, parameters.particle)
    z_E = target.aabb_m[1, 2] + parameters.pouring.pivot_height_m
    footprint = Footprint.of(starts[retained, :2], z_E) if retained.any() else None
    return Containability(
        settings.omega_threshold, starts, retained, target.aabb_m, footprint, recorder.recording()
    )
