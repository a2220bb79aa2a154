"""The cup and how it turns about its rim (Sec. III-B, Fig. 4a, Eq. 6).

Cup frame: origin at the outer centre of the base, z along the axis to the mouth. The pivot is the point of
the inner rim in the cup's x-z plane. E-local frame: origin at the pivot, x along the ray from p_E to the
pivot (theta_pour = 0), z up; there every pour is the same motion.
"""

from __future__ import annotations

from math import cos, pi, sin, tan
from typing import Any

import numpy as np

from core.geometry import FloatArray, make_pose, rotation_y, rotation_z
from core.mesh import TriangleMesh
from core.parameters.bodies import CupParameters
from core.parameters.imagination import PouringParameters

_STAVES = 24
# Cup axes in E with l_cup level and the mouth towards p_E: x (to the pivot) is down, z (to the mouth) is -x.
_MOUTH_TO_CENTER = np.array([[0.0, 0.0, -1.0], [0.0, -1.0, 0.0], [-1.0, 0.0, 0.0]])


def inner_radius_m(cup: CupParameters, height_m: Any) -> Any:
    """Inner radius at `height_m` (a number or an array) above the outer base."""
    return cup.mouth_radius_m - cup.wall_m - (cup.length_m - height_m) * tan(cup.slant_rad)


def pivot_in_cup_m(cup: CupParameters) -> FloatArray:
    """r'_pivot (3,) in the cup frame: the inner rim's lowest point, or one above it."""
    rim = np.array([cup.mouth_radius_m - cup.wall_m, 0.0, cup.length_m])
    pivot: FloatArray = rim + rotation_y(cup.slant_rad) @ np.array([-cup.pivot_lift_m, 0.0, 0.0])
    return pivot


def cup_pose(cup: CupParameters, pivot_m: FloatArray, theta_rad: float, gamma_rad: float) -> FloatArray:
    """Pose `T_world_cup` (4, 4) turned by `gamma_rad` about l_pour; (R_init, t_init) of Eq. 6 with zero."""
    rotation = rotation_z(theta_rad) @ rotation_y(-gamma_rad) @ _MOUTH_TO_CENTER @ rotation_y(-cup.slant_rad)
    return make_pose(rotation, pivot_m - rotation @ pivot_in_cup_m(cup))


def pour_angle(pouring: PouringParameters, time_s: float) -> tuple[float, float]:
    """Return gamma and its rate at `time_s`: settling, then a quarter of a sine to gamma_0, then waiting."""
    since = time_s - pouring.settle_s
    if since <= 0:
        return 0.0, 0.0
    if since >= pouring.turn_s:
        return pouring.gamma_0_rad, 0.0
    phase, frequency = pi / 2 * since / pouring.turn_s, pi / 2 / pouring.turn_s
    return pouring.gamma_0_rad * sin(phase), pouring.gamma_0_rad * frequency * cos(phase)


def pour_duration_s(pouring: PouringParameters) -> float:
    """Time from the start to the count."""
    return pouring.settle_s + pouring.turn_s + pouring.wait_s


def cup_parts(cup: CupParameters) -> tuple[TriangleMesh, ...]:
    """The cup as convex parts in its own frame: staves around a base.

    Thin walls that turn against the candies must be solid: through a triangle surface they slip.
    """
    angles = np.arange(_STAVES + 1) * 2 * pi / _STAVES
    circle = np.column_stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)])
    lifted = np.array([0.0, 0.0, 1.0])
    rims = [
        circle * radius + lifted * height
        for radius, height in (
            (inner_radius_m(cup, 0.0), 0.0),
            (inner_radius_m(cup, cup.length_m), cup.length_m),
            (inner_radius_m(cup, 0.0) + cup.wall_m, 0.0),
            (cup.mouth_radius_m, cup.length_m),
        )
    ]
    staves = [_hull(np.vstack([rim[[k, k + 1]] for rim in rims])) for k in range(_STAVES)]
    base = _hull(np.vstack([rims[0][:-1], rims[0][:-1] + lifted * cup.wall_m]))
    return (*staves, base)


def _hull(vertices_m: FloatArray) -> TriangleMesh:
    from scipy.spatial import ConvexHull

    hull = ConvexHull(vertices_m)
    faces = hull.simplices.astype(np.int64)
    # SciPy gives the triangles without an order; the hull's own plane equations tell which side is out.
    a, b, c = (vertices_m[faces[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    faces[inward] = faces[inward][:, ::-1]
    return TriangleMesh(vertices_m, faces)
