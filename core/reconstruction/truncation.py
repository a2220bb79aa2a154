"""How far in front of a surface and behind it the fusion believes what a view measured.

In front, the truncation decides how much of the free space is averaged. Behind, it must end inside the wall:
a view that goes on believing pushes the far side of a thin wall outwards, away from what the views from there
measured. Both grow with the pose error, or the two sides of a wall would erase each other. Figures in
docs/decisions/0003-truncation.md.
"""

from __future__ import annotations

from core.parameters.reconstruction import ReconstructionParameters
from core.reconstruction.pose_health import PoseHealth

VOXELS_AT_LEAST = 4.0
PER_POSE_ERROR = 3.0
LARGEST_M = 0.03
VOXELS_BEHIND = 2.5
BEHIND_PER_POSE_ERROR = 4.0
VOXELS_WITHOUT_TABLE = 5
"""The released code's, when no table tells the pose error."""


def choose_truncation_m(parameters: ReconstructionParameters, health: PoseHealth) -> tuple[float, float]:
    """Return the truncation in front and behind: as set (both), or following the measured pose error."""
    if parameters.truncation_m is not None:
        return parameters.truncation_m, parameters.truncation_m
    if health.sd_height_m is None:
        return VOXELS_WITHOUT_TABLE * parameters.voxel_m, VOXELS_WITHOUT_TABLE * parameters.voxel_m
    least_m = VOXELS_AT_LEAST * parameters.voxel_m
    front_m = max(min(least_m + PER_POSE_ERROR * health.sd_height_m, LARGEST_M), least_m)
    behind_m = VOXELS_BEHIND * parameters.voxel_m + BEHIND_PER_POSE_ERROR * health.sd_height_m
    return front_m, min(behind_m, front_m)
