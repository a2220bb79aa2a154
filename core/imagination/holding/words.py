"""The holding strength in a sentence for people."""

from __future__ import annotations

from math import degrees, isinf

from core.imagination.holding.result import Holding


def holding_sentence(holding: Holding) -> str:
    """Return how far the object may be tilted, in the worst direction.

    For example: "Holds up to 24 degrees: then the first of 31 candies leaves; half are gone at 42 degrees."
    """
    n_load, noun = holding.n_load, "candy" if holding.n_load == 1 else "candies"
    if n_load == 0:
        return f"Holds nothing: of {holding.n_asked} candies poured onto it none stays."
    most = degrees(holding.tilt_rad[-1])
    if isinf(holding.first_rad):
        return f"Holds all of {n_load} {noun} up to {most:.0f} degrees, the largest tilt tried."
    before = holding.holds_rad
    if n_load == 1:
        return f"Holds up to {degrees(before):.0f} degrees: then the only candy leaves."
    begun = f"Holds up to {degrees(before):.0f} degrees: then the first of {n_load} {noun} leaves"
    if isinf(holding.half_rad):
        return f"{begun}; more than half stay up to {most:.0f} degrees."
    if holding.half_rad == holding.first_rad:
        return f"{begun}, and at once half of them."
    return f"{begun}; half are gone at {degrees(holding.half_rad):.0f} degrees."
