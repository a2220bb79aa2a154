"""Handing a collision body to the workers: one OBJ file that Bullet reads in C, whatever its size."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from core.mesh import TriangleMesh
from core.scratch import ScratchFolder


@dataclass(frozen=True)
class BodyFile:
    """A file with one convex hull per `o` group, or, if `is_concave`, one triangle surface taken as it is."""

    path: str
    is_concave: bool


def write_body(path: Path, parts: Sequence[TriangleMesh], is_concave: bool) -> BodyFile:
    """Write a body to an OBJ file and return what the workers need to read it."""
    path.write_text(_obj_text(parts), encoding="ascii")
    return BodyFile(str(path), is_concave)


@contextmanager
def body_files(**bodies: tuple[Sequence[TriangleMesh], bool]) -> Iterator[dict[str, BodyFile]]:
    """Write bodies given as `name=(parts, is_concave)` to a folder that lives as long as the context."""
    with ScratchFolder() as folder:
        yield {
            name: write_body(folder / f"{name}.obj", parts, is_concave)
            for name, (parts, is_concave) in bodies.items()
        }


def _obj_text(parts: Sequence[TriangleMesh]) -> str:
    lines: list[str] = []
    first = 1
    for index, part in enumerate(parts):
        lines.append(f"o part_{index}")
        lines += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in part.vertices_m.tolist()]
        lines += [f"f {a} {b} {c}" for a, b, c in (part.faces + first).tolist()]
        first += len(part.vertices_m)
    return "\n".join(lines) + "\n"
