"""Where the transparent platform's top lies, when neither the cell nor the user knows."""

from __future__ import annotations

import numpy as np

from core.parameters.reconstruction import ReconstructionParameters
from core.reconstruction.segmentation import Part
from core.reconstruction.tsdf import TsdfVolume
from core.scan.model import Scan

STRIDE = 3
LOWEST_PERCENT = 0.2
"""What may be noise below the object's foot."""


def estimate_platform_height_m(
    volume: TsdfVolume, part: Part, scan: Scan, parameters: ReconstructionParameters
) -> float:
    """Height of the lowest depth points of the object: the platform itself leaves none.

    A few millimetres too low with poor poses, too high when every view looks steeply down.
    """
    low_m = volume.centers_m(part.seen.min(axis=0)) - volume.voxel_m
    high_m = volume.centers_m(part.seen.max(axis=0)) + volume.voxel_m
    heights_m = []
    for frame in scan.frames:
        points = frame.points_m(scan.intrinsics, max_depth_m=parameters.max_depth_m, stride=STRIDE)
        heights_m.append(points[((points > low_m) & (points < high_m)).all(axis=1), 2])
    everywhere = np.concatenate(heights_m)
    return float(np.percentile(everywhere, LOWEST_PERCENT)) if len(everywhere) else float(low_m[2])
