"""How a pour is really set up: the packing, the candies' size, where cup and object really are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray, invert_pose
from core.parameters import Parameters


@dataclass(frozen=True)
class SetUp:
    """How a pour is really made, which its plan does not know.

    Attributes:
        packing: which packing of the cup.
        candy_scale: size of the candies, relative to the particle's.
        T_base_moved: (4, 4) how the object was moved, in the base frame.
        T_E_slipped: (4, 4) how the cup slipped in the hand, in the E-local frame (origin at the pivot).
    """

    packing: int
    candy_scale: float
    T_base_moved: FloatArray
    T_E_slipped: FloatArray

    def seen_from_object(self, T_base_E: FloatArray) -> FloatArray:
        """Return `T_base_E` (4, 4) as it is to an object that is where it is believed to be."""
        pose: FloatArray = invert_pose(self.T_base_moved) @ T_base_E @ self.T_E_slipped
        return pose

    def parameters(self, parameters: Parameters) -> Parameters:
        """Return the parameters with candies of this size."""
        return scaled_candies(parameters, self.candy_scale)


def scaled_candies(parameters: Parameters, scale: float) -> Parameters:
    """Return the parameters with candies that are larger or smaller, and as dense."""
    if scale == 1:
        return parameters
    particle = parameters.particle
    scaled = {
        "diameter_m": particle.diameter_m * scale,
        "height_m": particle.height_m * scale,
        "mass_kg": particle.mass_kg * scale**3,
    }
    return parameters.model_copy(update={"particle": particle.model_copy(update=scaled)})


def as_planned(packing: int) -> SetUp:
    """Return the set-up in which all is as it is believed to be."""
    return SetUp(packing, 1.0, np.eye(4), np.eye(4))
