"""What the views did not see inside an opening; to be read and shown without what finds it."""

from __future__ import annotations

from dataclasses import dataclass

from core.geometry import FloatArray, IntArray


@dataclass(frozen=True)
class HiddenCavity:
    """What no view saw inside the openings; all empty and zero when everything was seen.

    Attributes:
        frontier_m: (N, 3) voxel centres in the base frame, where known free space ends at the unseen.
        region: (M, 3) voxels of the volume, the frontier and the unseen that lies enclosed behind it. It
            includes the cores of walls and floors, which no view can see.
        area_m2: of the frontier.
        volume_ml: of the region, so the most that may be hidden.
        depth_m: from the rim down to the middle of the frontier, in the opening with the most of it.
        width_m: of that opening just below its rim, as the diameter of a circle of its area.
    """

    frontier_m: FloatArray
    region: IntArray
    area_m2: float = 0.0
    volume_ml: float = 0.0
    depth_m: float = 0.0
    width_m: float = 0.0
