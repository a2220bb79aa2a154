"""What the two imaginations find: frozen, and able to save and load themselves."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, pi
from pathlib import Path
from typing import Any

import numpy as np

from core.files import read_arrays, read_json, write_arrays, write_json
from core.geometry import AnyArray, BoolArray, FloatArray, IntArray
from core.imagination.recording import Recording
from core.imagination.verdict import Verdict


@dataclass(frozen=True)
class Footprint:
    """Where the candies fell from that stayed (Sec. III-A); origin and axes of the plane E (Sec. III-B).

    Attributes:
        center_m: (3,) p_E and z_E.
        axis_rad: angle of the principal axis of largest variance against x, in [-pi/2, pi/2).
        deviations_m: (2,) standard deviations along the principal axes, larger first.
    """

    center_m: FloatArray
    axis_rad: float
    deviations_m: FloatArray

    @classmethod
    def of(cls, positions_m: FloatArray, z_E_m: float) -> Footprint:
        """Compute from the (n, 2) drop positions of the candies that stayed, n >= 1."""
        center = positions_m.mean(axis=0)
        variances, axes = np.linalg.eigh(np.cov(positions_m.T, bias=True))
        x, y = axes[:, 1]
        angle = (atan2(y, x) + pi / 2) % pi - pi / 2
        deviations = np.sqrt(np.clip(variances[::-1], 0, None))
        return cls(np.array([*center, z_E_m]), angle, deviations)


@dataclass(frozen=True)
class Containability:
    """Result of open containability imagination (Sec. III-A).

    Attributes:
        omega: Omega = n_in / n_drop.
        omega_threshold: Omega_thr it is held against.
        drop_positions_m: (n_drop, 3) centres at the start.
        retained: (n_drop,) whether the candy was inside the object's AABB at the end.
        aabb_m: (2, 3) lower and upper corner of the object's AABB.
        footprint: None when nothing stayed.
        recording: the drop, to look at.
        verdict: by what it holds; none if Omega decides.
    """

    omega_threshold: float
    drop_positions_m: FloatArray
    retained: BoolArray
    aabb_m: FloatArray
    footprint: Footprint | None
    recording: Recording
    verdict: Verdict | None = None

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

    @property
    def is_open_container(self) -> bool:
        """The verdict: by what the object holds, or by Omega."""
        return self.exceeds_omega if self.verdict is None else self.verdict.is_container

    @property
    def exceeds_omega(self) -> bool:
        """The paper's verdict: whether Omega exceeds its threshold."""
        return self.omega > self.omega_threshold

    def save(self, folder: Path) -> None:
        """Write `containability.json` and `drop.npz`."""
        footprint = self.footprint
        table: dict[str, Any] = {
            "omega": self.omega,
            "omega_threshold": self.omega_threshold,
            "is_open_container": self.is_open_container,
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
            "verdict": None if self.verdict is None else self.verdict.to_table(),
        }
        write_json(folder / "containability.json", table)
        write_arrays(
            folder / "drop.npz",
            drop_positions_m=self.drop_positions_m,
            retained=self.retained,
            **self.recording.to_arrays(),
        )

    @classmethod
    def load(cls, folder: Path) -> Containability:
        """Read what `save` wrote."""
        table = read_json(folder / "containability.json")
        arrays = read_arrays(folder / "drop.npz")
        found, verdict = table["footprint"], table.get("verdict")
        return cls(
            table["omega_threshold"],
            arrays["drop_positions_m"],
            arrays["retained"],
            np.array(table["aabb_m"]),
            None
            if found is None
            else Footprint(np.array(found["center_m"]), found["axis_rad"], np.array(found["deviations_m"])),
            Recording.from_arrays(arrays),
            None if verdict is None else Verdict.from_table(verdict),
        )


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
    """

    n_pour: int
    n_in: IntArray
    n_spilled: IntArray
    theta_rad: FloatArray
    indent_m: FloatArray
    pivot_m: FloatArray
    recordings: tuple[tuple[Recording, ...], ...]

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
            "p": self.p.tolist(),
            "p_spread": self.p_spread.tolist(),
            "n_in": self.n_in.tolist(),
            "n_spilled": self.n_spilled.tolist(),
            "theta_rad": self.theta_rad.tolist(),
            "indent_m": self.indent_m.tolist(),
            "pivot_m": self.pivot_m.tolist(),
        }
        write_json(folder / "pours.json", table)
        arrays: dict[str, AnyArray] = {}
        for i, row in enumerate(self.recordings):
            for j, recording in enumerate(row):
                arrays |= recording.to_arrays(f"pour_{i}_{j}_")
        write_arrays(folder / "pours.npz", **arrays)

    @classmethod
    def load(cls, folder: Path) -> PourGrid:
        """Read what `save` wrote."""
        table = read_json(folder / "pours.json")
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
        )


def imagined_n_pour(folder: Path) -> int | None:
    """Return the N_pour that the pours saved in `folder` were imagined with; none if there are none."""
    path = folder / "pours.json"
    return int(read_json(path)["n_pour"]) if path.is_file() else None


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
