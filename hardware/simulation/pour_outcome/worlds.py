"""The ground-truth worlds: three tables with nothing in common with the imagination, nor with each other.

Nothing is fitted to a world that judges: pours are tuned in the first one at most, and judged in all.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import radians
from typing import Any

from core.errors import InputError
from core.formats import excerpt
from core.parameters.settings import apply_settings
from hardware.simulation.pour_outcome.settings import OutcomeSettings

WORLDS: dict[str, OutcomeSettings] = {
    "bullet": OutcomeSettings(),
    "mujoco": OutcomeSettings(
        engine="mujoco",
        candy_diameter_m=0.0128,
        candy_height_m=0.0071,
        candy_mass_kg=0.00087,
        size_spread=0.03,
        candy_friction=0.3,
        cup_friction=0.24,
        object_friction=0.36,
        table_friction=0.45,
        rolling_arm_m=0.0002,
        candy_restitution=0.35,
        wall_restitution=0.45,
        object_error_m=0.0018,
        object_error_rad=radians(0.6),
        cup_slip_m=0.0015,
        cup_slip_rad=radians(0.4),
        iterations=50,
    ),
    "peanuts": OutcomeSettings(
        engine="mujoco",
        candy_diameter_m=0.0124,
        candy_height_m=0.0092,
        candy_mass_kg=0.001,
        size_spread=0.04,
        candy_friction=0.25,
        cup_friction=0.18,
        object_friction=0.26,
        table_friction=0.3,
        rolling_arm_m=0.0004,
        candy_restitution=0.55,
        wall_restitution=0.6,
        object_error_m=0.0012,
        object_error_rad=radians(1.0),
        cup_slip_m=0.0008,
        cup_slip_rad=radians(0.9),
        iterations=50,
    ),
}
"""By name: lentils in Bullet, lentils in MuJoCo, and in MuJoCo rounder ones that bounce more."""


def worlds_with(names: Sequence[str], changes: Mapping[str, Any]) -> dict[str, OutcomeSettings]:
    """Return worlds by name, each with the same settings changed.

    Raises:
        InputError: there is no such world or setting, or a value is not possible.
    """
    unknown = next((name for name in names if name not in WORLDS), None)
    if unknown is not None:
        known = ", ".join(WORLDS)
        raise InputError(f"There is no ground-truth world '{excerpt(unknown)}'; there are {known}.")
    return {name: apply_settings(WORLDS[name], changes) for name in names}
