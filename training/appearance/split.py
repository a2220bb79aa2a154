"""Which views are learnt from, and which tell what was learnt."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np


def split(known: Mapping[str, np.ndarray], leave_out: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Return which views (N,) are learnt from, and which are held out.

    Without kinds to leave out the latter are members of the families that are learnt from; else the
    development objects of these kinds (leave one category out).
    """
    is_held_out, is_left_out = known["is_held_out"], np.isin(known["kind"], list(leave_out))
    if not leave_out:
        return ~is_held_out, is_held_out
    is_member = np.char.startswith(known["name"], np.char.add(known["kind"], "-"))
    return ~is_held_out & ~is_left_out, is_left_out & ~is_member
