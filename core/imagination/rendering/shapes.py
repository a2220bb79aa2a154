"""Surfaces to look at, as OBJ files with normals: the only form in which every Bullet renderer takes them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from core.geometry import AnyArray, FloatArray
from core.imagination.cup import inner_radius_m
from core.imagination.particle_shape import particle_extents_m, shape_of
from core.mesh import TriangleMesh
from core.parameters.bodies import CupParameters, ParticleParameters

_CREASE_COSINE = 0.85
_FEW = 0.01
_STAND_OFF = 0.003
_CANDY_SIDES = 12
_CUP_SIDES = 64


def write_obj(path: Path, mesh: TriangleMesh, scale: float) -> None:
    """Write a mesh, enlarged by `scale`, with normals that are smooth except at creases.

    Renderers draw the outside of a face only; of a mesh whose faces disagree about it both sides are written.
    """
    if not _faces_outwards(mesh):
        mesh = _with_backs(mesh)
    smooth, flat = _normals(mesh)
    # A corner takes the vertex's normal unless the surface has an edge there, as a box has.
    has_crease = np.einsum("fkj,fj->fk", smooth[mesh.faces], flat) < _CREASE_COSINE
    own_normals = len(smooth) + np.arange(len(flat))[:, None]
    normal_indices = np.where(has_crease, own_normals, mesh.faces) + 1
    corners = np.stack([mesh.faces + 1, normal_indices], axis=-1).reshape(-1, 6)
    lines = ["v {:.6g} {:.6g} {:.6g}".format(*vertex) for vertex in (mesh.vertices_m * scale).tolist()]
    lines += ["vn {:.4f} {:.4f} {:.4f}".format(*normal) for normal in np.vstack([smooth, flat]).tolist()]
    lines += ["f {}//{} {}//{} {}//{}".format(*face) for face in corners.tolist()]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


def candy_mesh(particle: ParticleParameters) -> TriangleMesh:
    """Surface of a candy about its centre, flat in z; few faces, because hundreds are drawn.

    Raises:
        StageError: nobody knows its shape.
    """
    outline = shape_of(particle).outline
    unit = _revolved([(0.0, 1.0), *outline, (0.0, -1.0)], _CANDY_SIDES)
    return TriangleMesh(unit.vertices_m * particle_extents_m(particle) / 2, unit.faces)


def cup_surface(cup: CupParameters) -> TriangleMesh:
    """Closed surface of the cup in its own frame: origin at the outer centre of the base, z to the mouth.

    Its faces go from the inside to the outside: drawn in this order with a transparent colour it looks like
    glass.
    """
    profile = [
        (0.0, cup.wall_m),
        (float(inner_radius_m(cup, cup.wall_m)), cup.wall_m),
        (float(inner_radius_m(cup, cup.length_m)), cup.length_m),
        (cup.mouth_radius_m, cup.length_m),
        (float(inner_radius_m(cup, 0.0)) + cup.wall_m, 0.0),
        (0.0, 0.0),
    ]
    return _revolved(profile, _CUP_SIDES)


def write_ground_obj(
    path: Path, center_m: FloatArray, half_width_m: float, normal: FloatArray, scale: float
) -> None:
    """Write a square seen from above only, shaded as if it faced along `normal` (3,)."""
    corners = (center_m + half_width_m * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])) * scale
    lines = ["v {:.6g} {:.6g} {:.6g}".format(*corner) for corner in corners.tolist()]
    lines += ["vn {:.4f} {:.4f} {:.4f}".format(*normal), "f 1//1 2//1 3//1", "f 1//1 3//1 4//1"]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


def _faces_outwards(mesh: TriangleMesh) -> bool:
    """Whether the faces enclose a volume and turn their outside outwards, except for a few."""
    n = np.int64(len(mesh.vertices_m))
    starts, ends = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
    is_open = ~np.isin(starts * n + ends, ends * n + starts)
    return float(is_open.mean()) < _FEW and mesh.volume_m3 > 0


def _with_backs(mesh: TriangleMesh) -> TriangleMesh:
    """Add a copy turned inside out; it stands off a little, or the two would shade each other."""
    smooth, _ = _normals(mesh)
    back = mesh.vertices_m - _STAND_OFF * np.linalg.norm(mesh.extents_m) * smooth
    faces = np.vstack([mesh.faces, mesh.faces[:, ::-1] + len(back)])
    return TriangleMesh(np.vstack([mesh.vertices_m, back]), faces)


def _normals(mesh: TriangleMesh) -> tuple[FloatArray, FloatArray]:
    """Unit normals of the vertices (V, 3), weighted by area, and of the faces (F, 3)."""
    a, b, c = (mesh.vertices_m[mesh.faces[:, k]] for k in range(3))
    areas = np.cross(b - a, c - a)
    at_vertices = np.column_stack(
        [
            np.bincount(mesh.faces.ravel(), np.repeat(areas[:, axis], 3), minlength=len(mesh.vertices_m))
            for axis in range(3)
        ]
    )
    return _unit(at_vertices), _unit(areas)


def _unit(vectors: AnyArray) -> FloatArray:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    unit: FloatArray = vectors / np.where(lengths > 0, lengths, 1)
    return unit


def _revolved(profile: list[tuple[float, float]], sides: int) -> TriangleMesh:
    """Turn a profile of (radius, height) about z; its ends lie on the axis, its outside is on its left."""
    angles = np.arange(sides) * 2 * np.pi / sides
    rings = [
        np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.full(sides, height)])
        for radius, height in profile[1:-1]
    ]
    n = len(rings) * sides
    ends = [[0.0, 0.0, profile[0][1]], [0.0, 0.0, profile[-1][1]]]
    k = np.arange(sides)
    after = np.roll(k, -1)
    faces = [np.column_stack([np.full(sides, n), k, after])]
    for here in range(0, n - sides, sides):
        there = here + sides
        faces.append(np.column_stack([here + k, there + k, there + after]))
        faces.append(np.column_stack([here + k, there + after, here + after]))
    last = n - sides
    faces.append(np.column_stack([np.full(sides, n + 1), last + after, last + k]))
    return TriangleMesh(np.vstack([*rings, ends]), np.vstack(faces).astype(np.int64))
