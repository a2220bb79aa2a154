"""The result in plain sentences, the same wherever it is told."""

from __future__ import annotations

from math import degrees

from core.imagination.results import Containability, PourChoice, PourGrid


def verdict_sentence(containability: Containability) -> str:
    """Say whether the object is an open container, and by how much."""
    verdict = "Open container" if containability.is_open_container else "Not an open container"
    omega, threshold = omega_texts(containability)
    return (
        f"{verdict}: {containability.n_in} of {containability.n_drop} candies stayed "
        f"(Omega {omega}, the threshold is {threshold})."
    )


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
