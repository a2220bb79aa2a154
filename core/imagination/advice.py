"""Whether a pour is sure enough to be made: its chance to be clean, held against what is wanted."""

from __future__ import annotations

from core.imagination.risk.result import FewerCandies, PourRisk


def advice_against(risk: PourRisk | None, i: int, j: int, wanted_clean: float) -> str:
    """Return why pour (i, j) should not be made, and what may help; empty if it may, or nothing is known.

    Args:
        risk: of the pours; none: nothing was tried with errors of the set-up, as in the paper.
        i: index of the direction.
        j: index of the distance.
        wanted_clean: least chance of spilling nothing, as its lower 95 % bound.
    """
    if risk is None or risk.clean_at_least[i, j] >= wanted_clean:
        return ""
    n, clean = int(risk.n_tries[i, j]), int(risk.n_clean[i, j])
    return (
        f"Pouring is not advised: a clean pour is at least {_likely(risk.clean_at_least[i, j], clean, n)}, "
        f"and at least {100 * wanted_clean:.0f} % is wanted. {_what_helps(risk.fewer)}"
    )


def _what_helps(fewer: FewerCandies | None) -> str:
    if fewer is None:
        return "Another place, a scan with more views, or a smaller cup may help."
    sure = _likely(fewer.clean_at_least, fewer.n_clean, fewer.n_tries)
    return f"Ask for {fewer.n_candies} candies: with these it is at least {sure}."


def _likely(bound: float, n_clean: int, n_tries: int) -> str:
    return f"{100 * bound:.0f} % likely ({n_clean} of {n_tries} trials clean)"
