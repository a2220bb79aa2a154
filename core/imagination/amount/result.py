"""How many candies go into the cup: what is asked for, what was reasoned, and both in words."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

from core.errors import InputError, SessionError
from core.files import read_json, write_json

AMOUNT_FILE = "amount.json"
MOST_ASKED = 99_999
"""More candies weigh 90 kg."""


@dataclass(frozen=True)
class AmountRequest:
    """How much shall be poured.

    Attributes:
        kind: "up_to": `n_candies`, or as many as safely fit if these are fewer; "number": `n_candies`
            whatever fits; "safe": as many as safely fit; "half": half full.
        n_candies: the number asked for; zero where none is.

    Raises:
        InputError: the number asked for is not from 1 to `MOST_ASKED`.
    """

    kind: Literal["up_to", "number", "safe", "half"]
    n_candies: int = 0

    def __post_init__(self) -> None:
        if self.kind in _WITH_NUMBER and not 1 <= self.n_candies <= MOST_ASKED:
            raise InputError(
                f"{self.n_candies} candies cannot be poured; ask for a whole number from 1 to {MOST_ASKED}."
            )

    def __str__(self) -> str:
        """Return the text from which `parse_amount` makes this request."""
        if self.kind not in _WITH_NUMBER:
            return self.kind
        return f"{_UP_TO} {self.n_candies}" if self.kind == "up_to" else str(self.n_candies)


_WITH_NUMBER = ("up_to", "number")
_UP_TO = "up to"
SAFE, HALF = AmountRequest("safe"), AmountRequest("half")


def parse_amount(text: str) -> AmountRequest:
    """Return what a text asks for: "safe", "half", a whole number of candies, or "up to" such a number.

    Raises:
        InputError: it is none of these.
    """
    word = text.strip().lower()
    for request in (SAFE, HALF):
        if word == request.kind:
            return request
    is_limit = word.startswith(f"{_UP_TO} ")
    number = word.removeprefix(_UP_TO).strip() if is_limit else word
    digits = number.removeprefix("-")
    if not (digits.isascii() and digits.isdecimal()) or len(digits) > len(str(MOST_ASKED)):
        raise InputError(
            f'The amount "{text}" is none that can be poured; say "safe" for as much as safely fits, "half" '
            f"for half full, or a whole number of candies from 1 to {MOST_ASKED}."
        )
    return AmountRequest("up_to" if is_limit else "number", int(number))


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


@dataclass(frozen=True)
class PlannedAmount:
    """What goes into the first cup.

    Attributes:
        n_pour: N_pour of the pouring imagination: candies in the first cup, which is the fullest.
        amount: the reasoning behind it; none if it is not known what the object holds.
    """

    n_pour: int
    amount: Amount | None

    @property
    def n_per_cup(self) -> tuple[int, ...]:
        """Candies in each cup; where it is not known what the object holds, it is one cup."""
        known = None if self.amount is None else self.amount.n_per_cup
        return known or (self.n_pour,)

    def save(self, folder: Path) -> None:
        """Write `amount.json`."""
        table = None if self.amount is None else self.amount.to_table()
        write_json(folder / AMOUNT_FILE, {"n_pour": self.n_pour, "amount": table})

    @classmethod
    def load(cls, folder: Path) -> PlannedAmount:
        """Read what `save` wrote."""
        table = read_json(folder / AMOUNT_FILE)
        amount = table["amount"]
        return cls(table["n_pour"], None if amount is None else Amount.from_table(amount))


def amount_sentence(amount: Amount) -> str:
    """Return what to put into the cup and how full the object becomes, or the refusal; without the warning.

    For example: "Put 60 candies into the cup: they fill it to 40 % of its height (31 % of the 192 that fit)."
    """
    if amount.refusal:
        return amount.refusal
    if amount.n_cups == 1:
        put = f"Put {candies(amount.n_total)} into the cup"
    else:
        counts = [str(n) for n in amount.n_per_cup]
        put = f"Pour {amount.n_cups} cups of {', '.join(counts[:-1])} and {counts[-1]} candies"
    they = "it fills" if amount.n_total == 1 else "they fill"
    share = f"{100 * amount.share_of_capacity:.0f} % of the {amount.n_fit} that fit"
    if amount.fill_share <= 0:
        said = f"{put}: {share}."
    elif amount.fill_share >= 1:
        said = f"{put}: {they} it to its rim ({share})."
    else:
        said = f"{put}: {they} it to {100 * amount.fill_share:.0f} % of its height ({share})."
    return f"{said} {_why_fewer(amount)}".strip()


def _why_fewer(amount: Amount) -> str:
    """Why it is less than was asked for at most; empty if it is not."""
    request = parse_amount(amount.request)
    if request.kind != "up_to" or amount.n_total == request.n_candies or amount.n_total < amount.n_safe:
        return ""
    return f"{candies(request.n_candies)} were asked for; only {amount.n_safe} fit safely."


def amount_text(amount: Amount) -> str:
    """Return the sentence of an amount with its warning, or its refusal."""
    return f"{amount_sentence(amount)} {amount.warning}".strip()


def candies(n: int) -> str:
    """Return a number of candies in words."""
    return "1 candy" if n == 1 else f"{n} candies"
