"""What happens to the object when, from the parameters of the run. Qt-free."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from core.imagination.results import Containability
from core.parameters.imagination import ContainabilityParameters

PhaseKey = Literal["drop", "tilt_x", "tilt_y", "shove"]
N_PUSHES = 4


@dataclass(frozen=True)
class Phase:
    """A stretch of the drop.

    Attributes:
        key: which one.
        begin_s: since the start.
        end_s: since the start.
        n_inside: candies within the object's bounding box at its end.
    """

    key: PhaseKey
    begin_s: float
    end_s: float
    n_inside: int


def phases_of(containability: Containability, settings: ContainabilityParameters) -> tuple[Phase, ...]:
    """Return the phases (Sec. III-A, Fig. 3a) that take time, in their order."""
    lengths: dict[PhaseKey, float] = {
        "drop": settings.drop_s,
        "tilt_x": settings.rotation_s,
        "tilt_y": settings.rotation_s,
        "shove": N_PUSHES * settings.translation_s,
    }
    phases, begin_s = [], 0.0
    for key, length_s in lengths.items():
        if length_s > 0:
            n_inside = _n_inside(containability, begin_s + length_s)
            phases.append(Phase(key, begin_s, begin_s + length_s, n_inside))
            begin_s += length_s
    return tuple(phases)


def push_of(settings: ContainabilityParameters, since_s: float) -> str:
    """Return the direction of the push, `since_s` after the first began."""
    index = min(int(since_s / settings.translation_s), N_PUSHES - 1)
    return ("+x", "-x", "+y", "-y")[index]


def _n_inside(containability: Containability, time_s: float) -> int:
    recording = containability.recording
    positions_m = recording.positions_m[int(np.abs(recording.time_s - time_s).argmin())]
    low_m, high_m = containability.aabb_m
    with np.errstate(invalid="ignore"):  # NaN: fallen and gone
        return int(((positions_m > low_m) & (positions_m < high_m)).all(axis=1).sum())
