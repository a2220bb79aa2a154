"""Which of an amount's cups a run poured, and which comes next, by the runs that were made already."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from core.session.pour_runs import PourRun, pour_runs


@dataclass(frozen=True)
class Cup:
    """One of the cups that are poured into the object, one after the other.

    Attributes:
        number: from 1.
        n_cups: in all.
        n_candies: in this one.
        before: the run that poured the cup before, whose candies lie in the object; none for the first.
    """

    number: int
    n_cups: int
    n_candies: int
    before: Path | None

    @property
    def words(self) -> str:
        """Which one it is, for people; empty if there is but one."""
        return (
            f"cup {self.number} of {self.n_cups}, {self.n_candies} candies in it" if self.n_cups > 1 else ""
        )


def next_cup(session: Path, imagination: str, n_per_cup: Sequence[int]) -> Cup:
    """Return the cup to be poured next.

    After the last one, and once the object was emptied, it is the first again, into an empty object.

    Args:
        session: the session's folder.
        imagination: digest of the imagined pours.
        n_per_cup: candies in each cup, at least one cup.
    """
    return _cup(_made(session, imagination), n_per_cup)


def cup_of_run(session: Path, run: Path, n_per_cup: Sequence[int]) -> Cup:
    """Return the cup that a run of the session poured."""
    return _cup(_made(session, PourRun.load(run).imagination, before=run.name), n_per_cup)


def _made(session: Path, imagination: str, before: str | None = None) -> list[Path]:
    """Runs whose candies may lie in the object, with this imagination."""
    made: list[Path] = []
    for run in pour_runs(session):
        if before is not None and run.folder.name >= before:
            break
        if run.is_done and not run.is_back_off and run.imagination == imagination:
            made.append(run.folder)
        if run.was_emptied:
            made.clear()
    return made


def _cup(made: Sequence[Path], n_per_cup: Sequence[int]) -> Cup:
    index = len(made) % len(n_per_cup)
    return Cup(index + 1, len(n_per_cup), n_per_cup[index], made[-1] if index else None)
