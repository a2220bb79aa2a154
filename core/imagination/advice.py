"""Whether a pour is sure enough to be made: its chance to be clean, held against what is wanted."""

from __future__ import annotations

from core.imagination.results import PourRisk


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
    sure = f"{100 * risk.clean_at_least[i, j]:.0f} % likely ({clean} of {n} trials clean)"
    return (
        f"Pouring is not advised: a clean pour is at least {sure}, and at least {100 * wanted_clean:.0f} % "
        "is wanted. Fewer candies, a scan with more views, or a smaller cup may help."
    )
