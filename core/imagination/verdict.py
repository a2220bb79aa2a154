"""Whether an object is an open container, by what it holds: a verdict that a person can check."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

_TILTED = ("n_load", "holds_rad")


@dataclass(frozen=True)
class Verdict:
    """What an object holds, held against its own size (docs/decisions/0015).

    Attributes:
        capacity_share: bulk volume of the candies that stay in it, filled until it ran over and then
            perturbed, as a share of the volume of its convex hull: how much of it is room that holds. Zero
            where not one of them lies below a rim (docs/decisions/0059).
        threshold: `capacity_share` above which it is an open container.
        n_candies: the same in candies.
        volume_ml: the same in ml.
        level_candies: that the true object holds below its rim, as near as can be told; none in records of
            earlier versions.
        level_ml: the same in ml, which is water that stands as high; none likewise.
        has_stand_ins: whether larger balls were filled in place of candies: what they heap is no heap of
            candies.
        unseen_ml: volume behind its openings that no view saw; zero if that could not matter.
        least_ml: what `level_ml` truly is at least, by what the scan leaves open; none if it was not scanned.
        most_ml: and at most; none likewise, and where part of the inside was not seen.
        too_small_m: size of candies that would fall through its openings; none if half as large ones stay.
        other_share: `capacity_share` if the unseen is not solid, which could change the answer; else none.
    """

    capacity_share: float
    threshold: float
    n_candies: float
    volume_ml: float
    level_candies: float | None = None
    level_ml: float | None = None
    has_stand_ins: bool = False
    unseen_ml: float = 0.0
    other_share: float | None = None
    least_ml: float | None = None
    most_ml: float | None = None
    too_small_m: float | None = None

    @property
    def is_container(self) -> bool:
        """Whether what it holds makes it an open container, whatever the unseen is."""
        return self.capacity_share > self.threshold and not self.is_undecided

    @property
    def is_undecided(self) -> bool:
        """Whether the answer depends on what no view saw."""
        if self.other_share is None:
            return False
        return (self.other_share > self.threshold) != (self.capacity_share > self.threshold)

    def to_table(self) -> dict[str, Any]:
        """Return plain JSON."""
        return asdict(self)

    @classmethod
    def from_table(cls, table: dict[str, Any]) -> Verdict:
        """Read what `to_table` gave, also that of earlier versions, which tilted the object first."""
        return cls(**{name: value for name, value in table.items() if name not in _TILTED})
