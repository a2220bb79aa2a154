"""A surface that was not scanned but given: a mesh, and the convex parts it may have come in."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from core.collision import CollisionModel, from_parts
from core.mesh import TriangleMesh
from core.mesh_file import read_mesh, read_mesh_parts, read_ply, write_ply
from core.mesh_topology import is_convex, join
from core.progress import Reporter

_MESH_FILE, _PARTS_FILE = "mesh.ply", "collision.json"


@dataclass(frozen=True)
class GivenMesh:
    """A given surface.

    Attributes:
        mesh: in metres, at rest, z up.
        parts: its convex parts, if it came in such; else none.
    """

    mesh: TriangleMesh
    parts: CollisionModel | None = None

    @classmethod
    def read(cls, path: Path, reporter: Reporter) -> GivenMesh:
        """Read a mesh file; one of several convex parts keeps them.

        Raises:
            InputError: the mesh cannot be used as it is.
        """
        parts = read_mesh_parts(path, reporter)
        if len(parts) > 1 and all(map(is_convex, parts)):
            return cls(join(parts), from_parts(parts))
        return cls(read_mesh(path, reporter))

    def save(self, folder: Path) -> None:
        """Write `mesh.ply`, and the parts if there are any."""
        write_ply(folder / _MESH_FILE, self.mesh)
        if self.parts is not None:
            self.parts.save(folder)

    @classmethod
    def load(cls, folder: Path) -> GivenMesh:
        """Read what `save` wrote."""
        has_parts = (folder / _PARTS_FILE).is_file()
        return cls(read_ply(folder / _MESH_FILE), CollisionModel.load(folder) if has_parts else None)
