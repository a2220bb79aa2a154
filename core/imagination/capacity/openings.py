"""Openings in the floor below a heap: where there is none, candies cannot arch over one.

Imported by workers alone, for the lattice loads numba.
"""

from __future__ import annotations

import numpy as np

from core.geometry import BoolArray, FloatArray
from core.imagination.capacity.water import FLATNESS, lattice_around, lattice_pitch_m
from core.mesh import TriangleMesh


def has_opening_below(mesh: TriangleMesh, places_m: FloatArray, width_m: float, points: int) -> bool:
    """Return whether something could fall straight through a mesh between the places where candies stayed.

    A way down that bends is not found.

    Args:
        mesh: at rest; its upward axis is z.
        places_m: (n, 2).
        width_m: of what could fall.
        points: of the lattice, about.
    """
    from scipy.ndimage import distance_transform_edt
    from scipy.spatial import Delaunay, QhullError

    pitch = lattice_pitch_m(mesh, points)
    lattice = lattice_around(mesh, pitch, FLATNESS * pitch, 0.0)
    is_closed: BoolArray = lattice.parted[2].any(axis=2)
    # A lattice point that is open stands for half a pitch around it, too.
    room_m = pitch * (distance_transform_edt(~is_closed) - 0.5)
    openings_m = lattice.origin_m[:2] + pitch * np.argwhere(room_m >= width_m / 2)
    if not len(openings_m):
        return False
    try:
        between = Delaunay(places_m).find_simplex(openings_m) >= 0
    except (QhullError, ValueError):  # too few places to be between
        return True
    return bool(between.any())
