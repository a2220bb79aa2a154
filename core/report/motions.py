"""What the arm can make of the pours, and what became of those that it made."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from core.imagination.results import PourChoice, PourGrid
from core.motion.pour.choosing import PourMotions
from core.report.sentences import MM, direction_text, place_text, tries_sentence
from core.session.operator_choice import OperatorChoice
from core.session.pour_runs import PourRun


@dataclass(frozen=True)
class MotionRow:
    """The three distances of one direction: how long the pour takes and what stays free, or 'no'."""

    direction: str
    cells: tuple[str, ...]
    chosen: int | None


def motion_sentence(motions: PourMotions, grid: PourGrid) -> str:
    """Say how many pours the arm can make, and whether that changed the choice and why."""
    choice, free = motions.choice, motions.free_choice
    n = len(motions.pours)
    if choice is None:
        return f"The arm can make none of the {n} pours: {motions.at(free.i, free.j).reason}"
    said = f"The arm can make {motions.n_feasible} of the {n} pours"
    if not motions.is_changed:
        return f"{said}, the chosen one among them."
    tries = "" if motions.risk is None else f" {tries_sentence(motions.risk, choice.i, choice.j)}"
    return (
        f"{said}. The best by imagination alone, from {place_text(grid, free.i, free.j)}, is not one of "
        f"them: {motions.at(free.i, free.j).reason} "
        f"So it pours from {place_text(grid, choice.i, choice.j)}.{tries}"
    )


def operator_sentence(operator: OperatorChoice, grid: PourGrid, program: PourChoice | None) -> str:
    """Say what a person chose and why, and what the program would choose."""
    place = place_text(grid, operator.i, operator.j)
    reason = operator.reason.rstrip(".")
    if program is None:
        return f"Chosen by the operator, from {place}: {reason} (the program would choose none)."
    if (program.i, program.j) == (operator.i, operator.j):
        return f"Chosen by the operator, from {place}: {reason} (the program would choose the same)."
    return (
        f"Chosen by the operator, from {place}: {reason} "
        f"(the program would choose {place_text(grid, program.i, program.j)})."
    )


def motion_rows(motions: PourMotions, grid: PourGrid) -> list[MotionRow]:
    """Return one row a direction."""
    rows = []
    for i, theta_rad in enumerate(grid.theta_rad):
        pours = [motions.at(i, j) for j in range(len(grid.indent_m))]
        cells = tuple(
            f"{pour.duration_s:.0f} s, {pour.clearance_m * MM:.0f} mm free" if pour.is_feasible else "no"
            for pour in pours
        )
        chosen = motions.choice.j if motions.choice is not None and motions.choice.i == i else None
        rows.append(MotionRow(direction_text(float(theta_rad)), cells, chosen))
    return rows


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
            f"{run.sentence} {run.note}".rstrip(),
            "" if run.is_back_off else _outcome_sentence(run),
        )
        for run in runs
    ]


def _outcome_sentence(run: PourRun) -> str:
    return run.outcome.sentence if run.outcome else "Not entered yet."


def _clock(time: str) -> str:
    return datetime.fromisoformat(time).strftime("%d %B %Y, %H:%M:%S UTC") if time else ""
