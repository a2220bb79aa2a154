"""Candies that lie in the object already when a cup is poured: of several cups, those of the cups before."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray, transform_points


@dataclass(frozen=True)
class LyingCandies:
    """Candies at rest in the object.

    Attributes:
        scales: (M,) size of each, relative to the mean size.
        positions_m: (M, 3) centres, in the base frame, the object standing where its mesh is.
        quaternions: (M, 4) orientations there, (x, y, z, w).
    """

    scales: FloatArray
    positions_m: FloatArray
    quaternions: FloatArray

    def moved(self, T_base_moved: FloatArray) -> LyingCandies:
        """Return them as they lie when the object was moved by (4, 4), and they with it."""
        from scipy.spatial.transform import Rotation

        turn = Rotation.from_matrix(T_base_moved[:3, :3])
        turned = (turn * Rotation.from_quat(self.quaternions)).as_quat() if len(self.scales) else None
        return LyingCandies(
            self.scales,
            transform_points(T_base_moved, self.positions_m),
            self.quaternions if turned is None else np.asarray(turned),
        )


NONE_LYING = LyingCandies(np.empty(0), np.empty((0, 3)), np.empty((0, 4)))
