"""Drawing how a pour is really set up: what may be wrong of object, cup and candies."""

from __future__ import annotations

from dataclasses import replace
from math import hypot, sqrt

import numpy as np

from core.geometry import FloatArray, make_pose, rotation_x, rotation_y, rotation_z
from core.imagination.packing import cup_holds
from core.imagination.set_up import SetUp, as_planned
from core.parameters import Parameters

_STREAM = 2
"""Of the seed: 0 is the drop's, 1 the packings'."""
_LATER_CUP = 10_000
"""Added to a try's number for each later cup: packings of their own."""
_CLOSER, _LEAST_STEP = 0.8, 0.002
"""Too large candies are brought closer to the planned size step by step."""


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


def draw_cups(parameters: Parameters, number: int, n_cups: int, center_m: FloatArray) -> list[SetUp]:
    """Draw the set-ups of cups that are poured one after the other into one object, from one bag of candies.

    Args:
        parameters: as for `draw_set_up`.
        number: of the try.
        n_cups: poured in it; the first is `draw_set_up`'s.
        center_m: (3,) what the object turns about.
    """
    first = draw_set_up(parameters, number, center_m)
    others = [draw_set_up(parameters, number + cup * _LATER_CUP, center_m) for cup in range(1, n_cups)]
    scale, moved = first.candy_scale, first.T_base_moved
    return [first, *(replace(one, candy_scale=scale, T_base_moved=moved) for one in others)]


def with_scan_error(parameters: Parameters, pose_sd_m: float | None, n_views: int) -> Parameters:
    """Return the parameters with the risk's object error raised by what a scan's poses leave open.

    The surface is the mean of what the views say, so that their errors, taken as independent, fall with the
    square root of their number. An error that all views share is in `risk.object_error_m`.

    Args:
        parameters: of the imagination.
        pose_sd_m: SD of a view's position along an axis, as the table tells it; none if it is not known.
        n_views: of the scan.
    """
    if pose_sd_m is None or n_views == 0:
        return parameters
    return _with_object_error(parameters, pose_sd_m / sqrt(n_views), 0.0)


def with_camera_error(parameters: Parameters, error_m: float, error_rad: float) -> Parameters:
    """Return the parameters with the risk's object errors raised by what the camera leaves open.

    A wall of the object is seen from its own side only, so that the error is that of one view: it does not
    fall with their number.

    Args:
        parameters: of the imagination.
        error_m: SD along an axis of where a view sees the object.
        error_rad: SD about an axis of how it sees it turned.
    """
    return _with_object_error(parameters, error_m, error_rad)


def _with_object_error(parameters: Parameters, error_m: float, error_rad: float) -> Parameters:
    risk = parameters.risk
    errors = {
        "object_error_m": hypot(risk.object_error_m, error_m),
        "object_error_rad": hypot(risk.object_error_rad, error_rad),
    }
    return parameters.model_copy(update={"risk": risk.model_copy(update=errors)})
