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
        smallest_container: (score, name) of the container with the smallest; none without one.
        largest_other: (score, name) of the non-container with the largest; none without one.
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
        """How far the containers' score stays above the others'; negative where they overlap."""
        if self.smallest_container is None or self.largest_other is None:
            return None
        return self.smallest_container[0] - self.largest_other[0]


def is_right(label: str, found: float, threshold: float) -> bool | None:
    """Whether a score, held against its threshold, agrees with a label; none for an ambiguous object."""
    return None if label == "ambiguous" else (found > threshold) == (label == "container")


def score(
    objects: Iterable[LabelledObject], verdicts: Mapping[str, ObjectVerdict], threshold: float
) -> Score:
    """Sum up the verdicts of one set of parameters.

    Args:
        objects: all of them.
        verdicts: by the objects' names; what was not judged yet is not there.
        threshold: of what judges: a capacity share, or Omega_thr.
    """
    labelled = [one for one in objects if one.label != "ambiguous" and one.name in verdicts]
    scores = {one.name: verdicts[one.name].score for one in labelled}
    judged = [(one, found) for one in labelled if (found := scores[one.name]) is not None]
    containers = [(found, one.name) for one, found in judged if one.label == "container"]
    others = [(found, one.name) for one, found in judged if one.label != "container"]
    return Score(
        len(judged),
        sum(bool(is_right(one.label, found, threshold)) for one, found in judged),
        len(labelled) - len(judged),
        min(containers, default=None),
        max(others, default=None),
    )
