"""The result in plain sentences, the same in the report, the terminal and the window."""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees
from typing import TYPE_CHECKING

from core.imagination.results import Containability, PourChoice, PourGrid
from core.imagination.risk.result import PourRisk
from core.imagination.verdict import Verdict

if TYPE_CHECKING:
    from core.motion.pour.feasibility import PourMotions
    from core.session.operator_choice import OperatorChoice

MM = 1000.0
NO_POURS = "No pours were imagined because the object is not an open container."
UNDECIDED_POURS = "No pours were imagined because too little of the inside was seen."
_NO_BREAK = "\N{NO-BREAK SPACE}"


def verdict_words(is_open_container: bool | None, is_undecided: bool = False) -> str:
    """Return the verdict in two or three words; None: there is none yet."""
    if is_undecided:
        return "Cannot tell"
    if is_open_container is None:
        return "No verdict yet"
    return "Open container" if is_open_container else "Not a container"


def verdict_sentence(containability: Containability) -> str:
    """Say whether the object is an open container, and why."""
    verdict = "Open container" if containability.is_open_container else "Not an open container"
    if containability.verdict is not None and containability.is_undecided:
        return undecided_sentence(containability.verdict)
    if containability.verdict is not None:
        return f"{verdict}: {capacity_text(containability.verdict)}."
    omega, threshold = omega_texts(containability)
    return f"{verdict}: {_stayed(containability)} (Omega {omega}, the threshold is {threshold})."


def verdict_parts(containability: Containability) -> tuple[str, str]:
    """Return `verdict_sentence` as a headline and what else it says; empty if that is all."""
    headline, _, further = verdict_sentence(containability).rstrip(".").partition(". ")
    return f"{headline}.", f"{further}." if further else ""


def undecided_sentence(verdict: Verdict) -> str:
    """Say why there is no answer, and what would give one."""
    solid, free = verdict.capacity_share > verdict.threshold, (verdict.other_share or 0.0) > verdict.threshold
    answers = {True: "a container", False: "no container"}
    return (
        f"Cannot tell: {verdict.unseen_ml:.0f} ml inside were not seen. If that is solid, it is "
        f"{answers[solid]}; if not, {answers[free]}. Look again from further views."
    )


def verdict_summary(
    is_open_container: bool | None,
    omega: float | None,
    omega_threshold: float | None,
    capacity_share: float | None = None,
    capacity_threshold: float | None = None,
    is_undecided: bool = False,
) -> str:
    """Say the same from what a list of sessions knows, where neither the counts nor the verdict are at hand.

    Args:
        is_open_container: the verdict.
        omega: Omega; None: nothing was imagined yet.
        omega_threshold: Omega_thr.
        capacity_share: what the object holds as a share of its convex hull; None if Omega decided.
        capacity_threshold: above which it is a container.
        is_undecided: whether the answer depends on what no view saw.
    """
    if is_open_container is None or omega is None or omega_threshold is None:
        return f"{verdict_words(None)}: nothing has been imagined."
    verdict = verdict_words(is_open_container, is_undecided)
    if is_undecided:
        return f"{verdict}: too little of its inside was seen."
    if capacity_share is not None and capacity_threshold is not None:
        return (
            f"{verdict}: hollow for {percent(capacity_share)} of its bulk "
            f"(containers: over {percent(capacity_threshold)})."
        )
    return f"{verdict}: {percent(omega)} of the candies stayed; in a container more than " + (
        f"{percent(omega_threshold)} stay."
    )


def verdict_reason(containability: Containability, n_on_top: int) -> str:
    """Give the paper's verdict; if it decides, what had to stay, what did, and where the others are.

    For where Omega and its threshold are drawn beside it. `n_on_top` lie on the object, not in it.
    """
    found = containability
    if found.verdict is not None:
        said = f"{_by_omega(found)}."
        if found.is_open_container or not n_on_top:
            return said
        none_stays = found.verdict.n_candies < 0.5
        fate = "; none would stay when it is tilted" if none_stays else ", with no wall around them"
        return f"{said} {n_on_top} lie on top{fate}."
    needed = f"More than {percent(found.omega_threshold)} of the candies have to stay inside;"
    if found.is_open_container:
        return f"{needed} {percent(found.omega)} did."
    did = f"not one of the {found.n_drop} did." if found.n_in == 0 else f"only {percent(found.omega)} did."
    others = "fell past it or rolled off."
    if n_on_top:
        return f"{needed} {did} {n_on_top} lie on top, with no wall around them; the others {others}"
    return f"{needed} {did} The others {others}"


def capacity_text(verdict: Verdict) -> str:
    """Say what an object holds for its size."""
    needed = f"(containers: over {100 * verdict.threshold:.0f}{_NO_BREAK}%)"
    hollow = f"hollow for {100 * verdict.capacity_share:.0f}{_NO_BREAK}% of its bulk {needed}"
    if verdict.n_candies < 0.5:
        return hollow
    through = ""
    if verdict.too_small_m is not None:
        size = f"{MM * verdict.too_small_m:.0f}{_NO_BREAK}mm"
        through = f"Candies of {size} would fall through its openings. "
    return f"{held_text(verdict)}. {through}{hollow.capitalize()}"


def held_text(verdict: Verdict) -> str:
    """Say how many candies an object holds: level with its rim, and heaped where that was imagined."""
    level, level_ml = verdict.level_candies, verdict.level_ml
    if level is None or level_ml is None:
        return f"it holds {verdict.n_candies:.0f} candies ({verdict.volume_ml:.0f} ml)"
    heaped = verdict.n_candies - level
    if level < 0.5:
        return f"{verdict.n_candies:.0f} candies stay on it, with no closed rim around them"
    said = f"level with its rim it holds {level:.0f} candies ({level_ml:.0f} ml)"
    if verdict.has_stand_ins or heaped < 0.5:
        return said
    return f"{said}, heaped {verdict.n_candies:.0f}"


def omega_verdict_sentence(containability: Containability) -> str:
    """Give the verdict by Omega against its threshold (Sec. III-A), with these candies and this drop."""
    omega, threshold = omega_texts(containability)
    return f"{_by_omega(containability)} (Omega {omega}, the threshold is {threshold})."


def _by_omega(containability: Containability) -> str:
    verdict = "an open container" if containability.exceeds_omega else "not an open container"
    return f"By Omega {verdict}: {_stayed(containability)}"


def _stayed(containability: Containability) -> str:
    return f"{containability.n_in} of {containability.n_drop} dropped candies stayed"


def choice_sentence(grid: PourGrid, choice: PourChoice) -> str:
    """Say where to pour from and how much of it is expected to land inside."""
    return (
        f"Pour from {direction_text(choice.theta_rad)} (anticlockwise from the x-axis), "
        f"{100 * grid.indent_m[choice.j]:.1f} cm out from the footprint's centre: "
        f"{ratio_text(grid, choice.i, choice.j)} % of the {grid.n_pour} candies land inside."
    )


def pours_sentence(containability: Containability, grid: PourGrid | None, choice: PourChoice | None) -> str:
    """Say where to pour from, or why there is no such place."""
    if grid is not None and choice is not None:
        return choice_sentence(grid, choice)
    if not containability.is_open_container:
        return UNDECIDED_POURS if containability.is_undecided else NO_POURS
    if grid is None:
        return "The pours have not been imagined yet: the run ended before them."
    return "Pours were imagined but none was chosen."


def tries_sentence(risk: PourRisk, i: int, j: int) -> str:
    """Say how likely a pour spills nothing (lower 95 % bound), and in how many trials it did not."""
    n, clean = int(risk.n_tries[i, j]), int(risk.n_clean[i, j])
    if n == 0:
        return "Not tried."
    if n == 1 and risk.n_cups == 1:
        return "Tried once, without set-up errors" + ("." if clean else f": {_spilled(risk, i, j)} spilled.")
    bound = f"{100 * risk.clean_at_least[i, j]:.0f}{_NO_BREAK}%"
    of_all = f" of all {risk.n_cups} cups" if risk.n_cups > 1 else ""
    said = f"Clean pour{of_all}: at least {bound} likely ({clean} of {n} trials clean)"
    return f"{said}." if clean == n else f"{said}; {_spilled(risk, i, j)} spilled on average."


def risk_sentence(grid: PourGrid, risk: PourRisk, choice: PourChoice, paper: PourChoice) -> str:
    """Say how sure the chosen pour is, and why it is not the paper's where it is another one."""
    said = tries_sentence(risk, choice.i, choice.j)
    if (choice.i, choice.j) == (paper.i, paper.j):
        return f"{said} The paper's rule (largest P) chooses the same pour."
    n, clean = risk.n_tries[paper.i, paper.j], risk.n_clean[paper.i, paper.j]
    tried = f"clean in {clean} of {n} trial{'s' if n > 1 else ''}" if n else "which was not tried"
    return (
        f"{said} The paper's rule (largest P) would pour from {place_text(grid, paper.i, paper.j)}, {tried}."
    )


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
        f"{said}. The best by imagination alone, from {place_text(grid, free.i, free.j)}, is not "
        f"among them: {motions.at(free.i, free.j).reason} "
        f"So it pours from {place_text(grid, choice.i, choice.j)}.{tries}"
    )


def operator_sentence(operator: OperatorChoice, grid: PourGrid, program: PourChoice | None) -> str:
    """Say what a person chose and why, and what the program would choose."""
    if program is None:
        else_chosen = "none"
    elif (program.i, program.j) == (operator.i, operator.j):
        else_chosen = "the same"
    else:
        else_chosen = place_text(grid, program.i, program.j)
    return (
        f"Chosen by the operator, from {place_text(grid, operator.i, operator.j)}: "
        f"{operator.reason.rstrip('.')} (the program would choose {else_chosen})."
    )


def _spilled(risk: PourRisk, i: int, j: int) -> str:
    return f"{risk.mean_spilled[i, j]:.1f} of {risk.n_pour} candies"


def place_text(grid: PourGrid, i: int, j: int) -> str:
    """Return where a pour's pivot lies, such as '45° at 31 mm'."""
    return f"{direction_text(float(grid.theta_rad[i]))} at {grid.indent_m[j] * MM:.0f} mm"


def omega_texts(containability: Containability) -> tuple[str, str]:
    """Return Omega and its threshold with two decimals, or with as many as distinguish them."""
    omega, threshold = containability.omega, containability.omega_threshold
    for decimals in (2, 3, 4):
        texts = f"{omega:.{decimals}f}", f"{threshold:.{decimals}f}"
        if omega == threshold or texts[0] != texts[1]:
            break
    return texts


def direction_text(angle_rad: float) -> str:
    """Return a direction against the world's x-axis in whole degrees from 0 to 359."""
    return f"{round(degrees(angle_rad)) % 360}°"


def duration_text(seconds: float) -> str:
    """Return a time as people say it: 40 s, 14 min, 1 h 20 min."""
    if seconds < 59.5:
        return f"{max(round(seconds), 1)} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 60 else f"{minutes // 60} h {minutes % 60} min"


def known_sentence(known_s: Mapping[str, float]) -> str:
    """Say how long after a scan's last view each answer was there; empty if nothing is known of that.

    Args:
        known_s: stage to seconds from the last view to its end.
    """
    named = {"reconstruction": "the model", "judgement": "the verdict", "risk": "the chosen pour"}
    said = [f"{named[name]} {duration_text(known_s[name])}" for name in named if name in known_s]
    if not said:
        return ""
    *others, last = said
    return f"After the last view: {' and '.join(filter(None, (', '.join(others), last)))}."


def percent(share: float) -> str:
    """Return a share in per cent, with decimals where a whole number would hide a small one."""
    value = 100 * share
    return f"{value:.2g}{_NO_BREAK}%" if 0 < value < 9.5 else f"{value:.0f}{_NO_BREAK}%"


def ratio_text(grid: PourGrid, i: int, j: int) -> str:
    """Return P of a pour in per cent, with its spread when there are several packings."""
    text = f"{100 * grid.p[i, j]:.0f}"
    return f"{text} ± {100 * grid.p_spread[i, j]:.0f}" if has_spread(grid) else text


def has_spread(grid: PourGrid) -> bool:
    """Whether the grid holds several packings."""
    return bool(grid.n_in.shape[2] > 1)
