"""What judges, written for people."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication

from core.evaluation.trials import Measure


def measure_title(measure: Measure) -> str:
    """Return a measure as it stands by itself."""
    if measure == "Omega":
        return QCoreApplication.translate("Measure", "Omega")
    return QCoreApplication.translate("Measure", "Capacity share")


def measure_noun(measure: Measure) -> str:
    """Return a measure as it stands within a sentence."""
    if measure == "Omega":
        return QCoreApplication.translate("Measure", "Omega")
    return QCoreApplication.translate("Measure", "capacity share")


def measure_meaning(measure: Measure) -> str:
    """Say what a measure is."""
    if measure == "Omega":
        return QCoreApplication.translate("Measure", "Omega: share of candies that stayed.")
    return QCoreApplication.translate(
        "Measure", "Capacity share: how much of its convex hull is room that holds candies."
    )
