"""Filling the cup, and simulating it alone once per packing (docs/decisions/0001)."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from math import floor

import numpy as np

from core.errors import StageError
from core.geometry import FloatArray, IntArray, invert_pose, transform_points
from core.imagination.body import BodyFile
from core.imagination.bullet_world import BulletWorld
from core.imagination.context import ImaginationContext
from core.imagination.cup import cup_pose, inner_radius_m, pour_angle, pour_duration_s
from core.imagination.particle_shape import particle_extents_m
from core.imagination.recording import Recorder, Recording
from core.imagination.rotations import quaternion_of
from core.imagination.set_up import SetUp, as_planned
from core.parameters import Parameters
from core.parameters.part import part_of
from core.workers import Task, report_fraction

STAGE = "pouring"
PACKING_WEIGHT = 4.0
_CUP_READS = (
    "seed",
    "particle",
    "solver",
    "pouring.n_pour",
    "pouring.gamma_0_rad",
    "pouring.settle_s",
    "pouring.turn_s",
    "pouring.wait_s",
    "pouring.cup",
    "pouring.contact",
    "evidence.record_interval_s",
)
_RELEASE_BELOW_M = 0.005
_SLOT_PITCHES = (1.15, 1.02)
"""Distance of neighbours at the start, relative to the particle, so that none overlap even when jittered; the
closer one where the candies find no room otherwise."""
_FREE_AT_MOUTH = 0.1
"""Share of the cup's length kept free at its mouth, so that nothing falls out before the turn."""
_REPORT_STEPS = 25
_ANYWHERE_M = np.array([[-1.0] * 3, [1.0] * 3])


@dataclass(frozen=True)
class CupRun:
    """One packing poured out of the cup alone, in the E-local frame (origin at the pivot, theta = 0).

    Attributes:
        release_steps: (N,) step at which the candy was 5 mm below the pivot; -1 if it never was.
        poses: (N, 7) position and quaternion at release.
        velocities: (N, 6) linear and angular velocity at release.
        recording: the candies until their release, and the cup.
    """

    release_steps: IntArray
    poses: FloatArray
    velocities: FloatArray
    recording: Recording


class CupRuns:
    """Runs of the cup alone, made when first asked for: they know no object, so objects can share them."""

    def __init__(self) -> None:
        self._known: dict[tuple[str, int, float], CupRun] = {}

    def of(self, context: ImaginationContext, set_ups: Sequence[SetUp]) -> list[CupRun]:
        """Return the run of each set-up.

        Raises:
            StageError: the cup cannot hold N_pour.
        """
        settings = _settings_key(context.parameters)
        missing = [one for one in set_ups if self._key(settings, one) not in self._known]
        if missing:
            tasks = [self._task(context, one) for one in missing]
            for one, run in zip(missing, context.run(tasks, STAGE), strict=True):
                self._known[self._key(settings, one)] = run
        return [self._known[self._key(settings, one)] for one in set_ups]

    def of_packings(self, context: ImaginationContext) -> list[CupRun]:
        """Return the runs that the pours need: none if cup and object are simulated together."""
        return self.of(context, _planned(context.parameters))

    def prepare(self, context: ImaginationContext) -> None:
        """Let the next imagination fill idle processors with the runs of `of_packings`."""
        settings = _settings_key(context.parameters)

        def keep(one: SetUp, run: CupRun) -> None:
            self._known[self._key(settings, one)] = run

        for one in _planned(context.parameters):
            if self._key(settings, one) not in self._known:
                context.spare.append((self._task(context, one), partial(keep, one)))

    @staticmethod
    def _key(settings: str, one: SetUp) -> tuple[str, int, float]:
        return settings, one.packing, one.candy_scale

    @staticmethod
    def _task(context: ImaginationContext, one: SetUp) -> Task:
        return packing_task(context.cup(), one.parameters(context.parameters), one.packing)


def _planned(parameters: Parameters) -> list[SetUp]:
    n_packings = parameters.pouring.n_packings if parameters.pouring.mode == "replay" else 0
    return [as_planned(packing) for packing in range(n_packings)]


def _settings_key(parameters: Parameters) -> str:
    """What a run depends on, besides its set-up."""
    part = part_of(parameters, _CUP_READS)
    return json.dumps(part.model_dump(mode="json"), sort_keys=True)


def packing_task(cup_body: BodyFile, parameters: Parameters, packing: int) -> Task:
    """Return the task whose result is the `CupRun` of one packing."""
    return Task(_run_cup, (cup_body, parameters, packing), PACKING_WEIGHT)


def pack_cup(parameters: Parameters, packing: int) -> FloatArray:
    """Return (N_pour, 3) starting positions in the lying cup, E-local frame; they differ with `packing`.

    Raises:
        StageError: the cup cannot hold N_pour candies.
    """
    n_pour = parameters.pouring.n_pour
    pitch, slots = require_room(parameters)
    generator = np.random.default_rng([parameters.seed, 1, packing])
    # From the middle of the cup, as in the released code: the candies fall and come to rest as they may.
    from_middle = np.abs(slots[:, 0] - parameters.pouring.cup.length_m / 2)
    central = slots[np.argsort(from_middle, kind="stable")][: max(n_pour, len(slots) // 2)]
    chosen = central[generator.permutation(len(central))[:n_pour]]
    shift = 0.4 * (pitch - 1) * particle_extents_m(parameters.particle)
    packed: FloatArray = chosen + generator.uniform(-shift, shift, chosen.shape)
    return packed


def require_room(parameters: Parameters) -> tuple[float, FloatArray]:
    """Return the pitch and the places (n, 3) in the cup, of which there are at least N_pour.

    Raises:
        StageError: the cup cannot hold N_pour candies.
    """
    n_pour = parameters.pouring.n_pour
    pitch, slots = _widest(parameters)
    if len(slots) < n_pour:
        raise StageError(
            f"The cup cannot hold {n_pour} candies: lying as it does before a pour it has room for "
            f"{len(slots)}; lower pouring.n_pour or enlarge the cup (pouring.cup)."
        )
    return pitch, slots


def cup_holds(parameters: Parameters) -> bool:
    """Return whether the cup has room for N_pour candies, lying as it does before a pour."""
    return len(_widest(parameters)[1]) >= parameters.pouring.n_pour


def _widest(parameters: Parameters) -> tuple[float, FloatArray]:
    """The largest pitch with enough slots, and these; the closest one if none has."""
    for pitch in _SLOT_PITCHES:
        slots = _slots(parameters, pitch)
        if len(slots) >= parameters.pouring.n_pour:
            break
    return pitch, slots


def _slots(parameters: Parameters, slot_pitch: float) -> FloatArray:
    """All places (n, 3) of a grid, E-local frame, at which a flat candy lies wholly inside the cup."""
    cup = parameters.pouring.cup
    extents = particle_extents_m(parameters.particle)
    pitch = slot_pitch * extents
    reach = cup.length_m, 2 * cup.mouth_radius_m, 2 * cup.mouth_radius_m
    counts = [floor(length / step) for length, step in zip(reach, pitch, strict=True)]
    middles = cup.length_m / 2, 0.0, cup.mouth_radius_m - cup.wall_m - cup.pivot_lift_m
    axes = [
        middle + step * (np.arange(count) - (count - 1) / 2)
        for middle, step, count in zip(middles, pitch, counts, strict=True)
    ]
    x, y, z = np.meshgrid(*axes, indexing="ij")
    slots = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    T_cup_E = invert_pose(cup_pose(cup, np.zeros(3), 0.0, 0.0))
    # A candy fits when the corners of its box, grown to the pitch, lie inside the cone.
    corners = np.array(list(product((-0.5, 0.5), repeat=3))) * pitch
    in_cup = transform_points(T_cup_E, slots[:, None, :] + corners)
    height, radius = in_cup[..., 2], np.hypot(in_cup[..., 0], in_cup[..., 1])
    inside = (
        (radius < inner_radius_m(cup, height))
        & (height > cup.wall_m)
        & (height < (1 - _FREE_AT_MOUTH) * cup.length_m)
    )
    fits = inside.all(axis=1)
    fitting: FloatArray = slots[fits]
    return fitting


def _run_cup(cup_body: BodyFile, parameters: Parameters, packing: int) -> CupRun:
    pouring, rate_hz = parameters.pouring, parameters.solver.rate_hz
    n_pour = pouring.n_pour
    steps = round(pour_duration_s(pouring) * rate_hz)
    record_steps = max(round(parameters.evidence.record_interval_s * rate_hz), 1)
    release_steps = np.full(n_pour, -1)
    poses, velocities = np.zeros((n_pour, 7)), np.zeros((n_pour, 6))
    recorder = Recorder(n_pour)
    with BulletWorld(parameters.solver, parameters.particle, pouring.contact, _ANYWHERE_M) as world:
        cup = PouringCup(world, cup_body, parameters, np.zeros(3), 0.0)
        for start in pack_cup(parameters, packing):
            world.add_particle(np.array([*start, 0, 0, 0, 1]))
        for step in range(steps):
            T_world_cup = cup.move(step / rate_hz)
            if step % record_steps == 0:
                recorder.add(step / rate_hz, world.poses(), T_world_cup)
            if step % _REPORT_STEPS == 0:
                report_fraction(step / steps)
            world.step()
            for index in np.flatnonzero(release_steps < 0).tolist():
                if world.height_m(index) < -_RELEASE_BELOW_M:
                    release_steps[index] = step + 1
                    poses[index], velocities[index] = world.pose_and_velocity(index)
                    world.remove_particle(index)
        recorder.add(steps / rate_hz, world.poses(), cup.move(steps / rate_hz))
    return CupRun(release_steps, poses, velocities, recorder.recording())


class PouringCup:
    """The cup as a kinematic body that pours about a pivot (3,) in direction theta."""

    def __init__(
        self,
        world: BulletWorld,
        body: BodyFile,
        parameters: Parameters,
        pivot_m: FloatArray,
        theta_rad: float,
    ) -> None:
        """Add the cup to `world`."""
        self._world = world
        self._pouring = parameters.pouring
        self._pivot_m = pivot_m
        self._theta_rad = theta_rad
        self._axis = np.array([np.sin(theta_rad), -np.cos(theta_rad), 0.0])
        self._body_id = world.add_driven_body(body)

    def move(self, time_s: float) -> FloatArray:
        """Place the cup as it is at `time_s` and return `T_world_cup`."""
        gamma, rate = pour_angle(self._pouring, time_s)
        pose = cup_pose(self._pouring.cup, self._pivot_m, self._theta_rad, gamma)
        angular = rate * self._axis
        self._world.drive(
            self._body_id,
            pose[:3, 3],
            quaternion_of(pose[:3, :3]),
            np.cross(angular, pose[:3, 3] - self._pivot_m),
            angular,
        )
        return pose
