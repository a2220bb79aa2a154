"""Water poured in from above: the height at which each point of a lattice runs out."""

from __future__ import annotations

import numba
import numpy as np

from core.geometry import BoolArray, IntArray
from core.imagination.capacity.lattice import Lattice

NEVER = -1
"""Spill layer of what water cannot reach, or that is taken."""


def spill_layers(lattice: Lattice, taken: BoolArray) -> IntArray:
    """Return (X, Y, Z) for each point the lowest layer over which it is joined to the outside.

    Water stands at a point when that layer is above its own: every way out leads higher. Outside is the
    border of the lattice, and all below the object: the table carries no water. Air caught under an overhang
    counts as water.

    Args:
        lattice: around the object.
        taken: (X, Y, Z) points at which nothing can be.
    """
    return _spill(lattice.parted, taken)  # type: ignore[no-any-return]  # numba hides it


@numba.njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _root(parent: IntArray, point: int) -> int:
    while parent[point] != point:
        parent[point] = parent[parent[point]]
        point = parent[point]
    return point


@numba.njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _neighbours(
    parted: BoolArray, taken: BoolArray, at: tuple[int, int, int], outside: int, found: IntArray
) -> int:
    """Write the points already reached that `at` is joined to into `found` and return how many."""
    i, j, k = at
    n_x, n_y, n_z = taken.shape
    point = (i * n_y + j) * n_z + k
    count = 0
    if min(i, j, k) == 0 or i == n_x - 1 or j == n_y - 1 or k == n_z - 1:
        found[count] = outside
        count += 1
    if i > 0 and not parted[0, i - 1, j, k] and not taken[i - 1, j, k]:
        found[count] = point - n_y * n_z
        count += 1
    if j > 0 and not parted[1, i, j - 1, k] and not taken[i, j - 1, k]:
        found[count] = point - n_z
        count += 1
    if k > 0 and not parted[2, i, j, k - 1] and not taken[i, j, k - 1]:
        found[count] = point - 1
        count += 1
    return count


@numba.njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _spill(parted: BoolArray, taken: BoolArray) -> IntArray:
    """Raise the water layer by layer, joining points (union-find); each group is a list that drains once."""
    n_x, n_y, n_z = taken.shape
    n = n_x * n_y * n_z
    parent, following, tail = np.arange(n + 1), np.full(n + 1, -1), np.arange(n + 1)
    spill, found = np.full(n, NEVER), np.empty(4, dtype=np.int64)
    for k, i, j in np.ndindex(n_z, n_x, n_y):
        if taken[i, j, k]:
            continue
        for index in range(_neighbours(parted, taken, (i, j, k), n, found)):
            one, other = _root(parent, (i * n_y + j) * n_z + k), _root(parent, found[index])
            if one == other:
                continue
            if one == n:  # the outside stays a root
                one, other = other, one
            parent[one] = other
            if other == n:
                while one >= 0:
                    spill[one] = k
                    one = following[one]
            else:
                following[tail[other]] = one
                tail[other] = tail[one]
    return spill.reshape(n_x, n_y, n_z)
