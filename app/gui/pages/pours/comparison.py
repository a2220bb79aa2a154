"""Holding one grid of pours against another. No Qt here."""

from __future__ import annotations

import os
import shutil
from dataclasses import dataclass
from math import pi
from pathlib import Path

import numpy as np

from core.errors import SessionError
from core.geometry import FloatArray
from core.imagination.results import PourGrid
from core.session import Session

SAME_DIRECTION_RAD = np.radians(0.5)
"""A direction this near to one of the grid's is that one: nothing new need be imagined."""
_LEFT_OUT = shutil.ignore_patterns(
    ".*", "pours", "containability", "pouring", "motion", "evidence", "*.html", "operator_choice.json"
)


@dataclass(frozen=True)
class OtherPours:
    """What is compared with.

    Attributes:
        label: what it is.
        grid: its pours.
    """

    label: str
    grid: PourGrid

    def ratios_for(self, grid: PourGrid) -> FloatArray:
        """P (I, J) of the other pours in the directions of `grid`: each from the other's nearest one."""
        ratios: FloatArray = self.grid.p[self._nearest(grid)]
        return ratios

    def farthest_rad(self, grid: PourGrid) -> float:
        """How far a direction of `grid` is from the one it is compared with, at most."""
        return float(angles_apart(grid.theta_rad, self.grid.theta_rad[self._nearest(grid)]).max())

    @property
    def best(self) -> tuple[int, int]:
        """(i, j) of its largest P; among equals the first."""
        return best_of(self.grid)

    def _nearest(self, grid: PourGrid) -> np.ndarray:
        apart = angles_apart(grid.theta_rad[:, None], self.grid.theta_rad[None, :])
        return np.asarray(apart.argmin(axis=1))


def best_of(grid: PourGrid) -> tuple[int, int]:
    """Return (i, j) of the largest P; among equals the first."""
    i, j = np.unravel_index(int(grid.p.argmax()), grid.p.shape)
    return int(i), int(j)


def angles_apart(a_rad: FloatArray, b_rad: FloatArray) -> FloatArray:
    """Return how far angles are apart, 0 to pi."""
    apart: FloatArray = np.abs((a_rad - b_rad + pi) % (2 * pi) - pi)
    return apart


def one_direction(grid: PourGrid, theta_rad: float) -> PourGrid | None:
    """Return the pours of one direction of the grid; none if it has no such direction."""
    apart = angles_apart(grid.theta_rad, np.array(theta_rad))
    i = int(apart.argmin())
    if apart[i] > SAME_DIRECTION_RAD:
        return None
    row = slice(i, i + 1)
    return PourGrid(
        grid.n_pour,
        grid.n_in[row],
        grid.n_spilled[row],
        grid.theta_rad[row],
        grid.indent_m,
        grid.pivot_m[row],
        grid.recordings[row],
    )


def load_grid(session: Path) -> PourGrid:
    """Read the pours of another session.

    Raises:
        SessionError: it is no session, or holds no pours.
    """
    folder = Session.open(session).folder("pouring")
    if not (folder / "pours.json").is_file():
        raise SessionError(
            f"The object of {session} is no open container: there are no pours to compare with."
        )
    return PourGrid.load(folder)


def scratch_session(session: Path, home: Path) -> Path:
    """Copy a session up to its collision model into `home`, to imagine a variant in."""
    scratch = home / session.name
    shutil.copytree(session, scratch, ignore=_LEFT_OUT, copy_function=_link)
    return scratch


def _link(source: str, target: str) -> str:
    """Stages are replaced as a whole and never changed, so a second name for a file is as good as a copy."""
    try:
        os.link(source, target)
        return target
    except OSError:
        return str(shutil.copy2(source, target))
