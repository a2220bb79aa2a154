"""The candies that lie in the object before it is tilted."""

from __future__ import annotations

import numpy as np

from core.geometry import FloatArray
from core.imagination.bullet_world import BulletWorld
from core.imagination.containability import ObjectAtRest, has_room_above
from core.imagination.drop_grid import pitch_m
from core.imagination.holding.watching import LOOK_STEPS, keep_inside
from core.imagination.results import Containability
from core.parameters import Parameters
from core.parameters.holding import HoldingParameters
from core.workers import Task, report_fraction

_SEED_STREAM = 2
"""The drop and the packings draw from streams 0 and 1 of the seed."""
_ROUNDS = 3
"""What missed the object is poured again: twice."""
_FALL_S = 0.2
"""Until then a candy may be slow because it has only begun to fall."""


def load_task(
    target: ObjectAtRest, found: Containability, parameters: Parameters, settings: HoldingParameters
) -> Task:
    """Return the task whose result is the load: poses (n, 7) of the candies at rest inside the object.

    The load is a fixed number, the same for each object where it fits, and not what stayed in the drop: that
    grows with the object's width, and a bowl which is full loses candies at the first degree. It is poured
    anew, because few candies taken out of many would no longer lie as the many held them. What falls off is
    replaced twice, so that a miss is no fault of the object; what still does not fit is no part of the load.
    Which candies lie inside is decided at rest as in the drop (`containability.counted`): one that fills a
    hollow to the brim is taken out. Afterwards, against a tilted wall, a candy is in while its centre is.
    """
    return Task(_pour_load, (target, found, parameters, settings), 2.0)


def load_starts(found: Containability, parameters: Parameters, settings: HoldingParameters) -> FloatArray:
    """Return (n_load, 3) where they fall from: in layers above the middle of the footprint.

    Raises:
        ValueError: no candy stayed in the drop.
    """
    if found.footprint is None:
        raise ValueError("no candy stayed: there is no footprint to pour onto")
    apart_m = float(pitch_m(parameters.particle, parameters.containability)[0]) / 2
    places = _distinct(found.drop_positions_m[found.retained, :2], apart_m)
    # As a pour does: what falls near the rim of a bowl slides through it and out on the other side.
    from_middle = np.linalg.norm(places - found.footprint.center_m[:2], axis=1)
    places = places[np.argsort(from_middle, kind="stable")][: -(-len(places) // 2)]
    generator = np.random.default_rng([parameters.seed, _SEED_STREAM])
    n_layers = -(-settings.n_load // len(places))
    order = np.concatenate([generator.permutation(len(places)) for _ in range(n_layers)])[: settings.n_load]
    layers = np.arange(settings.n_load) // len(places)
    bottom_m = found.aabb_m[1, 2] + parameters.containability.layer_height_m
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


def _pour_load(
    target: ObjectAtRest, found: Containability, parameters: Parameters, settings: HoldingParameters
) -> FloatArray:
    contact = parameters.containability.contact
    starts = load_starts(found, parameters, settings)
    with BulletWorld(parameters.solver, parameters.particle, contact, target.aabb_m) as world:
        world.add_fixed_body(target.body, contact.restitution)
        n_inside = 0
        for round_ in range(_ROUNDS):
            report_fraction(round_ / _ROUNDS)
            for start in starts[: settings.n_load - n_inside]:
                world.add_particle(np.array([*start, 0, 0, 0, 1]))
            _settle(world, parameters, settings)
            n_inside = keep_inside(world, target.aabb_m)
            if n_inside == settings.n_load:
                break
        poses = world.poses()
    load = poses[np.isfinite(poses[:, 0])]
    if parameters.containability.counted == "room_above":
        load = load[has_room_above(load, target.aabb_m, parameters.particle)]
    return load


def _settle(world: BulletWorld, parameters: Parameters, settings: HoldingParameters) -> None:
    rate_hz = parameters.solver.rate_hz
    for step in range(1, round(settings.settle_s * rate_hz) + 1):
        world.step()
        falling = step < _FALL_S * rate_hz
        if not falling and step % LOOK_STEPS == 0 and world.top_speed_m_s() < settings.rest_m_s:
            return
