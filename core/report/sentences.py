"""The result in plain sentences, the same wherever it is told."""

from __future__ import annotations

from math import degrees

from core.imagination.results import Containability, PourChoice, PourGrid
from core.imagination.risk.results import PourRisk
from core.imagination.verdict import Verdict

MM = 1000.0
_NO_BREAK = "\N{NO-BREAK SPACE}"


def verdict_sentence(containability: Containability) -> str:
    """Say whether the object is an open container, and why."""
    verdict = "Open container" if containability.is_open_container else "Not an open container"
    if containability.verdict is not None:
        return f"{verdict}: {capacity_text(containability.verdict)}."
    omega, threshold = omega_texts(containability)
    return f"{verdict}: {_stayed(containability)} (Omega {omega}, the threshold is {threshold})."


def capacity_text(verdict: Verdict) -> str:
    """Say what an object holds against its own size; of what is no container also when that leaves."""
    needed = f"a container holds more than {100 * verdict.threshold:.0f}{_NO_BREAK}%"
    if verdict.n_candies < 0.5:
        return f"it holds no candy; {needed} of its convex hull"
    held = (
        f"it holds {verdict.n_candies:.0f} candies ({verdict.volume_ml:.0f} ml), "
        f"{100 * verdict.capacity_share:.0f}{_NO_BREAK}% of its convex hull; {needed}"
    )
    if verdict.is_container or verdict.n_load == 0:
        return held
    return f"{held}, and tilted by more than {degrees(verdict.holds_rad):.0f} degrees it loses candies"


def paper_verdict_sentence(containability: Containability) -> str:
    """Say what the paper's rule says: Omega against its threshold."""
    omega, threshold = omega_texts(containability)
    verdict = "an open container" if containability.exceeds_omega else "no open container"
    return (
        f"By the paper's rule {verdict}: {_stayed(containability)} of those dropped over all of it "
        f"(Omega {omega}, the threshold is {threshold})."
    )


def _stayed(containability: Containability) -> str:
    return f"{containability.n_in} of {containability.n_drop} candies stayed"


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
        return "No pours were imagined because the object is no open container."
    if grid is None:
        return "No pours were imagined yet: the run ended before them; run the same command to continue."
    return "Pours were imagined but none was chosen."


def tries_sentence(risk: PourRisk, i: int, j: int) -> str:
    """Say how often a pour was tried, and how sure it is to spill nothing."""
    n, clean = int(risk.n_tries[i, j]), int(risk.n_clean[i, j])
    if n == 1:
        return "Tried once, without errors of the set-up" + ("." if clean else f": {_spilled(risk, i, j)}.")
    bound = f"{100 * risk.clean_at_least[i, j]:.0f}"
    sure = f"so it spills nothing in at least {bound}{_NO_BREAK}% of pours (95{_NO_BREAK}% sure)"
    if clean == n:
        return f"Tried {n} times, with errors of the set-up: nothing was spilled, {sure}."
    return (
        f"Tried {n} times, with errors of the set-up: nothing was spilled in {clean} of them, "
        f"{_spilled(risk, i, j)} on average, {sure}."
    )


def risk_sentence(grid: PourGrid, risk: PourRisk, choice: PourChoice, paper: PourChoice) -> str:
    """Say how sure the chosen pour is, and why it is not the paper's where it is another one."""
    said = tries_sentence(risk, choice.i, choice.j)
    if (choice.i, choice.j) == (paper.i, paper.j):
        return f"{said} The paper's rule chooses the same."
    n, clean = risk.n_tries[paper.i, paper.j], risk.n_clean[paper.i, paper.j]
    return (
        f"{said} The paper's rule would pour from {place_text(grid, paper.i, paper.j)}, of whose "
        f"{n} {'try' if n == 1 else 'tries'} {clean} spilled nothing."
    )


def _spilled(risk: PourRisk, i: int, j: int) -> str:
    return f"{risk.mean_spilled[i, j]:.1f} of {risk.n_pour} candies"


def place_text(grid: PourGrid, i: int, j: int) -> str:
    """Return where a pour's pivot lies, such as '45° at 31 mm'."""
    return f"{direction_text(float(grid.theta_rad[i]))} at {grid.indent_m[j] * MM:.0f} mm"


def omega_texts(containability: Containability) -> tuple[str, str]:
    """Return Omega and its threshold with two decimals, or with as many as tell them apart."""
    omega, threshold = containability.omega, containability.omega_threshold
    for decimals in (2, 3, 4):
        texts = f"{omega:.{decimals}f}", f"{threshold:.{decimals}f}"
        if omega == threshold or texts[0] != texts[1]:
            break
    return texts


def direction_text(angle_rad: float) -> str:
    """Return a direction against the world's x-axis in whole degrees from 0 to 359."""
    return f"{round(degrees(angle_rad)) % 360}°"


def ratio_text(grid: PourGrid, i: int, j: int) -> str:
    """Return P of a pour in per cent, with its spread when there are several packings to tell it from."""
    text = f"{100 * grid.p[i, j]:.0f}"
    return f"{text} ± {100 * grid.p_spread[i, j]:.0f}" if has_spread(grid) else text


def has_spread(grid: PourGrid) -> bool:
    """Whether the grid holds several packings."""
    return bool(grid.n_in.shape[2] > 1)
