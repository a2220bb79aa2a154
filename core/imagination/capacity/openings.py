"""Openings in the floor below a heap: where there is none, candies cannot arch over one."""

from __future__ import annotations

import numpy as np

from core.geometry import BoolArray, FloatArray
from core.imagination.hollow_map import HollowMap
from core.mesh import TriangleMesh

_PIXELS = 20
"""Across the opening that is looked for; what is thinner than one still closes it, for outlines are drawn."""


def has_opening_below(mesh: TriangleMesh, places_m: FloatArray, hollows: HollowMap, width_m: float) -> bool:
    """Return whether something could fall straight through a mesh between the places where candies stayed.

    Or where candies are held: three that stayed in a tube of two candies' width leave half of it beside their
    triangle. A way down that bends is not found.

    Args:
        mesh: at rest; its upward axis is z.
        places_m: (n, 2).
        hollows: for candies.
        width_m: of what could fall.
    """
    from scipy.ndimage import distance_transform_edt
    from scipy.spatial import Delaunay, QhullError

    pitch = width_m / _PIXELS
    origin_m = mesh.aabb_min_m[:2]
    # A pixel that is open stands for half a pixel around it, too.
    room_m = pitch * (distance_transform_edt(~_seen_from_above(mesh, pitch)) - 0.5)
    openings_m = origin_m + pitch * np.argwhere(room_m >= width_m / 2)
    if not len(openings_m):
        return False
    if np.isfinite(hollows.rim_at(openings_m)).any():
        return True
    try:
        between = Delaunay(places_m).find_simplex(openings_m) >= 0
    except (QhullError, ValueError):  # too few places to be between
        return True
    return bool(between.any())


def _seen_from_above(mesh: TriangleMesh, pitch_m: float) -> BoolArray:
    """Return (x, y) whether any surface is there."""
    from PIL import Image, ImageDraw

    size = np.ceil((mesh.aabb_max_m - mesh.aabb_min_m)[:2] / pitch_m).astype(int) + 1
    image = Image.new("1", (int(size[0]), int(size[1])))
    draw = ImageDraw.Draw(image)
    corners = (mesh.vertices_m[mesh.faces][:, :, :2] - mesh.aabb_min_m[:2]) / pitch_m
    for triangle in corners.reshape(-1, 6).tolist():
        draw.polygon(triangle, fill=1, outline=1)
    seen: BoolArray = np.array(image, dtype=bool).T
    return seen
