"""The numbers of a report as rows of text."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees
from typing import TYPE_CHECKING, Any

import numpy as np

from core.imagination.capacity.result import Capacity
from core.imagination.holding.result import Holding
from core.imagination.results import PourChoice, PourGrid
from core.imagination.risk.results import PourRisk
from core.mesh import TriangleMesh
from core.mesh_topology import topology
from core.parameters import Parameters, describe, difference
from core.report.sentences import direction_text, ratio_text

if TYPE_CHECKING:  # only its numbers are needed here, not the fusion
    from core.reconstruction.result import Reconstruction

MM = 1000.0
ML = 1e6


@dataclass(frozen=True)
class PourRow:
    """P of one direction: one text a distance, and their mean, by which directions are compared."""

    direction: str
    cells: tuple[str, ...]
    mean: str
    chosen: int | None


@dataclass(frozen=True)
class ViewRow:
    """The table as one view sees it; `bar` places its height on a scale from 0 to 100."""

    name: str
    height: str
    tilt: str
    bar: float | None


@dataclass(frozen=True)
class TimeRow:
    """A stage's time and its share of the longest, in per cent."""

    stage: str
    seconds: str
    share: float


def pour_rows(grid: PourGrid, choice: PourChoice | None) -> list[PourRow]:
    """Return one row a direction."""
    return [
        PourRow(
            direction_text(float(theta_rad)),
            tuple(ratio_text(grid, i, j) for j in range(grid.p.shape[1])),
            f"{100 * grid.p[i].mean():.1f}",
            choice.j if choice is not None and choice.i == i else None,
        )
        for i, theta_rad in enumerate(grid.theta_rad)
    ]


def risk_rows(grid: PourGrid, risk: PourRisk | None, choice: PourChoice | None) -> list[PourRow]:
    """Return one row a direction: tries that spilled nothing, of all; none without a risk."""
    if risk is None:
        return []
    clean, n = risk.n_clean, risk.n_tries
    return [
        PourRow(
            direction_text(float(theta_rad)),
            tuple(f"{clean[i, j]} of {n[i, j]}" for j in range(clean.shape[1])),
            f"{(risk.mean_spilled[i] * n[i]).sum() / n[i].sum():.1f}",
            choice.j if choice is not None and choice.i == i else None,
        )
        for i, theta_rad in enumerate(grid.theta_rad)
    ]


def holding_facts(capacity: Capacity | None, holding: Holding | None) -> dict[str, str]:
    """Return how much an object holds, and how firmly, in words; nothing where it was not imagined."""
    if capacity is None or holding is None:
        return {}
    tilts = (holding.first_rad, holding.tenth_rad, holding.half_rad)
    pushes = (holding.first_m_s2, holding.tenth_m_s2, holding.half_m_s2)
    most = f"more than {degrees(holding.tilt_rad[-1]):.0f}°"
    leaving = [
        f"{most}" if not np.isfinite(tilt) else f"{degrees(tilt):.0f}°, or a push of {push:.1f} m/s²"
        for tilt, push in zip(tilts, pushes, strict=True)
    ]
    fill_mm, rim_mm = MM * capacity.fill_height_m, MM * capacity.rim_height_m
    return {
        "Capacity": f"{capacity.n_candies:.0f} ± {capacity.spread:.0f} candies, {capacity.volume_ml:.0f} ml",
        "Water it would hold": f"{capacity.geometric_volume_ml:.0f} ml",
        "Height that candies fill": f"{fill_mm:.0f} of {rim_mm:.0f} mm",
        f"First of {holding.n_load} candies leaves at": leaving[0],
        "A tenth": leaving[1],
        "Half": leaving[2],
    }


def object_facts(surface: TriangleMesh, reconstruction: Reconstruction | None) -> dict[str, str]:
    """Return the object's size, volume and mesh in words, and how it was reconstructed if it was."""
    x, y, z = surface.extents_m * MM
    is_closed = topology(surface).is_closed
    facts = {
        "Size (x, y, z)": f"{x:.0f} × {y:.0f} × {z:.0f} mm",
        "Volume": f"{surface.volume_m3 * ML:.0f} ml" if is_closed else "unknown",
        "Surface": f"{'closed (watertight)' if is_closed else 'not closed'}, {len(surface.faces):,} faces",
    }
    if reconstruction is not None:
        facts |= {
            "Views": f"{len(reconstruction.pose_health.views)}",
            "Platform height": f"{reconstruction.platform_height_m * MM:.1f} mm",
            "Truncation": f"{reconstruction.truncation_m * MM:.1f} mm",
        }
    return facts


def health_sentence(reconstruction: Reconstruction) -> str:
    """Say how well the views' poses agree."""
    health = reconstruction.pose_health
    mean_m, sd_m, tilt_rad = health.mean_height_m, health.sd_height_m, health.largest_tilt_rad
    if mean_m is None or sd_m is None or tilt_rad is None:
        return "Too few views see the table to tell how well the poses agree."
    return (
        f"The views see the table at {mean_m * MM:.1f} ± {sd_m * MM:.1f} mm, tilted by up to "
        f"{degrees(tilt_rad):.1f}°. With perfect poses all would see it at one height, and level."
    )


def refinement_sentence(reconstruction: Reconstruction) -> str:
    """Say what correcting the poses did; empty when they were not corrected."""
    refinement = reconstruction.refinement
    if refinement is None or refinement.residual_before_m is None or refinement.residual_after_m is None:
        return ""
    shifts_m = [view.shift_m for view in refinement.views]
    return (
        "The poses were corrected by registering the views to each other: their surfaces were "
        f"{refinement.residual_before_m * MM:.1f} mm apart, now {refinement.residual_after_m * MM:.1f} mm; "
        f"the cameras moved by {sum(shifts_m) / len(shifts_m) * MM:.1f} mm on average, "
        f"at most {max(shifts_m) * MM:.1f} mm."
    )


def view_rows(reconstruction: Reconstruction) -> list[ViewRow]:
    """Return one row a view."""
    views = reconstruction.pose_health.views
    heights = [view.height_m for view in views if view.height_m is not None]
    low, span = (min(heights), max(max(heights) - min(heights), 1e-9)) if heights else (0.0, 1.0)
    rows = []
    for view in views:
        if view.height_m is None or view.tilt_rad is None:
            rows.append(ViewRow(view.name, "no table seen", "", None))
        else:
            height, tilt = f"{view.height_m * MM:.1f}", f"{degrees(view.tilt_rad):.2f}"
            rows.append(ViewRow(view.name, height, tilt, 100 * (view.height_m - low) / span))
    return rows


def parameter_rows(parameters: Parameters, preset: Parameters) -> list[tuple[str, str, str, str]]:
    """Return (name, value, the preset's value, what it means) of what differs from the preset."""
    facts = {fact.name: fact for fact in describe()}
    return [
        (name, _value(value, facts[name].unit), _value(before, facts[name].unit), facts[name].doc)
        for name, (before, value) in difference(parameters, preset).items()
    ]


def time_rows(seconds: dict[str, float]) -> list[TimeRow]:
    """Return one row a stage."""
    longest = max(seconds.values(), default=0) or 1.0
    return [TimeRow(stage, f"{took:.1f}", 100 * took / longest) for stage, took in seconds.items()]


def _value(value: Any, unit: str) -> str:
    if value is None:
        return "automatic"
    if isinstance(value, bool):
        return "yes" if value else "no"
    numbers = np.atleast_1d(np.asarray(value)).tolist() if not isinstance(value, str) else [value]
    text = ", ".join(f"{number:.6g}" if isinstance(number, float) else str(number) for number in numbers)
    return f"{text} {unit}".rstrip()
