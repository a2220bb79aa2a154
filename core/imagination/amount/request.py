"""What somebody asks for: as much as safely fits, half full, or a number of candies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from core.errors import InputError

MOST_ASKED = 99_999
"""More candies weigh 90 kg."""


@dataclass(frozen=True)
class AmountRequest:
    """How much shall be poured.

    Attributes:
        wish: "safe": as much as safely fits; "half": half full; "number": `n_candies`.
        n_candies: the number asked for; zero with the other wishes.

    Raises:
        InputError: the number asked for is not from 1 to `MOST_ASKED`.
    """

    wish: Literal["safe", "half", "number"]
    n_candies: int = 0

    def __post_init__(self) -> None:
        if self.wish == "number" and not 1 <= self.n_candies <= MOST_ASKED:
            raise InputError(
                f"{self.n_candies} candies cannot be poured; ask for a whole number from 1 to {MOST_ASKED}."
            )

    def __str__(self) -> str:
        """Return the text from which `parse_amount` makes this request."""
        return str(self.n_candies) if self.wish == "number" else self.wish


SAFE, HALF = AmountRequest("safe"), AmountRequest("half")


def parse_amount(text: str) -> AmountRequest:
    """Return what a text asks for: "safe", "half" or a whole number of candies.

    Raises:
        InputError: it is none of these.
    """
    word = text.strip().lower()
    for request in (SAFE, HALF):
        if word == request.wish:
            return request
    digits = word.removeprefix("-")
    if not (digits.isascii() and digits.isdecimal()) or len(digits) > len(str(MOST_ASKED)):
        raise InputError(
            f'The amount "{text}" is none that can be poured; say "safe" for as much as safely fits, "half" '
            f"for half full, or a whole number of candies from 1 to {MOST_ASKED}."
        )
    return AmountRequest("number", int(word))
