"""What a surface holds of something as thick as a candy, to see that simplifying it loses nothing of that."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray
from core.mesh import TriangleMesh
from core.mesh_topology import hull_volume_m3

_THICKNESSES_M = (0.013, 0.010)
"""As thick as a candy is wide, about, and less: a gap that just stops one must not grow until one passes."""
_POINTS = 500_000
"""Of the lattice, as many as the capacity is found with by default; with fewer gaps go unseen."""
_LOST_SHARE, _LOST_OF_HULL = 0.1, 0.02
"""Of the hollow, and of the convex hull, a fifth of what makes a container: both must be lost to matter."""


@dataclass(frozen=True)
class Hollows:
    """Volumes in which the centres of balls are held, for each of `_THICKNESSES_M`, in m3."""

    volumes_m3: FloatArray
    hull_m3: float

    @staticmethod
    def of(mesh: TriangleMesh) -> Hollows:
        """Find them; 0.1 s. Not in the window, for it loads numba."""
        from core.lattice import held_centers, lattice_of

        lattice = lattice_of(mesh, _POINTS, max(_THICKNESSES_M))
        held = [held_centers(lattice, thickness_m / 2)[0].sum() for thickness_m in _THICKNESSES_M]
        return Hollows(lattice.cell_m3 * np.array(held), hull_volume_m3(mesh))

    def are_kept_by(self, coarse: TriangleMesh) -> bool:
        """Whether a simplified surface holds as much."""
        if not self.volumes_m3.any():
            return True
        lost_m3 = self.volumes_m3 - Hollows.of(coarse).volumes_m3
        return bool(
            (lost_m3 <= np.maximum(_LOST_SHARE * self.volumes_m3, _LOST_OF_HULL * self.hull_m3)).all()
        )
