"""Where an object at rest holds water, and anything as thick as a candy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray
from core.imagination.capacity.stand_in import Surroundings
from core.imagination.hollow_map import HollowMap

ML = 1e6
"""Millilitres in a cubic metre."""


@dataclass(frozen=True)
class Basin:
    """Where an object at rest holds something, heights in the frame of its mesh.

    Water is a liquid. Candies are what a sphere as thick as a candy reaches and cannot leave without being
    lifted: a notch or crack narrower than that counts as closed, and a hollow narrower than that as filled.

    Attributes:
        water_ml: volume of the water that stays, in all hollows that hold one candy at least.
        water_level_m: height at which the largest hollow runs over; NaN without water.
        rim_m: height at which the largest hollow for candies runs over; NaN without one.
        heights_m: (K,) rising; the first is the floor of the hollows for candies.
        volumes_ml: (K,) volume of these hollows below each height, up to their rims; empty without one.
        around: what candies lie against when these hollows are full.
        mouth_m: width of the narrowest place that most candies must pass.
        narrow_ml: part of `water_ml` that lies where no candy goes.
        hollow_map: of the hollows for candies.
    """

    water_ml: float
    water_level_m: float
    rim_m: float
    heights_m: FloatArray
    volumes_ml: FloatArray
    around: Surroundings
    mouth_m: float
    narrow_ml: float
    hollow_map: HollowMap

    @property
    def candies_ml(self) -> float:
        """Volume of the hollows for candies up to their rims."""
        return float(self.volumes_ml[-1]) if len(self.volumes_ml) else 0.0

    def level_m(self, volume_ml: float) -> float:
        """Height above the inner floor to which a volume fills the hollows for candies; NaN without one."""
        if not len(self.volumes_ml):
            return float("nan")
        return float(np.interp(volume_ml, self.volumes_ml, self.heights_m) - self.heights_m[0])
