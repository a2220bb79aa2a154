"""Open containability imagination: would candies dropped on the object stay? (Sec. III-A)."""

from __future__ import annotations

from math import ceil, floor, sqrt

import numpy as np

from core.collision import CollisionModel
from core.errors import StageError
from core.geometry import FloatArray
from core.imagination.bullet_world import BulletWorld
from core.imagination.context import ImaginationContext
from core.imagination.object_at_rest import ObjectAtRest, has_room_above, inside_aabb
from core.imagination.particle_shape import particle_extents_m
from core.imagination.perturbation import Perturbation, move_object
from core.imagination.recording import Recorder
from core.imagination.results import Drop, Footprint
from core.parameters import Parameters
from core.parameters.bodies import ParticleParameters
from core.parameters.imagination import ContainabilityParameters
from core.workers import Task, report_fraction

STAGE = "containability"
_REPORT_STEPS = 25
_DROP_WEIGHT = 30.0
"""Time of the drop compared with one pour, for the progress shown."""


def imagine_drop(context: ImaginationContext, model: CollisionModel) -> Drop:
    """Drop candies on an object and perturb it.

    Raises:
        StageError: the object is smaller than a candy.
    """
    found: Drop = context.run([drop_task(context, model)], STAGE)[0]
    return found


def drop_task(context: ImaginationContext, model: CollisionModel) -> Task:
    """Return what a worker has to do for it.

    Raises:
        StageError: the object is smaller than a candy; found out before a worker starts.
    """
    parameters, target = context.parameters, context.target(model)
    settings = parameters.containability
    extents_m = target.aabb_m[1] - target.aabb_m[0]
    grid_counts(extents_m, pitch_m(parameters.particle, settings), settings)
    return Task(_imagine_drop, (target, parameters), _DROP_WEIGHT)


def grid_counts(
    extents_m: FloatArray, pitch_m: FloatArray, settings: ContainabilityParameters
) -> tuple[int, int, int]:
    """Return (N_x, N_y, N_z) for an object and a particle of the given AABB extents (Sec. III-A).

    Raises:
        StageError: the object is smaller than a particle.
    """

    def counts(scale: float) -> tuple[int, int]:
        return floor(scale * extents_m[0] / pitch_m[0]), floor(scale * extents_m[1] / pitch_m[1])

    n_x, n_y = counts(1.0)
    if n_x * n_y == 0:
        width, depth = (1000 * extents_m[:2]).round(1)
        raise StageError(
            f"The object ({width} x {depth} mm from above) is smaller than a candy "
            f"({1000 * pitch_m[0]:.1f} mm with its margin): choose a smaller particle.diameter_m, "
            "or check that the mesh is in metres."
        )
    if n_x * n_y > settings.n_max:
        # An object many candies long and one wide would be scaled to none: one row always stays.
        scaled = counts(sqrt(settings.n_max / (n_x * n_y)))
        return max(scaled[0], 1), max(scaled[1], 1), 1
    layers = settings.n_min / (n_x * n_y)
    if layers <= 1:
        return n_x, n_y, 1
    return n_x, n_y, floor(layers) + 1 if settings.layers == "one_more" else ceil(layers)


def pitch_m(particle: ParticleParameters, parameters: ContainabilityParameters) -> FloatArray:
    """Extents (3,) of a candy's AABB with its margin."""
    return particle_extents_m(particle) + 2 * parameters.pitch_margin_m


def drop_positions(
    aabb_m: FloatArray,
    particle: ParticleParameters,
    parameters: ContainabilityParameters,
    generator: np.random.Generator,
) -> FloatArray:
    """Return (N_drop, 3) positions in a grid over the top face of `aabb_m` (2, 3), lightly jittered."""
    low, high = aabb_m
    n_x, n_y, n_z = grid_counts(high - low, pitch_m(particle, parameters), parameters)
    layers = high[2] + parameters.layer_height_m + parameters.layer_spacing_m * np.arange(n_z)
    at_edges = parameters.two_abreast == "edges"
    x_m, y_m = _spread(low[0], high[0], n_x, at_edges), _spread(low[1], high[1], n_y, at_edges)
    z, y, x = np.meshgrid(layers, y_m, x_m, indexing="ij")
    positions = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    jitter: FloatArray = generator.uniform(-parameters.jitter_m, parameters.jitter_m, positions.shape)
    return positions + jitter


def _spread(low: float, high: float, count: int, is_pair_at_edges: bool) -> FloatArray:
    """Spread `count` values from edge to edge, as the released code does; a single one in the middle.

    Two at the edges would both miss what is round.
    """
    if count > 2 or (count == 2 and is_pair_at_edges):
        return np.linspace(low, high, count)
    return low + (high - low) * (np.arange(count, dtype=np.float64) + 0.5) / count


def _imagine_drop(target: ObjectAtRest, parameters: Parameters) -> Drop:
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
        body_id = world.add_driven_body(target.body)
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
    footprint = Footprint.of(starts[retained, :2], float(target.aabb_m[1, 2])) if retained.any() else None
    return Drop(starts, retained, target.aabb_m, footprint, recorder.recording())
