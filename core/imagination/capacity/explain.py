"""Why the imagined and the geometric volume differ, from what was counted and measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

AGREE_SHARE = 0.15
"""Volumes that differ by less need no explanation."""
_COUNTS = 0.25
"""A reason is named when it accounts for at least this share of the difference."""
_NARROW_MOUTH = 2.0


@dataclass(frozen=True)
class Facts:
    """What is known of a filling, volumes in ml, lengths in m.

    Attributes:
        imagined_ml: bulk volume of the candies that stay.
        heaped_ml: bulk volume of the candies above the rim.
        water_ml: geometric volume.
        hollow_ml: geometric volume for what is as thick as a candy.
        narrow_ml: water where no candy goes.
        shaken_off_ml: bulk volume of what the perturbations took from below the rim.
        left_below: share of the candies lost that left lower than the rim.
        water_level_m: above the object's lowest point, where water runs out of the largest hollow; NaN.
        rim_m: the same for candies; NaN.
        mouth_m: width of the mouth.
        candy_m: diameter of a candy.
    """

    imagined_ml: float
    heaped_ml: float
    water_ml: float
    hollow_ml: float
    narrow_ml: float
    shaken_off_ml: float
    left_below: float
    water_level_m: float
    rim_m: float
    mouth_m: float
    candy_m: float


def explain(facts: Facts) -> str:
    """Return sentences on the difference; empty when the volumes agree and hardly anything is heaped."""
    heap = ""
    if facts.heaped_ml > AGREE_SHARE * max(facts.imagined_ml, facts.water_ml):
        where = "where nothing is closed all around" if np.isnan(facts.rim_m) else "above the rim"
        heap = f"Candies for {facts.heaped_ml:.0f} ml lie heaped {where}."
    return " ".join(sentence for sentence in (_difference(facts), heap) if sentence)


def _difference(facts: Facts) -> str:
    more = facts.imagined_ml - facts.water_ml
    if abs(more) <= AGREE_SHARE * max(facts.imagined_ml, facts.water_ml):
        return ""
    reasons = _of_more(facts, more) if more > 0 else _of_less(facts, -more)
    said = f"The candies stand for {facts.imagined_ml:.0f} ml, water would be {facts.water_ml:.0f} ml: "
    return said + ("; ".join(reasons) or "neither gaps nor the shaking account for it") + "."


def _of_more(facts: Facts, more: float) -> list[str]:
    reasons = []
    if facts.hollow_ml - facts.water_ml >= _COUNTS * more:
        reasons.append(_gap(facts))
    return reasons


def _gap(facts: Facts) -> str:
    closed = f"where candies are held up to {1000 * facts.rim_m:.0f} mm"
    if np.isnan(facts.water_level_m):
        return f"water runs out at the bottom through a gap that candies do not pass, {closed}"
    height = f"{1000 * facts.water_level_m:.0f} mm above the foot"
    return f"water runs out {height} through a gap that candies do not pass, {closed}"


def _of_less(facts: Facts, less: float) -> list[str]:
    if facts.imagined_ml == 0:
        return [
            "none of the candies that stay lies where water would"
            if facts.heaped_ml > 0
            else "no candy stays"
        ]
    reasons = []
    if facts.narrow_ml >= _COUNTS * less:
        reasons.append(f"{facts.narrow_ml:.0f} ml of water stand in hollows too narrow for a candy")
    if facts.shaken_off_ml >= _COUNTS * less:
        reasons.append(f"tilting and pushing take off candies for {facts.shaken_off_ml:.0f} ml")
    if facts.left_below >= _COUNTS:
        reasons.append(f"{100 * facts.left_below:.0f} % of the candies lost left lower than the rim")
    if 0 < facts.mouth_m < _NARROW_MOUTH * facts.candy_m:
        reasons.append(f"the mouth is {1000 * facts.mouth_m:.0f} mm wide, less than two candies")
    return reasons
