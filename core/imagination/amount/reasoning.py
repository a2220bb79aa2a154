"""How many candies to pour, in how many cups, and whether that is wise; no physics."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from core.errors import StageError
from core.imagination.amount.result import HALF, SAFE, Amount, AmountRequest, PlannedAmount, candies
from core.imagination.capacity.result import Capacity
from core.imagination.packing import cup_holds, require_room
from core.imagination.set_up import scaled_candies
from core.parameters import Parameters

MOST_CUPS = 10
"""Somebody fills each cup and each is a pour of its own: more take longer than a better tool."""
REFUSED_ABOVE = 1.3
"""Times the capacity, above which a pour cannot end well whatever the errors of the capacity."""
_MOST_IN_CUP = 1000
"""The largest N_pour there may be."""
REPOSE = 0.5
"""Slope of a heap under the stream. The simulated table's is 0.26 (104 candies in a loaf tin, two pours:
17 mm high in the middle, its foot 65 mm from there). Real shells may be rougher; 27 degrees is steep for
smooth lentils."""
LIFTED = 0.29
"""How far the foot of a heap, on the side of the nearer wall, stands above the level of the same candies laid
flat: this times slope times radius, if the stream falls halfway between the middle and the wall of a round
mouth. The mean distance from there to a point of the mouth is 0.79 radii, to the nearer wall 0.5."""
_MOUTH_SHARE = 0.1
"""The uppermost tenth of the height tells how wide the mouth is."""
_SHALLOW = 0.5
"""Share of what fits for sure that is poured at least."""
_SDS = 2.0
"""Standard deviations of the capacity that are not counted on; of two fillings, as far below their mean as
they lie apart."""


def plan_amount(capacity: Capacity | None, parameters: Parameters) -> PlannedAmount:
    """Return what to pour.

    What is refused keeps its N_pour, or as many as the cup holds: it may be looked at, though nothing moves.

    Args:
        capacity: of the object; none if it was not filled.
        parameters: what is asked for, the cup and the candy.

    Raises:
        StageError: the amount depends on a capacity that is not known, or the cup cannot hold a candy.
    """
    pouring = parameters.pouring
    if capacity is None:
        _check_amount(parameters)
        return PlannedAmount(pouring.n_pour, None)
    requests = {"safe": SAFE, "half": HALF}
    request = requests.get(pouring.amount) or AmountRequest(pouring.amount, pouring.n_pour)
    amount = reason_amount(request, capacity, parameters)
    n_first = min(pouring.n_pour, cup_limit(parameters)) if amount.refusal else amount.n_per_cup[0]
    return PlannedAmount(n_first, amount)


def _check_amount(parameters: Parameters) -> None:
    """Find out what cannot be poured whatever the object is, before anything is imagined.

    Raises:
        StageError: the amount depends on a capacity that is not asked for, or the cup cannot hold N_pour.
    """
    pouring = parameters.pouring
    if parameters.containability.verdict != "omega":
        return  # it will be known what the object holds, and several cups can be poured
    if pouring.amount in ("safe", "half"):
        raise StageError(
            f"pouring.amount={pouring.amount} needs to know what the object holds; set "
            "containability.verdict=capacity, or pouring.amount=number."
        )
    require_room(parameters)


def is_one_cup_asked_for(parameters: Parameters) -> bool:
    """Whether N_pour candies are likely to go into one cup, as can be told before the object is known."""
    pouring = parameters.pouring
    return pouring.amount in ("up_to", "number") and pouring.n_pour <= cup_limit(parameters)


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
    n_asked = {
        "safe": n_safe,
        "half": n_half,
        "number": request.n_candies,
        "up_to": min(n_safe, request.n_candies),
    }[request.kind]
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
    if request.kind == "number" and n_asked > n_most:
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
    rim = "The rim has gaps"
    if rim_m > 0:
        rim = (
            f"At its lowest the rim is {1000 * rim_m:.0f} mm above the inner floor, less than a candy is "
            f"wide ({1000 * candy_m:.0f} mm)"
        )
    return f"{rim}; a few candies may escape."


def sure_candies(capacity: Capacity, parameters: Parameters) -> float:
    """Return how many fit, laid as flat as shaking lays them, if all errors are against it.

    Less by the fillings' spread, and by the volume of candies that are larger by `risk.candy_spread`.
    """
    least = max(capacity.n_candies - _SDS * capacity.spread, 0.0)
    return least / (1 + parameters.risk.candy_spread) ** 3


def safe_candies(capacity: Capacity, parameters: Parameters) -> int:
    """Return how many candies can be poured without one going over the rim; one at least.

    The capacity is counted after shaking, with the candies level. A pour heaps them under its stream, on the
    side of one wall, where their level is higher, and the last candies fall onto them and jump. So the level
    stays below the rim by the freeboard: what the heap lifts its foot at the wall (`LIFTED`), and a candy's
    diameter for the jump: falling from 10 mm above the rim onto others it keeps at most half of its speed,
    and so jumps a fourth as high, 6 to 8 mm. Below that level lies the same share of the candies below the
    rim as of the volume; those in a heap above the rim do not count.

    A wide, shallow object, or one whose lowest notch is far below what it holds, would have no level left,
    though the chosen pour heaps the candies away from there: half of what fits for sure is poured.
    """
    freeboard_m = LIFTED * REPOSE * _mouth_radius_m(capacity) + parameters.particle.diameter_m
    below = _share_below(capacity, capacity.rim_height_m - freeboard_m)
    share = max(below * capacity.n_level / max(capacity.n_candies, 1.0), _SHALLOW)
    return max(int(share * sure_candies(capacity, parameters)), 1)


def _share_below(capacity: Capacity, height_m: float) -> float:
    """Share of the hollow's volume below a height above its floor; zero without a hollow."""
    if capacity.rim_height_m <= 0:
        return 0.0
    below_ml = np.interp(height_m, capacity.heights_m, capacity.volumes_ml)
    return float(below_ml / capacity.volumes_ml[-1])


def _mouth_radius_m(capacity: Capacity) -> float:
    """Radius of the circle as large as the mouth."""
    if capacity.rim_height_m <= 0:
        return 0.0
    upper_m = _MOUTH_SHARE * capacity.rim_height_m
    upper_ml = (1 - _share_below(capacity, capacity.rim_height_m - upper_m)) * float(capacity.volumes_ml[-1])
    return sqrt(upper_ml * 1e-6 / upper_m / pi)
