"""What the page says of its pours, in sentences."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QCoreApplication

from app.gui.pages.pours.comparison import OtherPours, best_of
from app.gui.pages.pours.results import ShownPours
from core.imagination.amount.words import amount_text
from core.imagination.results import PourGrid
from core.report import (
    motion_sentence,
    operator_sentence,
    place_text,
    risk_sentence,
    tries_sentence,
    verdict_sentence,
)
from core.report.sentences import direction_text, ratio_text

NO_BREAK = "\N{NO-BREAK SPACE}"

MM = 1000.0
_CONTEXT = "Pours"


def chosen_sentence(pours: ShownPours) -> str:
    """Say which pour will be made, how good it is, and whether the arm can make it."""
    grid, chosen = pours.grid, pours.chosen
    if grid is None and pours.containability.is_open_container:
        return QCoreApplication.translate(_CONTEXT, "No pours yet.")
    if grid is None:
        return QCoreApplication.translate(_CONTEXT, "No pours: this object is no open container.")
    if chosen is None:
        return QCoreApplication.translate(_CONTEXT, "None chosen: the arm can make none of the pours.")
    return QCoreApplication.translate(_CONTEXT, "Chosen: {pour}, {arm}.").format(
        pour=_pour_words(grid, *chosen), arm=_arm_words(pours, *chosen)
    )


def why_sentences(pours: ShownPours) -> list[str]:
    """Say why this one: a person, the arm, its tries, or the paper's rule with its numbers."""
    grid = pours.grid
    if grid is None:
        return [_no_pours(pours)]
    said = [] if pours.amount is None else [amount_text(pours.amount)]
    if pours.operator is not None:
        said.append(operator_sentence(pours.operator, grid, pours.program_choice))
    elif pours.is_free_choice and pours.choice is not None and pours.paper_choice is not None:
        if pours.risk is not None:
            said.append(risk_sentence(grid, pours.risk, pours.choice, pours.paper_choice))
        else:
            said.append(_rule(grid, pours.paper_choice.i, pours.paper_choice.j))
    if pours.motions is not None and pours.operator is None:
        said.append(motion_sentence(pours.motions, grid))
    if pours.problem:
        said.append(pours.problem)
    return said


def selected_sentence(pours: ShownPours, i: int, j: int) -> str:
    """Say where a pour is from, and how much of it lands inside."""
    assert pours.grid is not None, "there is a pour"
    said = QCoreApplication.translate(_CONTEXT, "{pour} of the {n} candies land inside.").format(
        pour=_pour_words(pours.grid, i, j).capitalize(), n=pours.grid.n_pour
    )
    return said if pours.risk is None else f"{said} {tries_sentence(pours.risk, i, j)}"


def feasibility_sentence(pours: ShownPours, i: int, j: int) -> str:
    """Say whether the arm can make a pour, or why not, or why that is not known."""
    if not pours.stands_in_cell:
        return QCoreApplication.translate(
            _CONTEXT, "An imported mesh stands in no cell, so no arm was asked. Scan the object to pour."
        )
    found = pours.feasibility(i, j)
    if found is None:
        return QCoreApplication.translate(
            _CONTEXT, "Not checked with this cell's arm since the pours were imagined."
        )
    if not found.is_feasible:
        return QCoreApplication.translate(_CONTEXT, "The arm cannot make it: {reason}").format(
            reason=found.reason
        )
    return QCoreApplication.translate(
        _CONTEXT, "The arm can make it in {seconds:.0f} s; {mm:.0f} mm stay free around it."
    ).format(seconds=found.duration_s, mm=MM * found.clearance_m)


def comparison_sentence(grid: PourGrid, other: OtherPours) -> str:
    """Say which of two grids has the better best pour, and by how much."""
    here, there = best_of(grid), other.best
    points = 100 * (grid.p[here] - other.grid.p[there])
    said = QCoreApplication.translate(
        _CONTEXT, "Best here: {here} % from {here_place}. {label}: {there} % from {there_place}, {points}."
    ).format(
        here=_ratio(grid, *here),
        here_place=place_text(grid, *here),
        label=other.label[:1].upper() + other.label[1:],
        there=_ratio(other.grid, *there),
        there_place=place_text(other.grid, *there),
        points=_points_words(points),
    )
    apart_deg = np.degrees(other.farthest_rad(grid))
    if len(other.grid.theta_rad) > 1 and apart_deg > 1:
        said += " " + QCoreApplication.translate(
            _CONTEXT, "Its directions differ by up to {deg:.0f}°; each pour is held against the nearest one."
        ).format(deg=apart_deg)
    return said


def _ratio(grid: PourGrid, i: int, j: int) -> str:
    return ratio_text(grid, i, j).replace(" ", NO_BREAK)


def _points_words(points: float) -> str:
    if round(points) == 0:
        return QCoreApplication.translate(_CONTEXT, "just as good")
    if points > 0:
        return QCoreApplication.translate(_CONTEXT, "{n:.0f} points worse").format(n=points)
    return QCoreApplication.translate(_CONTEXT, "{n:.0f} points better").format(n=-points)


def _pour_words(grid: PourGrid, i: int, j: int) -> str:
    return QCoreApplication.translate(
        _CONTEXT, "from {deg}, {mm:.0f} mm out: {ratio}\N{NO-BREAK SPACE}%"
    ).format(deg=direction_text(float(grid.theta_rad[i])), mm=MM * grid.indent_m[j], ratio=_ratio(grid, i, j))


def _arm_words(pours: ShownPours, i: int, j: int) -> str:
    if not pours.stands_in_cell:
        return QCoreApplication.translate(_CONTEXT, "imagined only")
    found = pours.feasibility(i, j)
    if found is None:
        return QCoreApplication.translate(_CONTEXT, "not yet checked with the arm")
    if not found.is_feasible:
        return QCoreApplication.translate(_CONTEXT, "out of the arm's reach")
    return QCoreApplication.translate(_CONTEXT, "reachable, {mm:.0f} mm clearance").format(
        mm=MM * found.clearance_m
    )


def _rule(grid: PourGrid, i: int, j: int) -> str:
    """The argmax rule of Sec. III-B with the numbers it was decided by."""
    sums = grid.n_in.sum(axis=(1, 2))
    n = len(sums)
    mean = QCoreApplication.translate(_CONTEXT, "{mean:.1f} % on average over its distances").format(
        mean=100 * grid.p[i].mean()
    )
    direction = direction_text(float(grid.theta_rad[i]))
    tied = int((sums == sums[i]).sum())
    if n == 1:
        first = QCoreApplication.translate(
            _CONTEXT, "Only the direction {direction} was imagined: {mean}."
        ).format(direction=direction, mean=mean)
    elif tied > 1:
        first = QCoreApplication.translate(
            _CONTEXT,
            "{tied} directions do equally well ({mean}); the one nearest the footprint's long axis is "
            "{direction}.",
        ).format(tied=tied, mean=mean, direction=direction)
    else:
        first = QCoreApplication.translate(
            _CONTEXT, "Direction {direction} is the best of {n}: {mean}."
        ).format(direction=direction, n=n, mean=mean)
    second = QCoreApplication.translate(
        _CONTEXT, "Of its distances, {mm:.0f} mm is the best, or the smallest of equals."
    ).format(mm=MM * grid.indent_m[j])
    return f"{first} {second}"


def _no_pours(pours: ShownPours) -> str:
    found = pours.containability
    if found.is_open_container:
        return QCoreApplication.translate(
            _CONTEXT, "The run ended before the pours were imagined; imagine again to continue."
        )
    only = QCoreApplication.translate(_CONTEXT, "Pours are imagined for open containers only.")
    return f"{only} {verdict_sentence(found)}"
