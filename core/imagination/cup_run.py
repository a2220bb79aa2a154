"""The cup simulated alone, pouring one packing (docs/decisions/0001)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray, IntArray
from core.imagination.body import BodyFile
from core.imagination.bullet_world import BulletWorld
from core.imagination.cup import cup_pose, pour_angle, pour_duration_s
from core.imagination.packing import pack_cup
from core.imagination.recording import Recorder, Recording
from core.imagination.rotations import quaternion_of
from core.parameters import Parameters
from core.workers import Task, report_fraction

PACKING_WEIGHT = 4.0
_RELEASE_BELOW_M = 0.005
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


def packing_task(cup_body: BodyFile, parameters: Parameters, packing: int) -> Task:
    """Return the task whose result is the `CupRun` of one packing."""
    return Task(_run_cup, (cup_body, parameters, packing), PACKING_WEIGHT)


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
