"""One imagined filling: candies rain in until they run over, then the object is perturbed (Sec. III-A)."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np

from core.geometry import BoolArray, FloatArray, invert_pose, transform_points
from core.imagination.bullet_world import BulletWorld
from core.imagination.capacity.basin import Basin
from core.imagination.capacity.stand_in import StandIn
from core.imagination.object_at_rest import ObjectAtRest, inside_aabb
from core.imagination.particle_shape import particle_extents_m, shape_of
from core.imagination.perturbation import Perturbation, move_object
from core.imagination.recording import Recorder, Recording
from core.parameters import Parameters
from core.workers import Task, report_fraction

FILLING_WEIGHT = 20.0
"""Time of a filling compared with one pour, for the progress shown."""
_FAST_SHARE = 0.85
"""Share of the candies expected that rain fast; the others wait for those before them."""
_WINDOW_SHARE, _WINDOW_LEAST = 0.12, 12
"""Candies over which it is seen whether they still add up, as a share of those expected."""
_MOST_SHARE, _MOST_MORE = 2.0, 40
"""Most candies poured, against those expected."""
_STREAM = 7
"""Of random numbers, apart from those of the drop and the pours."""
_SETTLE_S = 0.4
_REPORT_STEPS = 25


@dataclass(frozen=True)
class Filling:
    """What became of one filling.

    Attributes:
        n_poured: particles that rained.
        n_full: inside the object's AABB when they ran over. A candy is inside with its centre; a ball that
            stands for several counts with its share below the AABB's top.
        n_kept: inside it after the perturbations.
        n_level_full: of those when they ran over, below the rim.
        n_level: of those kept, below the rim.
        n_below: particles that left through a place lower than the rim.
        recording: to look at.
    """

    n_poured: int
    n_full: float
    n_kept: float
    n_level_full: float
    n_level: float
    n_below: int
    recording: Recording


@dataclass(frozen=True)
class FillPlan:
    """What is filled in, and how it is counted.

    Attributes:
        stand_in: what rains.
        places_m: (n, 2) above which it may: the footprint.
        n_expected: how many may fit.
        basin: what the object holds by geometry.
        only_level: what is above the rim is held only because the stand-ins are large, and does not count.
        runs_over: whether it rains until nothing more fits, not just as many as are expected.
    """

    stand_in: StandIn
    places_m: FloatArray
    n_expected: float
    basin: Basin
    only_level: bool = False
    runs_over: bool = True


def filling_task(target: ObjectAtRest, plan: FillPlan, filling: int, parameters: Parameters) -> Task:
    """Return the task whose result is the `Filling` numbered `filling`; each has another rain."""
    return Task(_fill, (target, plan, filling, parameters), FILLING_WEIGHT)


def _fill(target: ObjectAtRest, plan: FillPlan, filling: int, parameters: Parameters) -> Filling:
    generator = np.random.default_rng([parameters.seed, _STREAM, filling])
    perturbation = Perturbation(parameters.containability, target.center_of_mass_m)
    reach_m = perturbation.reach_m(target.aabb_m)
    with BulletWorld(plan.stand_in.solver, plan.stand_in.particle, plan.stand_in.contact, reach_m) as world:
        played = _Play(world, target, perturbation, plan, parameters)
        speed_m_s = parameters.capacity.rain_m_s
        rain = Rain(world, float(target.aabb_m[1, 2]), plan.stand_in, plan.places_m, generator, speed_m_s)
        played.rain(rain)
        played.settle()
        n_full = played.n_inside()
        level_full = _level(world.poses()[:, :3], target.aabb_m, plan)
        played.perturb()
        positions = world.poses()[:, :3]
    kept, level = _inside(positions, target.aabb_m, plan), _level(positions, target.aabb_m, plan)
    below = played.left_below(plan.basin.rim_m - plan.stand_in.particle.diameter_m) & (kept == 0)
    return Filling(
        n_poured=len(positions),
        n_full=n_full,
        n_kept=float(kept.sum()),
        n_level_full=float(level_full.sum()),
        n_level=float(level.sum()),
        n_below=int(below.sum()),
        recording=played.recording(),
    )


def _inside(positions_m: FloatArray, aabb_m: FloatArray, plan: FillPlan) -> FloatArray:
    """Return (n,) how much of each particle at (n, 3) counts as inside, 0 to 1."""
    if plan.only_level:
        return _level(positions_m, aabb_m, plan)
    return _below(positions_m, np.full(len(positions_m), aabb_m[1, 2]), aabb_m, plan)


def _level(positions_m: FloatArray, aabb_m: FloatArray, plan: FillPlan) -> FloatArray:
    """The same below the rim that is there."""
    rims_m = np.minimum(plan.basin.hollow_map.rim_at(positions_m[:, :2]), aabb_m[1, 2])
    return _below(positions_m, rims_m, aabb_m, plan)


def _below(positions_m: FloatArray, tops_m: FloatArray, aabb_m: FloatArray, plan: FillPlan) -> FloatArray:
    heights_m = tops_m - positions_m[:, 2]
    heights_m[np.isnan(heights_m)] = -np.inf  # taken out
    if shape_of(plan.stand_in.particle).fills_as_ball:
        high = (heights_m / plan.stand_in.particle.diameter_m + 0.5).clip(0, 1)
        share = high**2 * (3 - 2 * high)  # of a ball below a plane
    else:
        share = (heights_m > 0).astype(float)
    roomy_m = np.array([aabb_m[0], [*aabb_m[1, :2], np.inf]])
    below: FloatArray = np.where(inside_aabb(positions_m, roomy_m), share, 0.0)
    return below


class _Play:
    """Steps the world, moves the object, and remembers where particles were last seen in its box."""

    def __init__(
        self,
        world: BulletWorld,
        target: ObjectAtRest,
        perturbation: Perturbation,
        plan: FillPlan,
        parameters: Parameters,
    ) -> None:
        settings = parameters.containability
        self._world, self._target, self._perturbation = world, target, perturbation
        self._plan, self._rate_hz = plan, plan.stand_in.solver.rate_hz
        self._rest_s = settings.drop_s  # the perturbation's own clock starts with a drop
        self._record_steps = max(round(parameters.evidence.record_interval_s * self._rate_hz), 1)
        self._body_id = world.add_driven_body(target.body)
        self._step = 0
        self._frames: list[tuple[float, FloatArray, FloatArray]] = []
        self._last_m = np.empty(0)

    def rain(self, rain: Rain) -> None:
        """Rain until it runs over, or as much as is planned."""
        n_expected = self._plan.n_expected
        window = max(_WINDOW_SHARE * n_expected, _WINDOW_LEAST)
        most = _MOST_SHARE * n_expected + _MOST_MORE if self._plan.runs_over else n_expected
        seen: list[tuple[int, float]] = []  # particles poured and inside, at each slow handful
        next_step = 0
        while True:
            if self._step >= next_step:
                poured = len(self._world.particle_ids)
                is_slow = poured >= _FAST_SHARE * n_expected
                if is_slow:
                    seen.append((poured, self.n_inside()))
                    if poured >= most or overflows(seen, window):
                        return
                rain.handful()
                next_step = self._step + (rain.slow_steps if is_slow else rain.fast_steps)
            self._advance(0.0)

    def n_inside(self) -> float:
        """How many particles count as inside."""
        return float(_inside(self._world.poses()[:, :3], self._target.aabb_m, self._plan).sum())

    def settle(self) -> None:
        """Wait until nothing rolls any more."""
        for step in range(round(_SETTLE_S * self._rate_hz)):
            self._advance(0.0)
            if step % 10 == 0 and self._world.is_at_rest():
                return

    def perturb(self) -> None:
        """Turn and push."""
        steps = round((self._perturbation.duration_s - self._rest_s) * self._rate_hz)
        for step in range(steps):
            if step % _REPORT_STEPS == 0:
                report_fraction(step / steps)
            self._advance(step / self._rate_hz)
        self._look(np.eye(4))

    def left_below(self, height_m: float) -> BoolArray:
        """Return (n,) which particles were last seen in the object's box at less than a height."""
        below: BoolArray = self._last_m < height_m
        return below

    def recording(self) -> Recording:
        """Return all that was seen; particles that had not rained yet are absent."""
        n = len(self._world.particle_ids)
        recorder = Recorder(n)
        for time_s, poses, T_world_object in self._frames:
            absent = np.full((n - len(poses), 7), np.nan)
            recorder.add(time_s, np.vstack([poses, absent]), T_world_object)
        return recorder.recording()

    def _advance(self, since_s: float) -> None:
        motion = self._perturbation.at(self._rest_s + since_s)
        if self._step % self._record_steps == 0:
            self._look(motion.T_world_object)
        move_object(self._world, self._body_id, motion, self._target.center_of_mass_m)
        self._world.step()
        self._step += 1

    def _look(self, T_world_object: FloatArray) -> None:
        poses = self._world.poses()
        self._frames.append((self._step / self._rate_hz, poses, T_world_object))
        in_object = transform_points(invert_pose(T_world_object), poses[:, :3])
        new = np.full(len(poses) - len(self._last_m), np.inf)
        self._last_m = np.concatenate([self._last_m, new])
        inside = inside_aabb(in_object, self._target.aabb_m)
        self._last_m[inside] = in_object[inside, 2]


_APART = 1.05
"""Distance of neighbours in a handful, in diameters."""
_MOST_TRIED = 300
"""Places tried for one handful; finely spaced ones differ little."""
_FOLLOWS = 1.3
"""Distance of two handfuls when they rain fast, in heights of a candy."""
_SLOW_S = 0.1
"""Time between two handfuls when they rain slowly; it grows with the root of the candies' size."""
_RUNS_OVER = 0.4
"""It runs over when less than this share of the last candies adds up."""


class Rain:
    """Lets handfuls go above the footprint, no two particles touching."""

    def __init__(
        self,
        world: BulletWorld,
        top_m: float,
        stand_in: StandIn,
        places_m: FloatArray,
        generator: np.random.Generator,
        speed_m_s: float,
    ) -> None:
        extents_m = particle_extents_m(stand_in.particle)
        self._world, self._places_m, self._generator = world, places_m, generator
        self._apart_m = _APART * float(extents_m[0])
        self._height_m = top_m + float(extents_m[0])
        self._velocity = np.array([0.0, 0.0, -speed_m_s, 0.0, 0.0, 0.0])
        rate_hz = stand_in.solver.rate_hz
        self.fast_steps = ceil(_FOLLOWS * float(extents_m[2]) / speed_m_s * rate_hz)
        self.slow_steps = max(self.fast_steps, ceil(_SLOW_S * sqrt(stand_in.scale) * rate_hz))

    def handful(self) -> None:
        """Let go one layer."""
        chosen = np.empty((0, 2))
        for place in self._places_m[self._generator.permutation(len(self._places_m))[:_MOST_TRIED]]:
            if (np.hypot(*(chosen - place).T) >= self._apart_m).all():
                chosen = np.vstack([chosen, place])
        for x, y in chosen.tolist():
            self._world.add_particle(np.array([x, y, self._height_m, 0, 0, 0, 1]), self._velocity)


def overflows(seen: list[tuple[int, float]], window: float) -> bool:
    """Whether the last `window` candies hardly added up, given how many rained and how many were inside."""
    poured, inside = seen[-1]
    before = [entry for entry in seen if entry[0] <= poured - window]
    return bool(before) and inside - before[-1][1] < _RUNS_OVER * (poured - before[-1][0])


_LEAST = 4
"""Fewer clear places than this, and the widest are taken whether they are clear or not."""


def rain_places(basin: Basin, footprint_m: FloatArray, radius_m: float, apart_m: float) -> FloatArray:
    """Return (n, 2) places above a hollow and near the footprint, where a particle falls clear of the rim.

    What falls onto the rim, or onto the shoulder of a bottle, bounces off and would look as if the object had
    run over. Without an open hollow it rains on the footprint as it is.

    Args:
        basin: what the object holds by geometry.
        footprint_m: (m, 2) places from which candies stayed.
        radius_m: of what rains.
        apart_m: distance of neighbours in the drop's grid.
    """
    from scipy.spatial import cKDTree

    seen = basin.hollow_map
    cells = np.argwhere(seen.is_open)
    if not len(cells):
        return footprint_m
    places = seen.origin_m + seen.pitch_m * cells
    away_m, _ = cKDTree(footprint_m).query(places)
    near: BoolArray = np.asarray(away_m) <= apart_m
    if not near.any():
        return footprint_m
    places, room_m = places[near], seen.room_m[seen.is_open][near]
    enough_m = min(radius_m, float(np.sort(room_m)[-min(_LEAST, len(room_m))]))
    clear: FloatArray = places[room_m >= enough_m]
    return clear
