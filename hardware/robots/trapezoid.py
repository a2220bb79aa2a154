"""How far along a way something is that speeds up, goes on evenly, and slows down."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt


@dataclass(frozen=True)
class Trapezoid:
    """A way from rest to rest.

    Attributes:
        length: of the way, in any unit.
        speed: highest, in that unit per second.
        acceleration: of speeding up and of slowing down.
    """

    length: float
    speed: float
    acceleration: float

    @property
    def top_speed(self) -> float:
        """What is really reached: short ways end before the highest speed."""
        return min(self.speed, sqrt(self.length * self.acceleration))

    @property
    def duration_s(self) -> float:
        """From rest to rest."""
        return 0.0 if self.length <= 0 else self.length / self.top_speed + self.top_speed / self.acceleration

    def at(self, time_s: float) -> tuple[float, float]:
        """Return the position and the speed at a time after the start."""
        if time_s >= self.duration_s or self.length <= 0:
            return self.length, 0.0
        ramp_s = self.top_speed / self.acceleration
        if time_s < ramp_s:
            return self.acceleration * max(time_s, 0.0) ** 2 / 2, self.acceleration * max(time_s, 0.0)
        left_s = self.duration_s - time_s
        if left_s < ramp_s:
            return self.length - self.acceleration * left_s**2 / 2, self.acceleration * left_s
        return self.top_speed * (time_s - ramp_s / 2), self.top_speed
