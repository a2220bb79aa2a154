"""What the tilting finds: how firmly an object holds."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees, isinf
from pathlib import Path
from typing import Any

import numpy as np

from core.files import read_arrays, read_json, write_arrays, write_json
from core.geometry import FloatArray, IntArray
from core.imagination.bullet_world import GRAVITY_M_S2

RETENTION_FILE = "holding.json"
_ARRAYS = "holding.npz"
_TENTH, _HALF = 0.1, 0.5


@dataclass(frozen=True)
class Retention:
    """How many candies stay in an object as it is tilted.

    Tilts at which something leaves are the first step at which it was gone, infinite if it never was.

    Attributes:
        n_asked: candies poured onto the footprint, to be the load.
        n_load: the load: those of them that lie inside, fewer where there is no room for all.
        tilt_rad: (S,) tilt of each step, from 0.
        direction_rad: (8,) the side that sinks, against the x-axis; the first along the footprint's principal
            axis.
        n_left: (8, S) candies of the load still inside the object's AABB after each step.
    """

    n_asked: int
    n_load: int
    tilt_rad: FloatArray
    direction_rad: FloatArray
    n_left: IntArray

    @property
    def share_left(self) -> FloatArray:
        """(8, S) share of the load still inside; 0 without a load."""
        share: FloatArray = self.n_left / max(self.n_load, 1)
        return share

    @property
    def share_of_asked(self) -> FloatArray:
        """(8, S) candies left as a share of those asked for: how many the object holds, and how firmly."""
        share: FloatArray = self.n_left / self.n_asked
        return share

    @property
    def mean_share_left(self) -> FloatArray:
        """(S,) the mean retention curve, over the directions."""
        mean: FloatArray = self.share_left.mean(axis=0)
        return mean

    @property
    def worst_share_left(self) -> FloatArray:
        """(S,) the retention curve of the worst direction at each tilt."""
        worst: FloatArray = self.share_left.min(axis=0)
        return worst

    @property
    def first_by_direction_rad(self) -> FloatArray:
        """(8,) tilt at which the first candy has left."""
        return self._leaving_rad(1)

    @property
    def tenth_by_direction_rad(self) -> FloatArray:
        """(8,) tilt at which a tenth of the load has left, at least one candy."""
        return self._leaving_rad(max(_TENTH * self.n_load, 1))

    @property
    def half_by_direction_rad(self) -> FloatArray:
        """(8,) tilt at which half of the load has left, at least one candy."""
        return self._leaving_rad(max(_HALF * self.n_load, 1))

    @property
    def first_rad(self) -> float:
        """Tilt at which the first candy has left, in the worst direction."""
        return float(self.first_by_direction_rad.min())

    @property
    def tenth_rad(self) -> float:
        """Tilt at which a tenth has left, in the worst direction."""
        return float(self.tenth_by_direction_rad.min())

    @property
    def half_rad(self) -> float:
        """Tilt at which half has left, in the worst direction."""
        return float(self.half_by_direction_rad.min())

    @property
    def holds_rad(self) -> float:
        """Largest tilt of the steps at which nothing had left yet, in the worst direction."""
        return float(self.tilt_rad[self.tilt_rad < self.first_rad].max(initial=0.0))

    @property
    def first_m_s2(self) -> float:
        """Slowly growing sideways acceleration at which the first candy has left, in the worst direction."""
        return equivalent_m_s2(self.first_rad)

    @property
    def tenth_m_s2(self) -> float:
        """Slowly growing sideways acceleration at which a tenth has left, in the worst direction."""
        return equivalent_m_s2(self.tenth_rad)

    @property
    def half_m_s2(self) -> float:
        """Slowly growing sideways acceleration at which half has left, in the worst direction."""
        return equivalent_m_s2(self.half_rad)

    def share_at(self, tilt_rad: float) -> FloatArray:
        """Return (8,) the share of the load left at a tilt: that after the first step which reaches it.

        Raises:
            ValueError: the object was not tilted as far.
        """
        shares: FloatArray = self.share_left[:, self._step_at(tilt_rad)]
        return shares

    def kept_of_asked_at(self, tilt_rad: float) -> FloatArray:
        """Return (8,) candies left at a tilt as a share of those asked for, at the step of `share_at`.

        Raises:
            ValueError: the object was not tilted as far.
        """
        shares: FloatArray = self.share_of_asked[:, self._step_at(tilt_rad)]
        return shares

    def to_table(self) -> dict[str, Any]:
        """Return plain JSON: the load and the tilts at which it leaves."""
        names = ("first_rad", "tenth_rad", "half_rad", "first_m_s2", "tenth_m_s2", "half_m_s2")
        leaving = {name: getattr(self, name) for name in names}
        return {
            "n_asked": self.n_asked,
            "n_load": self.n_load,
            "holds_rad": self.holds_rad,
            # JSON has no infinity: null for what did not leave.
            **{name: value if np.isfinite(value) else None for name, value in leaving.items()},
        }

    def save(self, folder: Path) -> None:
        """Write `holding.json` and `holding.npz`."""
        write_json(folder / RETENTION_FILE, self.to_table())
        write_arrays(
            folder / _ARRAYS, tilt_rad=self.tilt_rad, direction_rad=self.direction_rad, n_left=self.n_left
        )

    @classmethod
    def load(cls, folder: Path) -> Retention:
        """Read what `save` wrote."""
        table, arrays = read_json(folder / RETENTION_FILE), read_arrays(folder / _ARRAYS)
        return cls(
            table["n_asked"], table["n_load"], arrays["tilt_rad"], arrays["direction_rad"], arrays["n_left"]
        )

    def _step_at(self, tilt_rad: float) -> int:
        reaching = np.flatnonzero(self.tilt_rad >= tilt_rad - 1e-9)
        if len(reaching) == 0:
            raise ValueError(f"tilted by {self.tilt_rad[-1]:.3f} rad only, not by {tilt_rad:.3f}")
        return int(reaching[0])

    def _leaving_rad(self, n_gone: float) -> FloatArray:
        """(8,) tilt of the first step after which at least `n_gone` candies have left."""
        gone = self.n_load - self.n_left >= n_gone if self.n_load else np.ones(self.n_left.shape, dtype=bool)
        tilts: FloatArray = np.where(gone.any(axis=1), self.tilt_rad[gone.argmax(axis=1)], np.inf)
        return tilts


def equivalent_m_s2(tilt_rad: float) -> float:
    """Return the sideways acceleration that acts as a tilt does, when it grows slowly: g tan(tilt).

    It adds to gravity a force field turned by the same angle and stronger by 1 / cos(tilt). Coulomb friction
    does not ask how strong it is; simulated on four scans, candies left within 9 degrees of the tilt, most
    within 3. A sudden push is another matter: candies that slide through a wide object arrive at its wall
    with speed. One of 0.3 s drove them out of a pan and a bowl at 0.4 of this acceleration, out of a shallow
    tray at the same. At 90 degrees no acceleration is as strong: infinite.
    """
    if tilt_rad >= np.pi / 2 - 1e-9:
        return float("inf")
    return float(GRAVITY_M_S2 * np.tan(tilt_rad))


def retention_sentence(retention: Retention) -> str:
    """Return how far the object may be tilted, in the worst direction.

    For example: "Holds up to 24 degrees: then the first of 31 candies leaves; half are gone at 42 degrees."
    """
    n_load, noun = retention.n_load, "candy" if retention.n_load == 1 else "candies"
    if n_load == 0:
        return f"Holds nothing: of {retention.n_asked} candies poured onto it none stays."
    most = degrees(retention.tilt_rad[-1])
    if isinf(retention.first_rad):
        return f"Nothing falls out, even tilted {most:.0f} degrees."
    before = retention.holds_rad
    if n_load == 1:
        return f"Holds up to {degrees(before):.0f} degrees: then the only candy leaves."
    begun = f"Holds up to {degrees(before):.0f} degrees: then the first of {n_load} {noun} leaves"
    if isinf(retention.half_rad):
        return f"{begun}; more than half stay up to {most:.0f} degrees."
    if retention.half_rad == retention.first_rad:
        return f"{begun}, and at once half of them."
    return f"{begun}; half are gone at {degrees(retention.half_rad):.0f} degrees."
