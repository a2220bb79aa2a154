"""What was reasoned of the amount: frozen, and a table for the session and the command line."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from core.errors import SessionError
from core.files import read_json
from core.imagination.results import imagined_n_pour

AMOUNT_FILE = "amount.json"


@dataclass(frozen=True)
class Amount:
    """How many candies go into the object, and how they come there.

    Attributes:
        request: what was asked for, as `parse_amount` reads it.
        n_fit: candies that the object holds, to the nearest.
        n_safe: as many as safely fit.
        n_total: candies that go into the object; zero if it is refused.
        n_per_cup: how many in each cup, one poured after the other; empty if it is refused. The first is the
            largest: the N_pour of the pouring imagination.
        fill_share: share of the height from the inner floor to the rim that they fill, 0 to 1. At 1 they
            reach the rim's lowest place; zero is also where nothing is closed all around.
        fill_height_m: the same as a height above the inner floor.
        share_of_capacity: of the candies that the object holds; above 1 more than it does.
        warning: what may go wrong, in a sentence; or empty.
        refusal: why nothing may move, in a sentence; or empty.
    """

    request: str
    n_fit: int
    n_safe: int
    n_total: int
    n_per_cup: tuple[int, ...]
    fill_share: float
    fill_height_m: float
    share_of_capacity: float
    warning: str
    refusal: str

    @property
    def n_cups(self) -> int:
        """Cups to be poured."""
        return len(self.n_per_cup)

    def to_table(self) -> dict[str, Any]:
        """Return the table of the command-line contract."""
        return {**asdict(self), "n_per_cup": list(self.n_per_cup), "n_cups": self.n_cups}

    @classmethod
    def from_table(cls, table: dict[str, Any]) -> Amount:
        """Read what `to_table` returned.

        Raises:
            SessionError: an entry is missing or unknown.
        """
        known = {name: value for name, value in table.items() if name != "n_cups"}
        try:
            return cls(**{**known, "n_per_cup": tuple(table["n_per_cup"])})
        except (KeyError, TypeError) as error:
            raise SessionError(
                f"The table of the amount is damaged ({error}); reason the amount again."
            ) from error


def imagined_cups(folder: Path) -> tuple[int, ...]:
    """Return the candies in each cup that the pours in `folder` were imagined for; empty if there are none.

    Where it is not known what the object holds, it is one cup.
    """
    path = folder / AMOUNT_FILE
    amount = Amount.from_table(read_json(path)) if path.is_file() else None
    if amount is not None and amount.n_per_cup:
        return amount.n_per_cup
    n_pour = imagined_n_pour(folder)
    return () if n_pour is None else (n_pour,)
