"""How far in front of a surface and behind it the fusion believes what a view measured, and how much.

A view that sees the inside of a wall also says "solid" behind it. Where that reaches through a thin wall it
contradicts the views from outside, so near a surface its own views must outweigh it: a view's weight falls
with the distance it tells. All lengths grow with the pose error, or the two sides of a wall would erase each
other. Figures in docs/decisions/0003-truncation.md.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.parameters.reconstruction import ReconstructionParameters
from core.reconstruction.corrections import Refinement
from core.reconstruction.pose_health import PoseHealth

VOXELS_IN_FRONT = 4.0
FRONT_PER_VIEW_ERROR = 3.0
LARGEST_M = 0.03
FALLOFF_VOXELS = 0.8
FALLOFF_PER_VIEW_ERROR = 2.0
BEHIND_PER_FALLOFF = 2.5
"""Where the weight has fallen to 0.002."""
VOXELS_WITHOUT_TABLE = 5.0
"""The released code's, when nothing tells the pose error."""
SURFACE_PER_TABLE_ERROR = 1.8
"""A surface of the object errs more than the table's height: a turn of the camera shifts it sideways."""


@dataclass(frozen=True)
class Truncation:
    """How a view counts: up to `front_m` and `behind_m`, its weight falling to 1/e within `falloff_m`."""

    front_m: float
    behind_m: float
    falloff_m: float = np.inf


def choose_truncation(
    parameters: ReconstructionParameters, voxel_m: float, error_m: float | None
) -> Truncation:
    """Return the truncation as set (the same on both sides), or following voxel and pose error."""
    if parameters.truncation_m is not None:
        return Truncation(parameters.truncation_m, parameters.truncation_m)
    if error_m is None:
        return Truncation(VOXELS_WITHOUT_TABLE * voxel_m, VOXELS_WITHOUT_TABLE * voxel_m)
    least_m = VOXELS_IN_FRONT * voxel_m
    front_m = max(min(least_m + FRONT_PER_VIEW_ERROR * error_m, LARGEST_M), least_m)
    falloff_m = FALLOFF_VOXELS * voxel_m + FALLOFF_PER_VIEW_ERROR * error_m
    return Truncation(front_m, min(BEHIND_PER_FALLOFF * falloff_m, front_m), falloff_m)


def view_error_m(health: PoseHealth, refinement: Refinement | None) -> float | None:
    """Return how far (standard deviation) the surface of one view errs; none if nothing tells it."""
    if refinement is not None and refinement.view_error_m is not None:
        return refinement.view_error_m
    return None if health.sd_height_m is None else SURFACE_PER_TABLE_ERROR * health.sd_height_m
