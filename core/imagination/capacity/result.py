"""What the imagined filling finds: frozen, and able to save and load itself."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from core.files import read_arrays, read_json, write_arrays, write_json
from core.geometry import FloatArray
from core.imagination.hollow_map import HollowMap
from core.imagination.recording import Recording

CAPACITY_FILE = "capacity.json"
_ARRAYS = "capacity.npz"
_OUTWARDS, _OUTWARDS_THIN = 0.6, 1.2
"""A scan's hollows are too small: by so much of what parts them from the least volume (decision 0042).

That one lies a third of the surface's error further in, so this is a fifth of it, further out; two fifths
where walls are thin (decision 0057).
"""


@dataclass(frozen=True)
class Capacity:
    """How much an object at rest holds.

    Attributes:
        n_candies: candies that stay when it was filled until they ran over and then perturbed (Sec. III-A).
        spread: standard deviation of `n_candies` between the fillings; zero with one.
        volume_ml: filled level: the bulk volume of those that lie below the rim, so what they take up with
            the gaps between them, and the volume of water that would stand as high. Number times a candy's
            volume over the share that candies fill in bulk, which is lower near walls (`packing.py`).
        heaped_ml: the same of those above the rim, in a heap or where nothing is closed all around.
        geometric_volume_ml: water that stays in all hollows of the surface: none runs over or out of a gap.
        candy_hollow_ml: the same for what is as thick as a candy and cannot pass narrower gaps.
        candy_scale: cube root of the volume of what was poured in the imagination over a candy's; 1: candies.
        stand_in_diameter_m: of the balls poured in place of candies; none where candies were poured.
        n_poured: particles poured in each filling, of `candy_scale`.
        n_full: of these inside before the perturbations.
        n_kept: of these inside at the end.
        rim_height_m: from the inner floor to where candies run over; zero without a hollow.
        fill_height_m: from the inner floor to the level of `volume_ml`; zero without a hollow.
        explanation: why `filled_ml` and `geometric_volume_ml` differ; empty where they agree.
        heights_m: (K,) above the inner floor, rising from zero; empty without a hollow.
        volumes_ml: (K,) volume below each height.
        candies_per_ml: in bulk, in this object.
        recording: the first filling, to look at; None if nothing was poured.
        least_ml: level volume if the surface errs inwards as far as it may; none if it was not scanned.
        most_ml: the same outwards; none likewise, and where part of the inside was not seen.
        unseen_ml: of the inside, at least; zero if all was seen.
        is_hollow_told: whether balls stood for candies, and what they filled makes a container: then all of
            the hollow for candies is told. A few large balls leave more of a narrow one empty.
        hidden_ml: what the hollow for candies holds more if all that no view saw of it is hollow; zero if all
            was seen, and of what is no container either way.
        hollows: for candies, seen from above; none in sessions of earlier versions.
        is_thin: whether it was scanned and its walls are about as thin as a scan can tell: they come out too
            thick then, and the hollow too small.
        too_small_m: size of candies that would fall through its openings; none if half as large ones stay.
    """

    n_candies: float
    spread: float
    volume_ml: float
    heaped_ml: float
    geometric_volume_ml: float
    candy_hollow_ml: float
    candy_scale: float
    n_poured: tuple[int, ...]
    n_full: tuple[float, ...]
    n_kept: tuple[float, ...]
    rim_height_m: float
    fill_height_m: float
    explanation: str
    heights_m: FloatArray
    volumes_ml: FloatArray
    candies_per_ml: float
    recording: Recording | None
    stand_in_diameter_m: float | None = None
    least_ml: float | None = None
    most_ml: float | None = None
    unseen_ml: float = 0.0
    is_hollow_told: bool = False
    hidden_ml: float = 0.0
    too_small_m: float | None = None
    hollows: HollowMap | None = None
    is_thin: bool = False

    @property
    def n_level(self) -> float:
        """Of `n_candies`, those below the rim: what fits without a heap."""
        return self.volume_ml * self.candies_per_ml

    @property
    def level_ml(self) -> float:
        """The true object's level volume, as near as can be told (decisions 0042 and 0045).

        What scans usually lose is added, and what no view saw: hollows seldom end where a view does.
        """
        if self.least_ml is None:
            return self.filled_ml + self.hidden_ml
        outwards = _OUTWARDS_THIN if self.is_thin else _OUTWARDS
        return self.filled_ml + outwards * (self.filled_ml - self.least_ml) + self.hidden_ml

    @property
    def level_candies(self) -> float:
        """`level_ml` in candies."""
        return self.level_ml * self.candies_per_ml

    @property
    def filled_ml(self) -> float:
        """What is filled level, as told of the surface: `volume_ml`, or all of the hollow."""
        return self.candy_hollow_ml if self.is_hollow_told else self.volume_ml

    @property
    def bulk_ml(self) -> float:
        """Bulk volume of all that stay, the heap included."""
        return self.volume_ml + self.heaped_ml

    @property
    def remark(self) -> str:
        """What to know about the figures: what was poured if it was not candies, and `explanation`."""
        poured = ""
        if self.stand_in_diameter_m is not None:
            diameter_mm, n_candies = 1000 * self.stand_in_diameter_m, self.candy_scale**3
            poured = f"Filled with balls of {diameter_mm:.0f} mm, each in place of {n_candies:.0f} candies."
        return " ".join(filter(None, (self.between, poured, self.explanation)))

    @property
    def between(self) -> str:
        """How far the level volume can be trusted, in a sentence; empty if the surface was not scanned."""
        if self.least_ml is None:
            return ""
        if self.most_ml is None:
            said = f"At least {self.least_ml:.0f} ml level; "
            if self.hidden_ml > 0:
                return f"{said}{self.hidden_ml:.0f} ml more were not seen and count as hollow, too."
            return f"{said}{self.unseen_ml:.0f} ml more inside were not seen."
        return f"As closely as the scan tells: {self.least_ml:.0f} to {self.most_ml:.0f} ml level."

    def level_of(self, n_candies: float) -> float:
        """Return the height above the inner floor (m) that a number of candies reaches; never above the rim.

        Monotone; from the curve of height and volume of the surface. Zero without a hollow.
        """
        if not len(self.heights_m):
            return 0.0
        return float(np.interp(n_candies / self.candies_per_ml, self.volumes_ml, self.heights_m))

    def share_of(self, n_candies: float) -> float:
        """Return which share of the height from inner floor to rim a number of candies fills, 0 to 1."""
        return self.level_of(n_candies) / self.rim_height_m if self.rim_height_m > 0 else 0.0

    def to_table(self) -> dict[str, Any]:
        """Return plain JSON: all but the curve, the recording and the hollows."""
        in_arrays = {"heights_m", "volumes_ml", "recording", "hollows"}
        return {one.name: getattr(self, one.name) for one in fields(self) if one.name not in in_arrays}

    def save(self, folder: Path) -> None:
        """Write `capacity.json` and `capacity.npz` into an existing folder."""
        write_json(folder / CAPACITY_FILE, self.to_table())
        recorded = {} if self.recording is None else self.recording.to_arrays()
        seen = {} if self.hollows is None else self.hollows.to_arrays()
        write_arrays(
            folder / _ARRAYS, heights_m=self.heights_m, volumes_ml=self.volumes_ml, **recorded, **seen
        )

    @classmethod
    def load(cls, folder: Path) -> Capacity:
        """Read what `save` wrote.

        Raises:
            SessionError: a file is missing or damaged.
        """
        table, arrays = read_json(folder / CAPACITY_FILE), read_arrays(folder / _ARRAYS)
        for name in ("n_poured", "n_full", "n_kept"):
            table[name] = tuple(table[name])
        table["heights_m"], table["volumes_ml"] = arrays["heights_m"], arrays["volumes_ml"]
        table["recording"] = Recording.from_arrays(arrays) if "time_s" in arrays else None
        table["hollows"] = HollowMap.from_arrays(arrays) if "hollow_pitch_m" in arrays else None
        return cls(**table)
