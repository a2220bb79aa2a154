"""A trial by looks: the colour images are judged, and the pour is found in the top-down one (Sec. V)."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from core.appearance.looking import ViewLook, look_at_scan, top_down_view
from core.appearance.network import shipped_network
from core.appearance.pouring import contain_point
from core.geometry import FloatArray, transform_points
from core.imagination.cup import cup_parts
from core.mesh import SurfaceDistance, TriangleMesh
from core.parameters.bodies import CupParameters
from core.parameters.reconstruction import ReconstructionParameters
from core.scan.model import Scan, crop_box_of
from hardware.simulation.pour_outcome.driven_path import DrivenPath

_PICTURE_PX = (320, 240)
_CUP_GRID_M = 0.004
_TOUCH_M = 0.002
"""The cup touches what is nearer than this; its own points are 4 mm apart."""
_EVERY = 5
_N_VIEWS = 24
"""Of Sec. V. A scan may end with a few more, into openings: those are imagination's, and not counted here."""


@dataclass(frozen=True)
class LookedAt:
    """A scan's views, as the network sees them.

    Attributes:
        scan: the scan, with the views that are looked at.
        looks: of each of them; none where the object is not seen.
        top_down: index of the view from which pours are found.
    """

    scan: Scan
    looks: tuple[ViewLook | None, ...]
    top_down: int

    @classmethod
    def of(cls, scan: Scan, parameters: ReconstructionParameters) -> LookedAt:
        """Look at a scan's first 24 views.

        Raises:
            InputError: the network's weights cannot be used.
        """
        scan = replace(scan, frames=scan.frames[:_N_VIEWS])
        looks = look_at_scan(shipped_network(), scan, crop_box_of(scan, parameters))
        return cls(scan, looks, top_down_view(scan))

    @property
    def facts(self) -> Mapping[str, Any]:
        """What a trial keeps of it."""
        names = [frame.name for frame in self.scan.frames]
        scores = {
            name: look.look.score for name, look in zip(names, self.looks, strict=True) if look is not None
        }
        top_down = names[self.top_down]
        return {"view_scores": scores, "view": top_down, "top_down": top_down}

    @property
    def point_m(self) -> FloatArray | None:
        """Where to pour (3,), in the base frame; none if the top-down view shows nothing that contains."""
        look = self.looks[self.top_down]
        return (
            None
            if look is None
            else contain_point(look, self.scan.frames[self.top_down], self.scan.intrinsics)
        )

    def picture(self) -> bytes:
        """Return the top-down view with the contain map over it, as PNG."""
        from PIL import Image

        color, look = self.scan.frames[self.top_down].color, self.looks[self.top_down]
        drawn = Image.fromarray(color if look is None else look.overlaid(color))
        drawn.thumbnail(_PICTURE_PX)
        out = io.BytesIO()
        drawn.save(out, "PNG")
        return out.getvalue()


def touches(path: DrivenPath, cup: CupParameters, true: TriangleMesh) -> bool:
    """Whether the cup would touch the object on its path; the simulated arm carries it through anything."""
    distance = SurfaceDistance(true)
    points = _cup_points_m(cup)
    poses = path.T_base_cup[::_EVERY]
    low, high = true.aabb_min_m - _TOUCH_M, true.aabb_max_m + _TOUCH_M
    for pose in poses:
        placed = transform_points(pose, points)
        near = placed[((placed >= low) & (placed <= high)).all(axis=1)]
        if len(near) and distance.of_m(near).min() < _TOUCH_M:
            return True
    return False


def _cup_points_m(cup: CupParameters) -> FloatArray:
    """Points (N, 3) over the cup's surface in its own frame, a few millimetres apart."""
    points = []
    for part in cup_parts(cup):
        a, b, c = (part.vertices_m[part.faces[:, k]] for k in range(3))
        edge_m = max(np.linalg.norm(b - a, axis=1).max(), np.linalg.norm(c - a, axis=1).max())
        n = int(np.ceil(edge_m / _CUP_GRID_M)) + 1
        u, v = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n))
        inside = u + v <= 1 + 1e-9
        weights = np.column_stack([u[inside], v[inside]])
        points.append(a[:, None] + weights[:, :1] * (b - a)[:, None] + weights[:, 1:] * (c - a)[:, None])
    every = np.concatenate([one.reshape(-1, 3) for one in points])
    return _thinned(every)


def _thinned(points_m: FloatArray) -> FloatArray:
    """Keep one point of each few millimetres."""
    cells = np.unique(np.round(points_m / (_CUP_GRID_M / 2)).astype(np.int64), axis=0, return_index=True)[1]
    return points_m[cells]
