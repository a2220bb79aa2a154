"""What the two imaginations find: frozen, and able to save and load themselves."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import atan2, pi
from pathlib import Path
from typing import Any

import numpy as np

from core.files import read_arrays, read_json, write_arrays, write_json
from core.geometry import AnyArray, BoolArray, FloatArray, IntArray
from core.imagination.recording import Recording
from core.imagination.verdict import Verdict

DROP_FILE, POURS_FILE = "containability.json", "pours.json"


@dataclass(frozen=True)
class Footprint:
    """Where the candies fell from that stayed (Sec. III-A); below the plane E's origin (Sec. III-B).

    Attributes:
        center_m: (3,) p_E, at the height of the top of the object's AABB.
        axis_rad: angle of the principal axis of largest variance against x, in [-pi/2, pi/2).
        deviations_m: (2,) standard deviations along the principal axes, larger first.
    """

    center_m: FloatArray
    axis_rad: float
    deviations_m: FloatArray

    @classmethod
    def of(cls, positions_m: FloatArray, top_m: float) -> Footprint:
        """Compute from the (n, 2) drop positions of the candies that stayed, n >= 1."""
        center = positions_m.mean(axis=0)
        variances, axes = np.linalg.eigh(np.cov(positions_m.T, bias=True))
        x, y = axes[:, 1]
        angle = (atan2(y, x) + pi / 2) % pi - pi / 2
        deviations = np.sqrt(np.clip(variances[::-1], 0, None))
        return cls(np.array([*center, top_m]), angle, deviations)

    def raised(self, height_m: float) -> Footprint:
        """Return the same at a height above: with the pivots' height it is the plane E of the pours."""
        return replace(self, center_m=self.center_m + np.array([0.0, 0.0, height_m]))


@dataclass(frozen=True)
class Drop:
    """Result of the drop (Sec. III-A), before anything is concluded from it.

    Attributes:
        drop_positions_m: (n_drop, 3) centres at the start.
        retained: (n_drop,) whether the candy was inside the object's AABB at the end.
        aabb_m: (2, 3) lower and upper corner of the object's AABB.
        footprint: None when nothing stayed.
        recording: the drop, to look at.
    """

    drop_positions_m: FloatArray
    retained: BoolArray
    aabb_m: FloatArray
    footprint: Footprint | None
    recording: Recording

    @property
    def n_drop(self) -> int:
        """Candies dropped."""
        return len(self.retained)

    @property
    def n_in(self) -> int:
        """N_in: candies retained."""
        return int(self.retained.sum())

    @property
    def omega(self) -> float:
        """Omega (Eq. 1)."""
        return self.n_in / self.n_drop

    def judged(self, omega_threshold: float, verdict: Verdict | None) -> Containability:
        """Return the drop with the verdict on the object."""
        return Containability(**vars(self), omega_threshold=omega_threshold, verdict=verdict)

    def save(self, folder: Path) -> None:
        """Write `containability.json` and `drop.npz`."""
        footprint = self.footprint
        table: dict[str, Any] = {
            "omega": self.omega,
            "n_drop": self.n_drop,
            "n_in": self.n_in,
            "aabb_m": self.aabb_m.tolist(),
            "footprint": None
            if footprint is None
            else {
                "center_m": footprint.center_m.tolist(),
                "axis_rad": footprint.axis_rad,
                "deviations_m": footprint.deviations_m.tolist(),
            },
        }
        write_json(folder / DROP_FILE, table)
        write_arrays(
            folder / "drop.npz",
            drop_positions_m=self.drop_positions_m,
            retained=self.retained,
            **self.recording.to_arrays(),
        )

    @classmethod
    def load(cls, folder: Path) -> Drop:
        """Read what `save` wrote."""
        table = read_json(folder / DROP_FILE)
        arrays = read_arrays(folder / "drop.npz")
        found, aabb_m = table["footprint"], np.array(table["aabb_m"])
        footprint = None
        if found is not None:
            # Earlier versions wrote the height of the plane E here, which is the pours' business.
            center_m = np.array([*found["center_m"][:2], aabb_m[1, 2]])
            footprint = Footprint(center_m, found["axis_rad"], np.array(found["deviations_m"]))
        return Drop(
            arrays["drop_positions_m"], arrays["retained"], aabb_m, footprint, Recording.from_arrays(arrays)
        )


@dataclass(frozen=True, kw_only=True)
class Containability(Drop):
    """Open containability (Sec. III-A): the drop, and what follows from it.

    Attributes:
        omega_threshold: Omega_thr that Omega is held against.
        verdict: by what the object holds; none if Omega decides.
    """

    omega_threshold: float
    verdict: Verdict | None = None

    @property
    def is_open_container(self) -> bool:
        """The verdict: by what the object holds, or by Omega."""
        return self.exceeds_omega if self.verdict is None else self.verdict.is_container

    @property
    def is_undecided(self) -> bool:
        """Whether the verdict depends on what no view saw."""
        return self.verdict is not None and self.verdict.is_undecided

    @property
    def exceeds_omega(self) -> bool:
        """The paper's verdict: whether Omega exceeds its threshold."""
        return self.omega > self.omega_threshold


@dataclass(frozen=True)
class PoursSoFar:
    """News: the pours that are imagined so far.

    Attributes:
        theta_rad: (I,) their directions.
        indent_m: (3,) their distances.
        p: (I, 3) particle-in-object ratio P, mean over the packings that are done; NaN where none is.
    """

    theta_rad: FloatArray
    indent_m: FloatArray
    p: FloatArray


@dataclass(frozen=True)
class PourGrid:
    """Result of pouring imagination (Sec. III-B): I directions (8, or 1 with theta fixed) at 3 distances.

    Attributes:
        n_pour: N_pour.
        n_in: (I, 3, packings) candies that count as poured in.
        n_spilled: (I, 3, packings) candies that fell beside the object.
        theta_rad: (I,) direction of the ray from p_E to the pivot, against the world's x-axis.
        indent_m: (3,) L_idt.
        pivot_m: (I, 3, 3) r_pivot of each pour.
        recordings: [i][j], the pour with the first packing.
        n_cups: how many such cups the whole amount takes, one poured after the other; the pours of the grid
            are the first one's, into the empty object.
    """

    n_pour: int
    n_in: IntArray
    n_spilled: IntArray
    theta_rad: FloatArray
    indent_m: FloatArray
    pivot_m: FloatArray
    recordings: tuple[tuple[Recording, ...], ...]
    n_cups: int = 1

    @property
    def p(self) -> FloatArray:
        """(I, 3) particle-in-object ratio P (Eq. 4), mean over the packings."""
        ratio: FloatArray = self.n_in.mean(axis=2) / self.n_pour
        return ratio

    @property
    def p_spread(self) -> FloatArray:
        """(I, 3) standard deviation of P over the packings; zero with one packing."""
        spread: FloatArray = self.n_in.std(axis=2) / self.n_pour
        return spread

    def save(self, folder: Path) -> None:
        """Write `pours.json` and `pours.npz`."""
        table = {
            "n_pour": self.n_pour,
            "n_cups": self.n_cups,
            "p": self.p.tolist(),
            "p_spread": self.p_spread.tolist(),
            "n_in": self.n_in.tolist(),
            "n_spilled": self.n_spilled.tolist(),
            "theta_rad": self.theta_rad.tolist(),
            "indent_m": self.indent_m.tolist(),
            "pivot_m": self.pivot_m.tolist(),
        }
        write_json(folder / POURS_FILE, table)
        arrays: dict[str, AnyArray] = {}
        for i, row in enumerate(self.recordings):
            for j, recording in enumerate(row):
                arrays |= recording.to_arrays(f"pour_{i}_{j}_")
        write_arrays(folder / "pours.npz", **arrays)

    @classmethod
    def load(cls, folder: Path) -> PourGrid:
        """Read what `save` wrote."""
        table = read_json(folder / POURS_FILE)
        arrays = read_arrays(folder / "pours.npz")
        n_in = np.array(table["n_in"], dtype=np.int64)
        recordings = tuple(
            tuple(Recording.from_arrays(arrays, f"pour_{i}_{j}_") for j in range(n_in.shape[1]))
            for i in range(n_in.shape[0])
        )
        return cls(
            table["n_pour"],
            n_in,
            # Sessions from before the two were told apart: what is not in counts as spilled.
            np.array(table["n_spilled"], dtype=np.int64) if "n_spilled" in table else table["n_pour"] - n_in,
            np.array(table["theta_rad"]),
            np.array(table["indent_m"]),
            np.array(table["pivot_m"]),
            recordings,
            table.get("n_cups", 1),
        )


@dataclass(frozen=True)
class PourChoice:
    """The pour to make (Sec. III-B, argmax rule and Eq. 6).

    Attributes:
        i: index of the direction.
        j: index of the distance.
        theta_rad: direction of the ray from p_E to the pivot, against the world's x-axis.
        pivot_m: (3,) r_pivot.
        T_world_cup: (4, 4) initial pose (R_init, t_init) of the cup.
    """

    i: int
    j: int
    theta_rad: float
    pivot_m: FloatArray
    T_world_cup: FloatArray

    def to_table(self) -> dict[str, Any]:
        """Return the table of the command-line contract."""
        return {
            "i": self.i,
            "j": self.j,
            "theta_rad": self.theta_rad,
            "pivot_m": self.pivot_m.tolist(),
            "t_init_m": self.T_world_cup[:3, 3].tolist(),
            "r_init": self.T_world_cup[:3, :3].tolist(),
        }

    @classmethod
    def from_table(cls, table: dict[str, Any]) -> PourChoice:
        """Read what `to_table` gave."""
        T_world_cup = np.eye(4)
        T_world_cup[:3, :3] = table["r_init"]
        T_world_cup[:3, 3] = table["t_init_m"]
        return cls(table["i"], table["j"], table["theta_rad"], np.array(table["pivot_m"]), T_world_cup)
