"""How far behind a surface the fusion still believes in it."""

from __future__ import annotations

from core.parameters.reconstruction import ReconstructionParameters
from core.reconstruction.pose_health import PoseHealth

VOXELS_AT_LEAST = 4
VOXELS_WITHOUT_TABLE = 5
"""The released code's, when no table tells the pose error."""
PER_POSE_ERROR = 6.0
LARGEST_M = 0.03
"""Measured on simulated scans of eight objects (3 mm voxels): with right poses solid things are truest at
9 mm, but walls under 2 mm need 12 mm; where the table's height scatters by 2 mm they need 20-30 mm, by 3.5 mm
30 mm. On the released scan (3.2 mm) the tray holds 13 ml at 22 mm, 34 ml at 30 mm, 27 ml at 40 mm."""


def choose_truncation_m(parameters: ReconstructionParameters, health: PoseHealth) -> float:
    """Return the truncation that was set, or one that follows the pose error measured by the table."""
    if parameters.truncation_m is not None:
        return parameters.truncation_m
    if health.sd_height_m is None:
        return VOXELS_WITHOUT_TABLE * parameters.voxel_m
    wanted_m = VOXELS_AT_LEAST * parameters.voxel_m + PER_POSE_ERROR * health.sd_height_m
    return max(min(wanted_m, LARGEST_M), VOXELS_AT_LEAST * parameters.voxel_m)
