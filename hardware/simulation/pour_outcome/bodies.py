"""What stands on the simulated table, whichever engine moves the candies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray
from core.mesh import TriangleMesh
from core.parameters.bodies import CupParameters

GRAVITY_M_S2 = 9.80665
_TABLE_DEPTH_M = 1.0


@dataclass(frozen=True)
class PlatformBox:
    """The platform on the table, along the base's axes.

    Attributes:
        min_m: (2,) lower corner, x and y.
        max_m: (2,) upper corner.
        height_m: of its top, in the base frame.
    """

    min_m: tuple[float, float]
    max_m: tuple[float, float]
    height_m: float


@dataclass(frozen=True)
class Bodies:
    """Everything in the world but the candies.

    Attributes:
        object: the true surface, in the base frame.
        cup: its measures.
        table_height_m: of the table's top.
        platform: the box that carries the object.
    """

    object: TriangleMesh
    cup: CupParameters
    table_height_m: float
    platform: PlatformBox

    @property
    def platform_box_m(self) -> FloatArray:
        """(2, 3) lowest and highest corner of the platform, which reaches far below the table's top."""
        platform = self.platform
        return np.array(
            [
                [*platform.min_m, self.table_height_m - _TABLE_DEPTH_M],
                [*platform.max_m, platform.height_m],
            ]
        )
