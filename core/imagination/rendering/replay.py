"""From a recording to what is drawn: each candy's fate, and where the lost ones lie."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from core.geometry import BoolArray, FloatArray
from core.imagination.recording import Float32Array, Recording
from core.mesh import TriangleMesh

_LONGEST_FALL_S = 0.3
_DIRECTIONS = 2 * np.pi * np.arange(16) / 16
_AROUND = np.array(
    [
        (0.0, 0.0),
        *((r * np.cos(a), r * np.sin(a)) for r in 0.25 * np.arange(1, 17) for a in _DIRECTIONS + 0.4 * r),
    ]
)
"""Places (n, 2) at and around a place, from near to far, in diameters of a candy."""


@dataclass(frozen=True)
class Replay:
    """A recording made ready to be looked at.

    Attributes:
        recording: its lost candies lie where they passed the ground.
        retained: (N,) whether the candy counts as kept, or poured in, at the end.
        ground_m: height of the ground, just below everything the object reaches.
    """

    recording: Recording
    retained: BoolArray
    ground_m: float


def make_replay(
    recording: Recording, retained: BoolArray, ground_m: float, candy_extents_m: FloatArray
) -> Replay:
    """Prepare a recording; the imagination has no ground, so a lost candy is placed where it passes ours.

    It lies flat, beside those that lay there before. `candy_extents_m` (3,) are a candy's edge lengths.
    """
    positions, quaternions = recording.positions_m.copy(), recording.quaternions.copy()
    resting_m = ground_m + float(candy_extents_m[2]) / 2
    gone = [(_first_gone(positions[:, candy], resting_m), candy) for candy in np.flatnonzero(~retained)]
    lying = np.empty((0, 2))
    for moment, candy in sorted((moment, candy) for moment, candy in gone if moment is not None):
        landed = _landing(positions[:, candy], recording.time_s, moment, resting_m)
        landed[:2] = _free_place(landed[:2], lying, float(candy_extents_m[0]))
        lying = np.vstack([lying, landed[:2]])
        positions[moment:, candy] = landed
        quaternions[moment:, candy] = (0, 0, 0, 1)
    return Replay(replace(recording, positions_m=positions, quaternions=quaternions), retained, ground_m)


def standing(recording: Recording, surface: TriangleMesh) -> tuple[Recording, float]:
    """Raise body and candies while the body is tilted, so that it stands on the ground it stands on at rest.

    The imagination turns the object in the air, about its middle: drawn so it would sink into a ground.

    Returns:
        The recording, and the height of that ground.
    """
    lowest_m = _lowest_points_m(surface, recording.T_world_body)
    ground_m = float(lowest_m[0])
    raised_m = (ground_m - lowest_m).astype(np.float32)
    positions, poses = recording.positions_m.copy(), recording.T_world_body.copy()
    positions[:, :, 2] += raised_m[:, None]
    poses[:, 2, 3] += raised_m
    return replace(recording, positions_m=positions, T_world_body=poses), ground_m


def poured_in(recording: Recording, aabb_m: FloatArray, counted: str) -> BoolArray:
    """Return (N,) which candies count at the end, by the rule `counted` of the pouring parameters."""
    final = recording.positions_m[-1]
    with np.errstate(invalid="ignore"):
        inside: BoolArray = ((final > aabb_m[0]) & (final < aabb_m[1])).all(axis=1)
        above_floor: BoolArray = final[:, 2] >= aabb_m[0, 2]
    return {"inside": inside, "above_floor": above_floor}[counted]


def _lowest_points_m(surface: TriangleMesh, T_world_body: Float32Array) -> FloatArray:
    """Lowest height (K,) of the surface at each of the poses (K, 4, 4)."""
    heights = T_world_body[:, 2, :3] @ surface.vertices_m.T + T_world_body[:, 2, 3:]
    lowest: FloatArray = heights.min(axis=1)
    return lowest


def _free_place(place_m: FloatArray, lying_m: FloatArray, diameter_m: float) -> FloatArray:
    """The nearest place (2,) where a candy is clear of those at (n, 2); where it is if none is near."""
    if not len(lying_m):
        return place_m
    places_m = place_m + diameter_m * _AROUND
    gaps_m = np.linalg.norm(places_m[:, None] - lying_m[None], axis=2).min(axis=1)
    free: FloatArray = places_m[int((gaps_m >= diameter_m).argmax())]
    return free


def _first_gone(path_m: Float32Array, resting_m: float) -> int | None:
    """First moment at which a candy that was there is below `resting_m` or no longer recorded."""
    is_there = np.isfinite(path_m[:, 2])
    with np.errstate(invalid="ignore"):
        is_gone = ~is_there | (path_m[:, 2] < resting_m)
    was_there = np.concatenate([[False], np.logical_or.accumulate(is_there)[:-1]])
    moments = np.flatnonzero(is_gone & was_there)
    return int(moments[0]) if len(moments) else None


def _landing(path_m: Float32Array, time_s: Float32Array, moment: int, resting_m: float) -> FloatArray:
    """Where a candy passes the ground, going on as it moved at the last moment above it."""
    last = path_m[moment - 1].astype(float)
    step_s = float(time_s[moment] - time_s[moment - 1])
    if np.isfinite(path_m[moment, 2]):
        velocity = (path_m[moment] - last) / step_s
    elif moment >= 2 and np.isfinite(path_m[moment - 2, 2]):
        velocity = (last - path_m[moment - 2]) / float(time_s[moment - 1] - time_s[moment - 2])
    else:
        velocity = np.zeros(3)
    falling_m_s = max(-float(velocity[2]), 0.1)
    fall_s = np.clip((last[2] - resting_m) / falling_m_s, 0, _LONGEST_FALL_S)
    return np.array([last[0] + velocity[0] * fall_s, last[1] + velocity[1] * fall_s, resting_m])
