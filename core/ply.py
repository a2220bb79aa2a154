"""Triangle meshes as binary PLY with double precision, so that reading gives back what was written."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from core.errors import SessionError
from core.mesh import TriangleMesh

FACE = np.dtype([("count", "u1"), ("corners", "<i4", (3,))])
HEADER = (
    "ply\nformat binary_little_endian 1.0\ncomment metres\n"
    "element vertex {vertices}\nproperty double x\nproperty double y\nproperty double z\n"
    "element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
)


def write_ply(path: Path, mesh: TriangleMesh) -> None:
    """Write the mesh."""
    faces = np.empty(len(mesh.faces), dtype=FACE)
    faces["count"], faces["corners"] = 3, mesh.faces
    header = HEADER.format(vertices=len(mesh.vertices_m), faces=len(mesh.faces)).encode()
    path.write_bytes(header + mesh.vertices_m.astype("<f8").tobytes() + faces.tobytes())


def read_ply(path: Path) -> TriangleMesh:
    """Read a mesh that `write_ply` wrote.

    Raises:
        SessionError: the file is missing, damaged or of another kind.
    """
    try:
        content = path.read_bytes()
        end = content.index(b"end_header\n") + len(b"end_header\n")
        lines = content[:end].decode("ascii").splitlines()
        n_vertices, n_faces = (int(line.split()[2]) for line in lines if line.startswith("element"))
        if content[:end] != HEADER.format(vertices=n_vertices, faces=n_faces).encode():
            raise ValueError("another kind of PLY")
        vertices = np.frombuffer(content, "<f8", count=3 * n_vertices, offset=end).reshape(-1, 3)
        faces = np.frombuffer(content, FACE, count=n_faces, offset=end + vertices.nbytes)["corners"]
    except (OSError, ValueError) as error:
        raise SessionError(f"{path} cannot be read ({error}); run the stage that writes it again.") from error
    return TriangleMesh(vertices.astype(np.float64), faces.astype(np.int64))
