"""The simulated world as a ray sees it: an object above a table. The transparent platform is not there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from core.geometry import AnyArray, BoolArray, FloatArray
from core.mesh import TriangleMesh

_TABLE_HALF_SIZE_M = 0.9
_NO_OBJECT = -1
_MARGIN = 2e-3
"""Share of a line left out at its end, so that no surface hides itself."""


@dataclass(frozen=True)
class Hits:
    """What rays (H, W) from one origin met.

    Attributes:
        distance: (H, W) in lengths of the ray's direction; infinite where it met nothing.
        points_m: (H, W, 3) in the base frame; the origin where it met nothing.
        normals: (H, W, 3) of the triangles, of length 1 or 0.
        on_object: (H, W) whether it was the object.
    """

    distance: FloatArray
    points_m: FloatArray
    normals: FloatArray
    on_object: BoolArray


class World:
    """An object, given in the robot's base frame, or none, above a table of 1.8 m by 1.8 m.

    Ray casting is Embree's, through Open3D: no GL, no window.

    Attributes:
        lamp_m: (3,) where its lamp is; none: it is dark, which a depth camera does not mind.
    """

    def __init__(self, mesh: TriangleMesh | None, table_center_m: FloatArray, *, is_lit: bool = True) -> None:
        import open3d as o3d

        self._tensor: Any = o3d.core.Tensor
        self._scene: Any = o3d.t.geometry.RaycastingScene()
        self._object_id = _NO_OBJECT if mesh is None else self._add(mesh.vertices_m, mesh.faces)
        corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * _TABLE_HALF_SIZE_M
        self._add(corners + table_center_m, np.array([[0, 1, 2], [0, 2, 3]]))
        self.lamp_m: FloatArray | None = table_center_m + np.array([0.7, -0.5, 1.6]) if is_lit else None

    def cast(self, origin_m: FloatArray, directions: FloatArray) -> Hits:
        """Follow rays (H, W, 3) from one origin (3,)."""
        answer = self._scene.cast_rays(self._rays(origin_m, directions))
        distance = answer["t_hit"].numpy().astype(float)
        reach = np.where(np.isfinite(distance), distance, 0.0)
        return Hits(
            distance=distance,
            points_m=origin_m + reach[..., None] * directions,
            normals=answer["primitive_normals"].numpy().astype(float),
            on_object=np.equal(
                answer["geometry_ids"].numpy(), -1 if self._object_id is None else self._object_id
            ),
        )

    def hidden(self, points_m: FloatArray, from_m: FloatArray) -> BoolArray:
        """Whether something stands between `from_m` (3,) and each of the points (H, W, 3)."""
        rays = self._rays(from_m, points_m - from_m)
        blocked: BoolArray = self._scene.test_occlusions(rays, tnear=0.0, tfar=1 - _MARGIN).numpy()
        return blocked

    def _add(self, vertices_m: AnyArray, faces: AnyArray) -> int:
        vertices = self._tensor(vertices_m.astype(np.float32))
        return int(self._scene.add_triangles(vertices, self._tensor(faces.astype(np.uint32))))

    def _rays(self, origin_m: FloatArray, directions: FloatArray) -> Any:
        rays = np.empty((*directions.shape[:-1], 6), dtype=np.float32)
        rays[..., :3], rays[..., 3:] = origin_m, directions
        return self._tensor(rays)
