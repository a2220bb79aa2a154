"""Parameters of the holding strength: how far an object with candies in it may be tilted."""

from __future__ import annotations

from math import pi, radians

from core.parameters.fields import OURS, Group, quantity

N_TILT_DIRECTIONS = 8
"""Directions of tilt, i pi/4 from the footprint's principal axis, as those of the pours (Sec. III-B)."""


class HoldingParameters(Group):
    """Tilting the object until the candies leave."""

    n_load: int = quantity(
        24,
        "Candies poured onto the footprint before the tilt; what of them comes to rest inside is the load.",
        unit="",
        source=f"{OURS}: N_pour of Sec. IV-C",
        low=1,
        high=1000,
    )
    layer_spacing_m: float = quantity(
        0.01, "Distance of the layers they fall in.", unit="m", source=OURS, low=0.001, high=0.5
    )
    settle_s: float = quantity(1.5, "Longest time to come to rest.", unit="s", source=OURS, low=0.1, high=20)
    tilt_step_rad: float = quantity(
        radians(3), "Step of the tilt.", unit="rad", source=OURS, low=radians(0.5), high=radians(15)
    )
    tilt_max_rad: float = quantity(
        pi / 2, "Largest tilt.", unit="rad", source=OURS, low=radians(5), high=pi / 2
    )
    hold_s: float = quantity(
        0.25,
        "Longest time at each step; it ends as soon as the candies rest.",
        unit="s",
        source=OURS,
        low=0.05,
        high=10,
    )
    rest_m_s: float = quantity(
        0.05, "Candies slower than that rest.", unit="m/s", source=OURS, low=0.001, high=0.5
    )
