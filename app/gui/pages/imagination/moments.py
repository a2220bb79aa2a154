"""A recording between its moments. Qt-free."""

from __future__ import annotations

import numpy as np

from core.geometry import FloatArray
from core.imagination.recording import Float32Array, Recording


class Moments:
    """Candies and body at any time of a recording; fast enough for every frame.

    Attributes:
        duration_s: time of the last moment.
    """

    def __init__(self, recording: Recording) -> None:
        self._recording = recording
        self.duration_s = float(recording.time_s[-1])

    def positions_m(self, time_s: float) -> Float32Array:
        """Return the candies (N, 3); NaN where one is absent at the moment before or after."""
        before, after, share = self._around(time_s)
        positions = self._recording.positions_m
        between: Float32Array = positions[before] + share * (positions[after] - positions[before])
        return between

    def T_world_body(self, time_s: float) -> FloatArray:
        """Return the body's pose (4, 4); it turns little from moment to moment, so entries are mixed."""
        before, after, share = self._around(time_s)
        poses = self._recording.T_world_body
        between: FloatArray = ((1 - share) * poses[before] + share * poses[after]).astype(float)
        return between

    def _around(self, time_s: float) -> tuple[int, int, np.float32]:
        """The moments before and after a time, and how far it is between them, 0 to 1."""
        times_s = self._recording.time_s
        after = int(np.clip(np.searchsorted(times_s, time_s), 1, max(len(times_s) - 1, 1)))
        if len(times_s) == 1:
            return 0, 0, np.float32(0)
        step_s = times_s[after] - times_s[after - 1]
        share = np.clip((time_s - times_s[after - 1]) / step_s, 0, 1)
        return after - 1, after, np.float32(share)
