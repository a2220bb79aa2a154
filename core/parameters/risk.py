"""Parameters of the choice that knows its risk: what may be wrong in the set-up, and how often to try."""

from __future__ import annotations

from math import radians

from core.parameters.fields import OURS, PAPER, Group, quantity

_SET_UP = f"{OURS}: calibration and closing fingers, an estimate"


class RiskParameters(Group):
    """Pours imagined again with errors of the set-up; the choice is the pour least likely to spill."""

    n_tries: int = quantity(
        24,
        "Most imagined pours with errors, spent on the most promising of the 24, and as many again on the "
        "surest where it seems to be as clean as wanted; 0: none, and the paper's rule chooses.",
        unit="",
        source=f"{OURS}: docs/decisions/0014; {PAPER}, Sec. III-B: 0",
        low=0,
        high=5000,
    )
    sure: float = quantity(
        0.8,
        "Chance of spilling nothing, as its lower 95 % bound, at which no more pours are tried.",
        unit="",
        source=OURS,
        low=0,
        high=0.999,
    )
    wanted_clean: float = quantity(
        0.6,
        "Chance of spilling nothing, as its lower 95 % bound, below which pouring is not advised and has to "
        "be asked for explicitly; 0: it is never advised against.",
        unit="",
        source=f"{OURS}: docs/decisions/0022",
        low=0,
        high=0.999,
    )
    object_error_m: float = quantity(
        0.001,
        "SD along x and y of where the object stands; a scan with worse poses raises it.",
        unit="m",
        source=_SET_UP,
        low=0,
        high=0.05,
    )
    object_error_rad: float = quantity(
        radians(0.5),
        "SD of the object's turn about the vertical.",
        unit="rad",
        source=_SET_UP,
        low=0,
        high=radians(30),
    )
    cup_error_m: float = quantity(
        0.001,
        "SD along each axis of how the cup sits in the hand.",
        unit="m",
        source=_SET_UP,
        low=0,
        high=0.05,
    )
    cup_error_rad: float = quantity(
        radians(0.5),
        "SD of the cup's lean about each horizontal axis.",
        unit="rad",
        source=_SET_UP,
        low=0,
        high=radians(30),
    )
    candy_spread: float = quantity(
        0.05,
        "The candies of a try are larger or smaller by up to this share, all alike.",
        unit="",
        source=f"{OURS}: an estimate for sorted sweets",
        low=0,
        high=0.4,
    )

    @property
    def sure_enough(self) -> float:
        """The lower 95 % bound at which no more pours are tried: never less than what is wanted."""
        return max(self.sure, self.wanted_clean)
