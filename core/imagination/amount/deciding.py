"""The amount that the parameters ask for, and the parameters with it."""

from __future__ import annotations

from core.errors import StageError
from core.imagination.amount.reason import cup_limit, reason_amount
from core.imagination.amount.request import HALF, SAFE, AmountRequest
from core.imagination.amount.result import Amount
from core.imagination.capacity.result import Capacity
from core.parameters import Parameters


def is_number_in_one_cup(parameters: Parameters) -> bool:
    """Whether N_pour is known before the object is, for a number is asked for that the cup holds."""
    return parameters.pouring.amount == "number" and parameters.pouring.n_pour <= cup_limit(parameters)


def decide_amount(capacity: Capacity | None, parameters: Parameters) -> tuple[Amount | None, Parameters]:
    """Return what to pour, and the parameters with the N_pour of the first cup, which is the fullest.

    What is refused keeps its N_pour, or as many as the cup holds: it may be looked at, though nothing moves.

    Args:
        capacity: of the object; none if it was not filled.
        parameters: what is asked for, the cup and the candy.

    Raises:
        StageError: the amount depends on a capacity that is not known, or the cup cannot hold a candy.
    """
    pouring = parameters.pouring
    if capacity is None:
        if pouring.amount != "number" and parameters.containability.verdict == "omega":
            raise StageError(
                f"pouring.amount={pouring.amount} needs to know what the object holds; set "
                "containability.verdict=capacity, or pouring.amount=number."
            )
        return None, parameters
    wishes = {"safe": SAFE, "half": HALF, "number": AmountRequest("number", pouring.n_pour)}
    amount = reason_amount(wishes[pouring.amount], capacity, parameters)
    n_first = min(pouring.n_pour, cup_limit(parameters)) if amount.refusal else amount.n_per_cup[0]
    own = pouring.model_copy(update={"n_pour": n_first})
    return amount, parameters.model_copy(update={"pouring": own})
