"""A mesh with a colour at each vertex, and the files it goes into: PLY for measuring, GLB for showing."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from core.errors import Remedy, SessionError
from core.files import read_content, reason
from core.geometry import rotation_x
from core.mesh import TriangleMesh

ByteArray = npt.NDArray[np.uint8]

_VERTEX = np.dtype([("place_m", "<f8", (3,)), ("rgb", "u1", (3,))])
_FACE = np.dtype([("count", "u1"), ("corners", "<i4", (3,))])
_HEADER = (
    "ply\nformat binary_little_endian 1.0\ncomment metres\n"
    "element vertex {vertices}\nproperty double x\nproperty double y\nproperty double z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    "element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
)
_GLB_MAGIC, _JSON_CHUNK, _BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
_FLOAT, _UNSIGNED_INT, _UNSIGNED_BYTE = 5126, 5125, 5121
_VERTICES, _INDICES = 34962, 34963
"""glTF 2.0, sections 3.6 and 4.4."""


@dataclass(frozen=True, eq=False)
class ColoredMesh:
    """A mesh as it looks.

    Attributes:
        mesh: the surface.
        rgb: (V, 3) colour of each vertex, sRGB.
    """

    mesh: TriangleMesh
    rgb: ByteArray

    def write_ply(self, path: Path) -> None:
        """Write binary PLY in double precision."""
        vertices = np.empty(len(self.mesh.vertices_m), dtype=_VERTEX)
        vertices["place_m"], vertices["rgb"] = self.mesh.vertices_m, self.rgb
        faces = np.empty(len(self.mesh.faces), dtype=_FACE)
        faces["count"], faces["corners"] = 3, self.mesh.faces
        header = _HEADER.format(vertices=len(vertices), faces=len(faces)).encode()
        path.write_bytes(header + vertices.tobytes() + faces.tobytes())

    @classmethod
    def read_ply(cls, path: Path) -> ColoredMesh:
        """Read what `write_ply` wrote.

        Raises:
            SessionError: the file is missing, damaged or of another kind.
        """
        try:
            content = read_content(path)
            end = content.index(b"end_header\n") + len(b"end_header\n")
            lines = content[:end].decode("ascii").splitlines()
            n_vertices, n_faces = (int(line.split()[-1]) for line in lines if line.startswith("element"))
            if content[:end] != _HEADER.format(vertices=n_vertices, faces=n_faces).encode():
                raise ValueError("another kind of PLY")
            vertices = np.frombuffer(content, _VERTEX, count=n_vertices, offset=end)
            faces = np.frombuffer(content, _FACE, count=n_faces, offset=end + vertices.nbytes)["corners"]
            if n_faces and (faces.min() < 0 or faces.max() >= n_vertices):
                raise ValueError("a face of vertices that it does not hold")
        except (OSError, ValueError) as error:
            raise SessionError(f"{path} cannot be read ({reason(error)}).", Remedy.RUN_AGAIN) from error
        mesh = TriangleMesh(vertices["place_m"].astype(np.float64), faces.astype(np.int64))
        return cls(mesh, np.array(vertices["rgb"]))

    def write_glb(self, path: Path) -> None:
        """Write binary glTF 2.0, y up and in metres, as viewers and slide programs show it."""
        places = (self.mesh.vertices_m @ rotation_x(-np.pi / 2).T).astype("<f4")
        colors = np.full((len(places), 4), 255, dtype=np.uint8)
        colors[:, :3] = _linear(self.rgb)
        arrays = (
            (places, "VEC3", _FLOAT, _VERTICES),
            (colors, "VEC4", _UNSIGNED_BYTE, _VERTICES),
            (self.mesh.faces.astype("<u4").reshape(-1), "SCALAR", _UNSIGNED_INT, _INDICES),
        )
        views: list[dict[str, Any]] = []
        accessors: list[dict[str, Any]] = []
        start = 0
        for array, kind, component, target in arrays:
            view = {"buffer": 0, "byteOffset": start, "byteLength": array.nbytes, "target": target}
            accessor = {
                "bufferView": len(views), "componentType": component, "count": len(array), "type": kind
            }  # fmt: skip
            if component == _UNSIGNED_BYTE:
                accessor["normalized"] = True
            views.append(view)
            accessors.append(accessor)
            start += array.nbytes
        accessors[0] |= {"min": places.min(axis=0).tolist(), "max": places.max(axis=0).tolist()}
        primitive = {"attributes": {"POSITION": 0, "COLOR_0": 1}, "indices": 2, "material": 0}
        material = {
            "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.8},
            "doubleSided": True,
        }
        table = {
            "asset": {"version": "2.0", "generator": "Poursight"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [primitive]}],
            "materials": [material],
            "buffers": [{"byteLength": start}],
            "bufferViews": views,
            "accessors": accessors,
        }
        _write_chunks(path, json.dumps(table).encode(), b"".join(one[0].tobytes() for one in arrays))


def _linear(rgb: ByteArray) -> ByteArray:
    """The colours as glTF wants them: proportional to light, not to what a screen is told."""
    share = rgb / 255
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    rounded: ByteArray = np.rint(255 * linear).astype(np.uint8)
    return rounded


def _write_chunks(path: Path, table: bytes, binary: bytes) -> None:
    table += b" " * (-len(table) % 4)
    binary += b"\0" * (-len(binary) % 4)
    n_bytes = 12 + 8 + len(table) + 8 + len(binary)
    head = np.array([_GLB_MAGIC, 2, n_bytes, len(table), _JSON_CHUNK], dtype="<u4").tobytes()
    between = np.array([len(binary), _BINARY_CHUNK], dtype="<u4").tobytes()
    path.write_bytes(head + table + between + binary)
