"""Raw answers of the people who were asked about each object, and the majority rule of Sec. IV-B."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from core.errors import InputError

COLUMNS = ("object", "annotator", "contains", "pourable")
_YES, _NO = ("1", "yes", "true", "y"), ("0", "no", "false", "n")


@dataclass(frozen=True)
class Agreement:
    """What the people who were asked about one object said.

    Attributes:
        n_container: said that it can hold candies and that they could pour them in.
        n_asked: people.
    """

    n_container: int
    n_asked: int

    @property
    def is_container(self) -> bool:
        """More than half said so: 3 of 5 (Sec. IV-B)."""
        return 2 * self.n_container > self.n_asked

    @property
    def share(self) -> float:
        """Share of the people who agree with the majority."""
        return max(self.n_container, self.n_asked - self.n_container) / self.n_asked


def is_answer_table(row: Mapping[str, str | None]) -> bool:
    """Whether a CSV's row has the columns of raw answers."""
    return all(column in row for column in COLUMNS)


def majority(path: Path, rows: Sequence[Mapping[str, str | None]]) -> dict[str, Agreement]:
    """Sum up raw answers by object, in the order of the file.

    Args:
        path: the file, to be named in errors.
        rows: with `COLUMNS`; an answer is 1 or 0, yes or no, true or false.

    Raises:
        InputError: an answer cannot be read, an annotator answered twice, or the answers to an object are
            split evenly.
    """
    votes: dict[str, dict[str, bool]] = {}
    for row in rows:
        name, annotator = ((row.get(column) or "").strip() for column in COLUMNS[:2])
        contains, pourable = (_answer(path, row, column) for column in COLUMNS[2:])
        if not name or not annotator:
            raise InputError(f"In {path}, the row {dict(row)} lacks the object or the annotator.")
        if annotator in votes.setdefault(name, {}):
            raise InputError(f"In {path}, '{annotator}' answers twice about '{name}'; leave one row out.")
        votes[name][annotator] = contains and pourable
    found = {name: Agreement(sum(said.values()), len(said)) for name, said in votes.items()}
    for name, agreement in found.items():
        if 2 * agreement.n_container == agreement.n_asked:
            raise InputError(
                f"In {path}, the {agreement.n_asked} answers about '{name}' are split evenly; ask one more "
                "person, or give labels instead of answers."
            )
    return found


def _answer(path: Path, row: Mapping[str, str | None], column: str) -> bool:
    text = (row.get(column) or "").strip().lower()
    if text not in _YES + _NO:
        raise InputError(
            f"In {path}, '{text}' in the column {column} is no answer; write 1 or 0 (or yes or no)."
        )
    return text in _YES
