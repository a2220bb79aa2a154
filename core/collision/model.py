"""What the physics collides with."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from core.errors import Remedy, SessionError
from core.files import read_arrays, read_json, write_arrays, write_json
from core.geometry import AnyArray, FloatArray
from core.mesh import TriangleMesh
from core.mesh_topology import join
from core.unseen_readings import UnseenReadings

GIVEN = "given"
"""Method of a model whose convex parts were not made here but read."""
_TABLE = "collision.json"
_ARRAYS = "collision.npz"


@dataclass(frozen=True)
class CollisionModel:
    """A body for the physics.

    Attributes:
        method: `exact`: one part, any shape, to be used as a static triangle mesh. `vhacd`, `coacd` and
            `given`: convex parts.
        parts: meshes in metres, in the frame of the surface.
        surface: the true surface, simplified; its AABB decides which particle is inside (Sec. III-A).
        unseen: other surfaces that the scan allows, simplified as well, the hollow one finely; none where it
            saw everything.
        surface_error_m: how far the surface of a scan may lie from the true one; zero if it was given.
        detailed: the surface as it was before it was simplified, for what holes decide; not saved. None where
            it is not at hand.
    """

    method: str
    parts: tuple[TriangleMesh, ...]
    surface: TriangleMesh
    unseen: UnseenReadings | None = None
    surface_error_m: float = 0.0
    detailed: TriangleMesh | None = None

    @classmethod
    def exact(cls, surface: TriangleMesh, unseen: UnseenReadings | None = None) -> CollisionModel:
        """Return the body that is a surface as it is."""
        return cls("exact", (surface,), surface, unseen)

    @property
    def is_convex(self) -> bool:
        """Whether each part is to be used as a convex hull."""
        return self.method != "exact"

    @property
    def most_detailed(self) -> TriangleMesh:
        """The surface with all the faces that are at hand."""
        return self.surface if self.detailed is None else self.detailed

    @property
    def aabb_min_m(self) -> FloatArray:
        """Lower corner (3,) of the surface's axis-aligned bounding box."""
        return self.surface.aabb_min_m

    @property
    def aabb_max_m(self) -> FloatArray:
        """Upper corner (3,) of the surface's axis-aligned bounding box."""
        return self.surface.aabb_max_m

    def save(self, folder: Path) -> None:
        """Write `collision.npz` (exact coordinates) and `collision.json` into an existing folder."""
        if self.unseen is not None:
            self.unseen.save(folder)
        write_arrays(
            folder / _ARRAYS,
            part_n_vertices=np.array([len(part.vertices_m) for part in self.parts]),
            part_n_faces=np.array([len(part.faces) for part in self.parts]),
            part_vertices_m=np.concatenate([part.vertices_m for part in self.parts]),
            part_faces=np.concatenate([part.faces for part in self.parts]),
            surface_vertices_m=self.surface.vertices_m,
            surface_faces=self.surface.faces,
        )
        write_json(
            folder / _TABLE,
            {
                "method": self.method,
                "surface_error_m": self.surface_error_m,
                "n_parts": len(self.parts),
                "n_faces": len(join(self.parts).faces),
                "aabb_min_m": self.aabb_min_m.tolist(),
                "aabb_max_m": self.aabb_max_m.tolist(),
            },
        )

    @classmethod
    def load(cls, folder: Path) -> CollisionModel:
        """Read what `save` wrote.

        Raises:
            SessionError: a file is missing or damaged.
        """
        table, arrays = read_json(folder / _TABLE), read_arrays(folder / _ARRAYS)
        try:
            vertices = _cut(arrays["part_vertices_m"], arrays["part_n_vertices"])
            faces = _cut(arrays["part_faces"], arrays["part_n_faces"])
            parts = tuple(TriangleMesh(v, f) for v, f in zip(vertices, faces, strict=True))
            surface = TriangleMesh(arrays["surface_vertices_m"], arrays["surface_faces"])
            error_m = float(table.get("surface_error_m", 0.0))
            return cls(str(table["method"]), parts, surface, UnseenReadings.load(folder), error_m)
        except (KeyError, ValueError) as error:
            raise SessionError(
                f"The collision model in {folder} is damaged ({error}).", Remedy.RUN_AGAIN
            ) from error


def _cut(rows: AnyArray, lengths: AnyArray) -> list[AnyArray]:
    return np.split(rows, np.cumsum(lengths)[:-1])
