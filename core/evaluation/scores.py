"""What a set of parameters is worth: how many objects it judges right, and by what margin."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from core.evaluation.labels import LabelledObject
from core.evaluation.verdicts import ObjectVerdict


@dataclass(frozen=True)
class Score:
    """Of the labelled objects that were judged; ambiguous ones do not count.

    Attributes:
        n_judged: objects with a verdict.
        n_right: those judged right.
        n_failed: labelled objects that could not be judged; they are not among the judged.
        smallest_container: (Omega, name) of the container that keeps least; none without one.
        largest_other: (Omega, name) of the non-container that keeps most; none without one.
    """

    n_judged: int
    n_right: int
    n_failed: int
    smallest_container: tuple[float, str] | None
    largest_other: tuple[float, str] | None

    @property
    def accuracy(self) -> float | None:
        """Share judged right; none if nothing was judged."""
        return self.n_right / self.n_judged if self.n_judged else None

    @property
    def margin(self) -> float | None:
        """How far the containers' Omega stays above the others'; negative where they overlap."""
        if self.smallest_container is None or self.largest_other is None:
            return None
        return self.smallest_container[0] - self.largest_other[0]


def is_right(label: str, omega: float, threshold: float) -> bool | None:
    """Whether a verdict agrees with a label; none for an ambiguous object."""
    return None if label == "ambiguous" else (omega > threshold) == (label == "container")


def score(
    objects: Iterable[LabelledObject], verdicts: Mapping[str, ObjectVerdict], threshold: float
) -> Score:
    """Sum up the verdicts of one set of parameters.

    Args:
        objects: all of them.
        verdicts: by the objects' names; what was not judged yet is not there.
        threshold: Omega_thr.
    """
    labelled = [one for one in objects if one.label != "ambiguous" and one.name in verdicts]
    omegas = {one.name: verdicts[one.name].omega for one in labelled}
    judged = [(one, omega) for one in labelled if (omega := omegas[one.name]) is not None]
    containers = [(omega, one.name) for one, omega in judged if one.label == "container"]
    others = [(omega, one.name) for one, omega in judged if one.label != "container"]
    return Score(
        len(judged),
        sum(bool(is_right(one.label, omega, threshold)) for one, omega in judged),
        len(labelled) - len(judged),
        min(containers, default=None),
        max(others, default=None),
    )
