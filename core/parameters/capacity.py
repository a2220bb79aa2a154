"""Parameters of the imagined filling."""

from __future__ import annotations

from core.parameters.fields import OURS, Group, quantity


class CapacityParameters(Group):
    """Filling the object until candies run over."""

    n_fillings: int = quantity(
        2, "Independent fillings, of which the mean is taken.", unit="", source=OURS, low=1, high=20
    )
    n_aimed: int = quantity(
        64,
        "Balls that a filling aims at: what holds more is filled with larger ones.",
        unit="",
        source=OURS,
        low=20,
        high=5000,
    )
    n_real: int = quantity(
        30,
        "Up to so many expected candies it is filled with candies; with balls of their volume above.",
        unit="",
        source=OURS,
        low=0,
        high=5000,
    )
    widths_in_mouth: float = quantity(
        2.5,
        "Larger candies are at most as large that so many lie side by side in the mouth.",
        unit="",
        source=OURS,
        low=1,
        high=20,
    )
    rain_m_s: float = quantity(
        0.4, "Speed of the candies where they are let go.", unit="m/s", source=OURS, low=0.05, high=2
    )
    lattice_points: int = quantity(
        500_000,
        "Points of the lattice on which the geometric volume is found.",
        unit="",
        source=OURS,
        low=10_000,
        high=50_000_000,
    )
