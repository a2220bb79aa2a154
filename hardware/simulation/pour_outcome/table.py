"""The table of the engine that the settings ask for."""

from __future__ import annotations

from typing import Protocol, Self

from core.geometry import FloatArray
from hardware.simulation.pour_outcome.bodies import Bodies
from hardware.simulation.pour_outcome.candies import Candies
from hardware.simulation.pour_outcome.settings import OutcomeSettings


class Table(Protocol):
    """Object, platform and table at rest, the driven cup, and the candies; used as a context manager."""

    def __enter__(self) -> Self: ...
    def __exit__(self, *exception: object) -> None: ...

    def add_candies(self, candies: Candies) -> None:
        """Put candies where they are in the base frame; all of them before the first step."""

    def drive_cup(
        self,
        position_m: FloatArray,
        quaternion: FloatArray,
        velocity_m_s: FloatArray,
        angular_velocity_rad_s: FloatArray,
    ) -> None:
        """Place the cup (3,), (4,) for the next step, with the velocities (3,), (3,) that take it on."""

    def step(self) -> None:
        """Advance by one step of 1 / `rate_hz`."""

    def poses(self) -> FloatArray:
        """Return (N, 7) positions and quaternions (x, y, z, w) of the candies."""

    def velocities_m_s(self) -> FloatArray:
        """Return (N, 3) velocities of the candies' centres."""


def open_table(bodies: Bodies, settings: OutcomeSettings) -> Table:
    """Return a table without candies.

    Raises:
        WorkerError: Bullet gave no server.
    """
    if settings.engine == "mujoco":
        from hardware.simulation.pour_outcome.mujoco_table import MujocoTable

        return MujocoTable(bodies, settings)
    from hardware.simulation.pour_outcome.bullet_table import BulletTable

    return BulletTable(bodies, settings)
