"""The numbers of a report as rows of text."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime
from math import degrees
from typing import TYPE_CHECKING, Any

import numpy as np

from core.imagination.capacity.result import Capacity
from core.imagination.results import PourChoice, PourGrid
from core.imagination.retention.result import Retention
from core.imagination.risk.result import PourRisk
from core.mesh import TriangleMesh
from core.mesh_topology import topology
from core.parameters import Parameters, describe, difference
from core.report.sentences import MM, direction_text, place_text, ratio_text

if TYPE_CHECKING:  # only their numbers are needed here, not what computes them
    from core.motion.pour.feasibility import PourMotions
    from core.reconstruction.result import Reconstruction
    from core.session.pour_runs import PourRun

ML = 1e6


@dataclass(frozen=True)
class PourRow:
    """One direction of the pours: a text for each distance, and one about all of them.

    Attributes:
        direction: of the pours.
        cells: one text a distance.
        last: of all distances together; empty without such a column.
        chosen: index of the chosen distance; None where another direction was chosen.
    """

    direction: str
    cells: tuple[str, ...]
    last: str
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
    """Return P of every pour, and the means, by which directions are compared."""
    return _rows(grid, choice, lambda i, j: ratio_text(grid, i, j), lambda i: f"{100 * grid.p[i].mean():.1f}")


def risk_rows(grid: PourGrid, risk: PourRisk | None, choice: PourChoice | None) -> list[PourRow]:
    """Return the tries that spilled nothing, of all, and the mean spill; none without a risk."""
    if risk is None:
        return []
    clean, n, spilled = risk.n_clean, risk.n_tries, risk.mean_spilled
    return _rows(
        grid,
        choice,
        lambda i, j: f"{clean[i, j]} of {n[i, j]}",
        lambda i: f"{(spilled[i] * n[i]).sum() / n[i].sum():.1f}" if n[i].any() else "",
    )


def motion_rows(motions: PourMotions, grid: PourGrid) -> list[PourRow]:
    """Return how long each pour takes and its clearance, or 'no'."""

    def cell(i: int, j: int) -> str:
        pour = motions.at(i, j)
        return f"{pour.duration_s:.0f} s, {pour.clearance_m * MM:.0f} mm" if pour.is_feasible else "no"

    return _rows(grid, motions.choice, cell, lambda _: "")


def _rows(
    grid: PourGrid,
    choice: PourChoice | None,
    cell: Callable[[int, int], str],
    last: Callable[[int], str],
) -> list[PourRow]:
    return [
        PourRow(
            direction_text(float(theta_rad)),
            tuple(cell(i, j) for j in range(len(grid.indent_m))),
            last(i),
            choice.j if choice is not None and choice.i == i else None,
        )
        for i, theta_rad in enumerate(grid.theta_rad)
    ]


def retention_facts(capacity: Capacity | None, retention: Retention | None) -> dict[str, str]:
    """Return how much an object holds, and how firmly, in words; nothing where it was not imagined."""
    if capacity is None or retention is None:
        return {}
    tilts = (retention.first_rad, retention.tenth_rad, retention.half_rad)
    pushes = (retention.first_m_s2, retention.tenth_m_s2, retention.half_m_s2)
    most = f"more than {degrees(retention.tilt_rad[-1]):.0f}°"
    leaving = [
        most
        if not np.isfinite(tilt)
        else f"{degrees(tilt):.0f}°, or a slowly growing acceleration of {push:.1f} m/s²"
        for tilt, push in zip(tilts, pushes, strict=True)
    ]
    fill_mm, rim_mm = MM * capacity.fill_height_m, MM * capacity.rim_height_m
    return {
        "Capacity, level with the rim": f"{capacity.level_candies:.0f} candies, {capacity.level_ml:.0f} ml",
        **_heap_facts(capacity),
        "Water capacity": f"{capacity.geometric_volume_ml:.0f} ml",
        "Fill height": f"{fill_mm:.0f} of {rim_mm:.0f} mm",
        f"First of {retention.n_load} candies leaves at": leaving[0],
        "A tenth": leaving[1],
        "Half": leaving[2],
    }


def _heap_facts(capacity: Capacity) -> dict[str, str]:
    """With what is heaped; nothing where larger balls stood for candies."""
    if capacity.stand_in_diameter_m is not None:
        return {}
    return {"Heaped": f"{capacity.n_candies:.0f} ± {capacity.spread:.0f} candies, {capacity.bulk_ml:.0f} ml"}


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
            "TSDF truncation": f"{reconstruction.truncation_m * MM:.1f} mm",
        }
    return facts


def health_sentence(reconstruction: Reconstruction) -> str:
    """Say how well the views' poses agree."""
    health = reconstruction.pose_health
    mean_m, sd_m, tilt_rad = health.mean_height_m, health.sd_height_m, health.largest_tilt_rad
    if mean_m is None or sd_m is None or tilt_rad is None:
        return "Too few views see the table to measure how well the poses agree."
    return (
        f"The views see the table at {mean_m * MM:.1f} ± {sd_m * MM:.1f} mm, tilted by up to "
        f"{degrees(tilt_rad):.1f}°. With perfect poses all would see it level and at the same height."
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


def motion_reasons(motions: PourMotions, grid: PourGrid) -> list[tuple[str, str]]:
    """Return each reason why pours cannot be made, once, and which pours it holds for."""
    places: dict[str, list[str]] = {}
    for pour in motions.pours:
        if not pour.is_feasible:
            places.setdefault(pour.reason, []).append(place_text(grid, pour.i, pour.j))
    return [(", ".join(where), reason) for reason, where in places.items()]


def run_rows(runs: Sequence[PourRun]) -> list[tuple[str, str, str]]:
    """Return (time, how it ended and whether a person had chosen it, what was spilled) of each run."""
    return [
        (
            _clock(run.begun),
            " ".join(filter(None, (run.sentence, run.note, run.problem))),
            "" if run.is_back_off else _outcome_sentence(run),
        )
        for run in runs
    ]


def _outcome_sentence(run: PourRun) -> str:
    return run.outcome.sentence if run.outcome else "Outcome not entered yet."


def _clock(time: str) -> str:
    return datetime.fromisoformat(time).strftime("%d %B %Y, %H:%M:%S UTC") if time else ""


def _value(value: Any, unit: str) -> str:
    if value is None:
        return "automatic"
    if isinstance(value, bool):
        return "yes" if value else "no"
    numbers = np.atleast_1d(np.asarray(value)).tolist() if not isinstance(value, str) else [value]
    text = ", ".join(f"{number:.6g}" if isinstance(number, float) else str(number) for number in numbers)
    return f"{text} {unit}".rstrip()
