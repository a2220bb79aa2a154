"""What may be wrong when a pour is made: the packing, the candies' size, where cup and object really are."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from core.geometry import FloatArray, invert_pose, make_pose, rotation_x, rotation_y, rotation_z
from core.imagination.packing import cup_holds
from core.parameters import Parameters

_STREAM = 2
"""Of the seed: 0 is the drop's, 1 the packings'."""
_CLOSER, _LEAST_STEP = 0.8, 0.002
"""Too large candies are brought closer to the planned size step by step."""


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


def draw_set_up(parameters: Parameters, packing: int, center_m: FloatArray) -> SetUp:
    """Draw one set-up; the same for the same seed and packing, whichever pour it is for.

    Candies of which the cup cannot hold N_pour are not drawn: they could not be poured.

    Args:
        parameters: how large the errors are, the seed, the cup and N_pour.
        packing: of the cup; gives the draw its number.
        center_m: (3,) what the object turns about.
    """
    risk = parameters.risk
    generator = np.random.default_rng([parameters.seed, _STREAM, packing])
    shift = np.array([*generator.normal(0, 1, 2), 0.0]) * risk.object_error_m
    turn = rotation_z(float(generator.normal()) * risk.object_error_rad)
    moved = make_pose(turn, shift + center_m - turn @ center_m)
    slip = generator.normal(0, 1, 3) * risk.cup_error_m
    lean = generator.normal(0, 1, 2) * risk.cup_error_rad
    slipped = make_pose(rotation_x(float(lean[0])) @ rotation_y(float(lean[1])), slip)
    scale = 1 + risk.candy_spread * float(generator.uniform(-1, 1))
    drawn = replace(as_planned(packing), candy_scale=scale, T_base_moved=moved, T_E_slipped=slipped)
    while drawn.candy_scale > 1 and not cup_holds(drawn.parameters(parameters)):
        drawn = replace(drawn, candy_scale=1 + _CLOSER * (drawn.candy_scale - 1) - _LEAST_STEP)
    return drawn
