"""How many candies to pour, in how many cups, and whether that is wise."""

from __future__ import annotations

from core.errors import StageError
from core.imagination.amount.request import AmountRequest
from core.imagination.amount.result import Amount
from core.imagination.amount.safe import safe_candies, sure_candies
from core.imagination.amount.words import candies
from core.imagination.capacity.result import Capacity
from core.imagination.packing import cup_holds
from core.imagination.risk.set_up import scaled_candies
from core.parameters import Parameters

MOST_CUPS = 10
"""Somebody fills each cup and each is a pour of its own: more take longer than a better tool."""
REFUSED_ABOVE = 1.3
"""Times the capacity, above which a pour cannot end well whatever the errors of the capacity."""
_MOST_IN_CUP = 1000
"""The largest N_pour there may be."""


def reason_amount(request: AmountRequest, capacity: Capacity, parameters: Parameters) -> Amount:
    """Return how many candies to pour into an object of a known capacity; no physics.

    Args:
        request: what somebody asks for.
        capacity: of the object, in candies as `parameters` has them.
        parameters: the cup, the candy and how much its size varies; their N_pour does not matter.

    Raises:
        StageError: the cup cannot hold a single candy.
    """
    n_safe = safe_candies(capacity, parameters)
    n_half = max(int(capacity.n_candies / 2), 1)
    n_asked = {"safe": n_safe, "half": n_half, "number": request.n_candies}[request.wish]
    n_most = MOST_CUPS * cup_limit(parameters)
    refusal = _refusal(request, n_asked, n_safe, n_most, capacity)
    n_total = 0 if refusal else min(n_asked, n_most)
    return Amount(
        request=str(request),
        n_fit=round(capacity.n_candies),
        n_safe=n_safe,
        n_total=n_total,
        n_per_cup=_in_cups(n_total, n_most // MOST_CUPS),
        fill_share=capacity.share_of(n_total),
        fill_height_m=capacity.level_of(n_total),
        share_of_capacity=n_total / capacity.n_candies if n_total else 0.0,
        warning="" if refusal else _warning(n_asked, n_safe, n_most, capacity, parameters),
        refusal=refusal,
    )


def cup_limit(parameters: Parameters) -> int:
    """Return the largest N_pour of which the cup has room, by bisection, the candies as large as they may be.

    Raises:
        StageError: not even for one.
    """
    if not _holds(parameters, 1):
        raise StageError("The cup cannot hold a single candy; enlarge the cup (pouring.cup).")
    low, beyond = 1, _MOST_IN_CUP + 1
    while beyond - low > 1:
        middle = (low + beyond) // 2
        low, beyond = (middle, beyond) if _holds(parameters, middle) else (low, middle)
    return low


def _holds(parameters: Parameters, n_pour: int) -> bool:
    pouring, scale = (
        parameters.pouring.model_copy(update={"n_pour": n_pour}),
        1 + parameters.risk.candy_spread,
    )
    return cup_holds(scaled_candies(parameters.model_copy(update={"pouring": pouring}), scale))


def _in_cups(n_total: int, n_most: int) -> tuple[int, ...]:
    """As few cups as suffice, of sizes that differ by one at most, the larger ones first."""
    n_cups = -(-n_total // n_most)
    return tuple(n_total // n_cups + (cup < n_total % n_cups) for cup in range(n_cups))


def _refusal(request: AmountRequest, n_asked: int, n_safe: int, n_most: int, capacity: Capacity) -> str:
    n_fit = round(capacity.n_candies)
    if capacity.n_candies < 1:
        return "The object holds no candy, so nothing can be poured into it; take another object."
    if n_asked > round(REFUSED_ABOVE * n_fit):
        return (
            f"{candies(n_asked)} are more than {REFUSED_ABOVE:g} times the {n_fit} that fit: up to "
            f"{n_asked - n_fit} would run over; ask for at most {min(n_safe, n_most)}."
        )
    if request.wish == "number" and n_asked > n_most:
        return f"{candies(n_asked)} need more than {MOST_CUPS} cups, the most in one go; ask for {n_most}."
    return ""


def _warning(n_asked: int, n_safe: int, n_most: int, capacity: Capacity, parameters: Parameters) -> str:
    n_fit = round(capacity.n_candies)
    if n_asked > n_most:
        return (
            f"{candies(n_asked)} would be right, but {MOST_CUPS} cups are the most in one go, and these hold "
            f"{n_most}."
        )
    if n_asked > n_fit:
        return (
            f"{candies(n_asked)} are more than the {n_fit} that fit; up to {n_asked - n_fit} will run over."
        )
    if n_asked > max(sure_candies(capacity, parameters), n_safe):
        return (
            f"{candies(n_asked)} are nearly as many as the {n_fit} that fit; if these are a little larger "
            f"than planned, some will run over; {n_safe} fit safely."
        )
    return _of_low_rim(capacity.rim_height_m, parameters.particle.diameter_m)


def _of_low_rim(rim_m: float, candy_m: float) -> str:
    """However few they are: a candy that stands on its edge, or rolls, leaves over a rim that low."""
    if rim_m >= candy_m:
        return ""
    rim = "No rim is closed all around"
    if rim_m > 0:
        rim = (
            f"At its lowest the rim is {1000 * rim_m:.0f} mm above the inner floor, less than a candy is "
            f"wide ({1000 * candy_m:.0f} mm)"
        )
    return f"{rim}: single candies may leave there whatever their number."
