"""A simulated arm that is watched moves, where it would jump otherwise."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hardware.cell.settings import CellSettings

_SPEED_UP = 5.0
"""Whoever watches a simulated scan wants to see the arm move, but not for a minute."""


def animated(settings: CellSettings) -> CellSettings:
    """Return the same cell, with a simulated arm that moves where it would jump; its images are the same.

    As if time ran faster: speeds grow with the factor, accelerations with its square.
    """
    if not (settings.is_simulated and settings.simulation.is_instant):
        return settings
    robot, factor = settings.robot, _SPEED_UP
    faster = {
        "joint_speed_rad_s": factor * robot.joint_speed_rad_s,
        "joint_acceleration_rad_s2": factor**2 * robot.joint_acceleration_rad_s2,
    }
    return settings.model_copy(
        update={
            "robot": robot.model_copy(update=faster),
            "scan": settings.scan.model_copy(update={"settle_s": 0.0}),
            "simulation": settings.simulation.model_copy(update={"is_instant": False}),
        }
    )
