"""Reading meshes that people bring along, and reading and writing our own.

Whatever is wrong with a file is said in one sentence that names it. Meshes are in metres; OBJ, PLY, STL and
OFF have z up, GLB has y up by its standard (glTF 2.0, section 3.4) and is turned.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from core.errors import InputError, Remedy, SessionError
from core.files import is_file, read_content, reason
from core.geometry import AnyArray, rotation_x
from core.mesh import TriangleMesh
from core.mesh_topology import join, topology, weld
from core.progress import Reporter

MAX_FACES = 2_000_000
"""More are refused before they are read: at 5 million, simplifying alone would take minutes and gigabytes."""
MAX_EXTENT_M = 3.0
MIN_EXTENT_M = 0.005
_CENTIMETRES_BELOW = 30.0
"""A larger number is taken for millimetres: household objects measure 3 to 30 cm, 30 mm and more."""
_CHUNK_BYTES = 1 << 24
_TEXT_ONLY = (".obj", ".off")
_PLY_FACE = np.dtype([("count", "u1"), ("corners", "<i4", (3,))])
_PLY_HEADER = (
    "ply\nformat binary_little_endian 1.0\ncomment metres\n"
    "element vertex {vertices}\nproperty double x\nproperty double y\nproperty double z\n"
    "element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
)


def read_mesh(path: Path, reporter: Reporter) -> TriangleMesh:
    """Read all parts of an OBJ, PLY, STL, OFF or GLB file as one mesh, in metres and z up.

    Equal vertices are joined; faces without area and unused vertices are dropped. Open and non-manifold edges
    and faces wound opposite to their neighbours are reported as warnings: rays and candies meet a surface,
    whether or not it encloses a volume.

    Raises:
        InputError: the file is missing, unreadable, empty, not in metres, inside out or has more than two
            million faces.
    """
    parts = read_mesh_parts(path, reporter)
    mesh = join(parts)
    if len(parts) > 1 and not all(topology(part).is_closed for part in parts):
        # Parts of one surface (such as one per material) meet in vertices that the file repeats.
        mesh = weld(mesh)
    _check_topology(path, mesh, reporter)
    return mesh


def read_mesh_parts(path: Path, reporter: Reporter) -> tuple[TriangleMesh, ...]:
    """Read the parts of a file one by one, in its order: the `o` groups of an OBJ, the nodes of a GLB.

    Each is cleaned as in `read_mesh`; how its faces hang together is not judged.

    Raises:
        InputError: the file is missing, unreadable, empty, not in metres or has more than two million faces.
    """
    _check_file(path)
    reporter.raise_if_cancelled()
    raw = _load(path)
    _check_numbers(path, raw)
    parts = tuple(part for part in map(weld, raw) if len(part.faces))
    if not parts:
        raise InputError(f"{path} has no face with an area; export the mesh again.")
    return parts


def write_mesh(path: Path, mesh: TriangleMesh) -> None:
    """Write a mesh as binary PLY or as OBJ, by the path's ending, every coordinate exactly as it is.

    Raises:
        InputError: another ending.
        OSError: the disk is full or the folder cannot be written.
    """
    writers = {".ply": write_ply, ".obj": _write_obj}
    writer = writers.get(path.suffix.lower())
    if writer is None:
        raise InputError(f"{path} cannot be written: meshes are written as .ply or .obj.")
    writer(path, mesh)


def write_ply(path: Path, mesh: TriangleMesh) -> None:
    """Write a mesh as binary PLY in double precision, so that reading gives back what was written."""
    faces = np.empty(len(mesh.faces), dtype=_PLY_FACE)
    faces["count"], faces["corners"] = 3, mesh.faces
    header = _PLY_HEADER.format(vertices=len(mesh.vertices_m), faces=len(mesh.faces)).encode()
    path.write_bytes(header + mesh.vertices_m.astype("<f8").tobytes() + faces.tobytes())


def colored_mesh_content(mesh: TriangleMesh, rgb: AnyArray, ending: str) -> bytes:
    """Return a PLY or GLB file (by its ending) of a mesh with colours (V, 3), uint8 in sRGB; GLB has y up."""
    import trimesh

    is_glb = ending == ".glb"
    places_m = mesh.vertices_m @ rotation_x(-np.pi / 2).T if is_glb else mesh.vertices_m
    colors = _linear(rgb) if is_glb else rgb
    colored = trimesh.Trimesh(places_m, mesh.faces, vertex_colors=colors, process=False)
    content = colored.export(file_type=ending[1:])
    assert isinstance(content, bytes), "these two formats are binary"
    return content


def _linear(rgb: AnyArray) -> AnyArray:
    """Colours as glTF wants them: proportional to light, not to what a screen is told (IEC 61966-2-1)."""
    share = rgb / 255
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    rounded: AnyArray = np.rint(255 * linear).astype(np.uint8)
    return rounded


def read_ply(path: Path) -> TriangleMesh:
    """Read a mesh that `write_ply` wrote.

    Raises:
        SessionError: the file is missing, damaged or of another kind.
    """
    try:
        content = read_content(path)
        end = content.index(b"end_header\n") + len(b"end_header\n")
        lines = content[:end].decode("ascii").splitlines()
        n_vertices, n_faces = (int(line.split()[-1]) for line in lines if line.startswith("element"))
        if content[:end] != _PLY_HEADER.format(vertices=n_vertices, faces=n_faces).encode():
            raise ValueError("another kind of PLY")
        vertices = np.frombuffer(content, "<f8", count=3 * n_vertices, offset=end).reshape(-1, 3)
        faces = np.frombuffer(content, _PLY_FACE, count=n_faces, offset=end + vertices.nbytes)["corners"]
        if not (
            n_faces > 0 and faces.min() >= 0 and faces.max() < n_vertices and np.isfinite(vertices).all()
        ):
            raise ValueError(
                "no faces, a face of vertices that it does not hold, or a vertex that is no number"
            )
    except (OSError, ValueError) as error:
        raise SessionError(f"{path} cannot be read ({reason(error)}).", Remedy.RUN_AGAIN) from error
    return TriangleMesh(vertices.astype(np.float64), faces.astype(np.int64))


def _check_file(path: Path) -> None:
    if not is_file(path):
        raise InputError(f"There is no mesh file {path}; check the name.")
    counter = _FACE_COUNTERS.get(path.suffix.lower())
    if counter is None:
        known = ", ".join(_FACE_COUNTERS)
        raise InputError(f"{path} is not a readable mesh file; convert it to one of {known}.")
    try:
        n_faces = counter(path)
    except (OSError, ValueError) as error:
        raise _unreadable(path, error) from error
    _check_face_count(path, n_faces)
    if path.suffix.lower() in _TEXT_ONLY:
        _check_text(path)


def _check_text(path: Path) -> None:
    """Refuse what the parser would take for something else than it is."""
    content = path.read_bytes()
    if content[:2] in (b"\xff\xfe", b"\xfe\xff") or b"\0" in content:
        raise InputError(f"{path} is no text in ASCII or UTF-8; export it again.")
    if path.suffix.lower() == ".obj":
        _check_obj(path, content)


def _check_obj(path: Path, content: bytes) -> None:
    counts_back = False
    for number, line in enumerate(content.splitlines(), 1):
        words = line.split()
        kind = words[0] if words else b""
        if kind == b"v" and len(words) < 4:
            raise InputError(f"{path} has a vertex with fewer than three coordinates in line {number}.")
        if kind == b"v" and counts_back:
            # The parser counts from the last vertex of the file, the format from the last one so far.
            raise InputError(f"{path} counts vertices backwards from line {number}; export it without that.")
        if kind == b"f":
            if b"0" in words or any(word.startswith(b"0/") for word in words):
                raise InputError(f"In {path}, line {number}, a face names vertex 0; OBJ counts from 1.")
            counts_back = counts_back or b" -" in line


def _check_face_count(path: Path, n_faces: int) -> None:
    if n_faces > MAX_FACES:
        raise InputError(
            f"{path} has {n_faces:,} faces, more than the {MAX_FACES:,} that can be handled; "
            "simplify it in a mesh tool (10,000 are plenty) and try again."
        )


def _unreadable(path: Path, error: BaseException) -> InputError:
    return InputError(f"{path} cannot be read as a mesh ({reason(error)}); export it again.")


def _load(path: Path) -> list[TriangleMesh]:
    import trimesh

    logging.getLogger("trimesh").setLevel(logging.CRITICAL)  # it logs tracebacks of what it can do without
    options: dict[str, Any] = {"process": False}
    if path.suffix.lower() == ".obj":
        options |= {"split_objects": True, "group_material": False, "skip_materials": True}
    try:
        scene = trimesh.load_scene(path, **options)
        meshes = [part for part in scene.dump() if isinstance(part, trimesh.Trimesh)]
        parts = [
            TriangleMesh(np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces, dtype=np.int64))
            for mesh in meshes
        ]
        if not all(part.vertices_m.shape[1:] == part.faces.shape[1:] == (3,) for part in parts):
            raise ValueError("its vertices or faces do not have three numbers each")
    except Exception as error:  # each format's parser raises its own
        raise _unreadable(path, error) from error
    if path.suffix.lower() == ".glb":
        return [TriangleMesh(part.vertices_m @ rotation_x(np.pi / 2).T, part.faces) for part in parts]
    return parts[::-1] if path.suffix.lower() == ".obj" else parts  # trimesh hands groups out last first


def _check_numbers(path: Path, parts: list[TriangleMesh]) -> None:
    n_faces = sum(len(part.faces) for part in parts)
    if n_faces == 0:
        raise InputError(f"{path} has no faces; export it as a triangle mesh, not as points or lines.")
    _check_face_count(path, n_faces)
    if any(
        part.faces.min() < 0 or part.faces.max() >= len(part.vertices_m) for part in parts if len(part.faces)
    ):
        raise InputError(f"{path} has faces that name vertices it does not hold; export it again.")
    used = np.concatenate([part.vertices_m[part.faces].reshape(-1, 3) for part in parts])
    if not np.isfinite(used).all():
        raise InputError(f"{path} has vertices that are not finite numbers; repair it in a mesh tool.")
    _check_size(path, 2 * float(np.max(used.max(axis=0) / 2 - used.min(axis=0) / 2)))


def _check_size(path: Path, extent_m: float) -> None:
    if extent_m < MIN_EXTENT_M:
        raise InputError(
            f"{path} is only {extent_m * 1000:.3g} mm large, smaller than a candy; meshes must be in metres."
        )
    if extent_m <= MAX_EXTENT_M:
        return
    if extent_m < _CENTIMETRES_BELOW:
        hint = "which looks like centimetres; scale it by 0.01"
    elif extent_m <= 1000 * MAX_EXTENT_M:
        hint = "which looks like millimetres; scale it by 0.001"
    else:
        hint = "larger than any cell; scale it"
    raise InputError(f"{path} would be {extent_m:.4g} m large, {hint}, meshes must be in metres.")


def _check_topology(path: Path, mesh: TriangleMesh, reporter: Reporter) -> None:
    facts = topology(mesh)
    if facts.is_closed and facts.is_consistent and mesh.volume_m3 < 0:
        raise InputError(
            f"{path} is inside out: its faces point inwards (volume {mesh.volume_m3 * 1e6:.0f} ml); "
            "flip them in a mesh tool."
        )
    if facts.n_crowded:
        reporter.warn(
            f"{path} has {facts.n_crowded} non-manifold edges, shared by more than two faces: it is taken as "
            "a surface, and its volume is unknown."
        )
    elif facts.n_open:
        reporter.warn(
            f"{path} is not closed ({facts.n_open} open edges): it is taken as a surface, whose holes "
            "candies may fall through, and its volume is unknown."
        )
    if not facts.is_consistent:
        reporter.warn(f"{path} has neighbouring faces wound to opposite sides; its volume is unknown.")


def _count_stl(path: Path) -> int:
    with path.open("rb") as file:
        head = file.read(84)
    claimed = int.from_bytes(head[80:84], "little") if len(head) == 84 else 0
    if path.stat().st_size == 84 + 50 * claimed:
        return claimed
    return _count_in_text(path, b"endfacet")


def _count_ply(path: Path) -> int:
    with path.open("rb") as file:
        header = file.read(1 << 16).partition(b"end_header")[0]
    for line in header.splitlines():
        words = line.split()
        if words[:2] == [b"element", b"face"] and len(words) == 3:
            return int(words[2])
    return 0


def _count_off(path: Path) -> int:
    with path.open("rb") as file:
        head = file.read(1 << 12)
    words = b" ".join(line.partition(b"#")[0] for line in head.splitlines()).split()
    return int(words[2]) if len(words) > 2 else 0


def _count_obj(path: Path) -> int:
    return _count_in_text(path, b"\nf ")


def _count_in_text(path: Path, word: bytes) -> int:
    """Occurrences of `word`, read in chunks: counting costs no memory, parsing would."""
    n, tail = 0, b""
    with path.open("rb") as file:
        while chunk := file.read(_CHUNK_BYTES):
            n += (tail + chunk).count(word)
            tail = (tail + chunk)[1 - len(word) :]
    return n


def _count_later(path: Path) -> int:  # noqa: ARG001
    """GLB holds plain arrays, which load fast; they are counted afterwards."""
    return 0


_FACE_COUNTERS: dict[str, Callable[[Path], int]] = {
    ".obj": _count_obj,
    ".ply": _count_ply,
    ".stl": _count_stl,
    ".off": _count_off,
    ".glb": _count_later,
}


def _write_obj(path: Path, mesh: TriangleMesh) -> None:
    vertices = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices_m.tolist()]
    faces = [f"f {a} {b} {c}" for a, b, c in (mesh.faces + 1).tolist()]
    path.write_text("\n".join([*vertices, *faces, ""]), encoding="ascii")
