"""Playing a pour in a worker: the candies settle in the standing cup, which is then driven along its path."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry import BoolArray, FloatArray, invert_pose, transform_points
from core.imagination.cup import inner_radius_m
from core.imagination.recording import Recorder, Recording
from core.parameters.bodies import CupParameters
from core.workers import Task, report_fraction
from hardware.simulation.pour_outcome.bodies import Bodies
from hardware.simulation.pour_outcome.candies import Candies
from hardware.simulation.pour_outcome.driven_path import CupMotion
from hardware.simulation.pour_outcome.settings import OutcomeSettings
from hardware.simulation.pour_outcome.table import Table, open_table

_CHECK_STEPS = 12
"""Steps between two checks whether all is over, and between two reports."""


@dataclass(frozen=True)
class PlayedPour:
    """What a worker hands back: the candies' final positions (N, 3), who is in the cup (N,), and the film."""

    positions_m: FloatArray
    in_cup: BoolArray
    recording: Recording


def pour_task(
    bodies: Bodies, candies: Candies, lying: Candies, motion: CupMotion, settings: OutcomeSettings
) -> Task:
    """Return the task whose result is the `PlayedPour` of the cup's candies and those lying in the object."""
    return Task(_play, (bodies, candies, lying, motion, settings))


def inside_cup(cup: CupParameters, T_base_cup: FloatArray, positions_m: FloatArray) -> BoolArray:
    """Return (N,) whether centres (N, 3) are within the cup's inner volume, the cup being at (4, 4)."""
    in_cup = transform_points(invert_pose(T_base_cup), positions_m)
    height = in_cup[:, 2]
    inside: BoolArray = (
        (height > 0)
        & (height < cup.length_m)
        & (np.hypot(in_cup[:, 0], in_cup[:, 1]) < inner_radius_m(cup, height))
    )
    return inside


def _play(
    bodies: Bodies, candies: Candies, lying: Candies, motion: CupMotion, settings: OutcomeSettings
) -> PlayedPour:
    with open_table(bodies, settings) as world:
        pour = _Pour(world, bodies.cup, motion, settings, len(candies.scales) + len(lying.scales))
        pour.settle(candies, lying)
        pour.follow()
        pour.wait()
        positions = world.poses()[:, :3]
        return PlayedPour(positions, pour.in_cup(positions), pour.recorder.recording())


class _Pour:
    """A pour as it goes on: the moment `self._at` of the motion, and the film so far."""

    def __init__(
        self,
        world: Table,
        cup: CupParameters,
        motion: CupMotion,
        settings: OutcomeSettings,
        n_candies: int,
    ) -> None:
        self._world = world
        self._cup = cup
        self._motion = motion
        self._settings = settings
        self._at = 0
        self._record_steps = max(round(settings.record_interval_s * settings.rate_hz), 1)
        self._rest_steps = round(settings.rest_s * settings.rate_hz)
        self.recorder = Recorder(n_candies)

    def settle(self, candies: Candies, lying: Candies) -> None:
        """Fill the standing cup and let the candies come to rest; others lie in the object."""
        self._world.add_candies(candies.moved(self._motion.T_base_cup[self._at]))
        self._world.add_candies(lying)
        for _ in range(round(self._settings.settle_s * self._settings.rate_hz)):
            self._drive(moving=False)
            self._world.step()

    def follow(self) -> None:
        """Drive the cup along its path; once nothing can move any more, only the cup's path is recorded."""
        last = len(self._motion.times_s) - 1
        is_over = False
        for step in range(last):
            self._at = step
            if step % self._record_steps == 0:
                self._record(0)
            if step % _CHECK_STEPS == 0:
                report_fraction(step / (last + self._rest_steps))
                is_over = is_over or (
                    self._is_at_rest() and not self.in_cup(self._world.poses()[:, :3]).any()
                )
            if not is_over:
                self._drive(moving=True)
                self._world.step()
        self._at = last

    def wait(self) -> None:
        """Wait until all candies are at rest, at most `rest_s`."""
        waited = 0
        while waited < self._rest_steps and not (waited % _CHECK_STEPS == 0 and self._is_at_rest()):
            if waited % self._record_steps == 0:
                self._record(waited)
            self._drive(moving=False)
            self._world.step()
            waited += 1
        self._record(waited)

    def in_cup(self, positions_m: FloatArray) -> BoolArray:
        """Whether centres (N, 3) are in the cup as it is now."""
        return inside_cup(self._cup, self._motion.T_base_cup[self._at], positions_m)

    def _is_at_rest(self) -> bool:
        speeds = np.linalg.norm(self._world.velocities_m_s(), axis=1)
        return bool(speeds.max() < self._settings.resting_m_s)

    def _drive(self, moving: bool) -> None:
        motion, at = self._motion, self._at
        self._world.drive_cup(
            motion.T_base_cup[at, :3, 3],
            motion.quaternions[at],
            motion.velocities_m_s[at] * moving,
            motion.angular_velocities_rad_s[at] * moving,
        )

    def _record(self, steps_after: int) -> None:
        time_s = self._motion.times_s[self._at] + steps_after / self._settings.rate_hz
        self.recorder.add(time_s, self._world.poses(), self._motion.T_base_cup[self._at])
