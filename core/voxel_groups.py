"""Groups of touching voxels in a mask."""

from __future__ import annotations

import numpy as np

from core.geometry import BoolArray


def large_groups(mask: BoolArray, fewest: float, structure: BoolArray | None = None) -> BoolArray:
    """Return the voxels of a mask (X, Y, Z) that lie in groups of at least `fewest`.

    Args:
        mask: which voxels are meant.
        fewest: voxels of a group that stays.
        structure: (3, 3, 3) which neighbours touch; by default the six that share a face.
    """
    from scipy.ndimage import label

    groups, _ = label(mask, structure=structure)
    is_large = np.bincount(groups.ravel()) >= fewest
    is_large[0] = False
    large: BoolArray = is_large[groups]
    return large
