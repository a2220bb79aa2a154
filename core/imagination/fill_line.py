"""Where a level filling would meet the walls of an object's hollows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry import BoolArray, FloatArray, IntArray
from core.imagination.hollow_map import HollowMap
from core.mesh import TriangleMesh

_BESIDE_PITCHES = (1.0, 2.0)
"""So far in front of a wall it is asked whether something is held there."""


@dataclass(frozen=True)
class FillLine:
    """A level as a line on the walls, in the frame of the object's mesh.

    Attributes:
        ends_m: (K, 2, 3) its pieces.
        normals: (K, 3) level unit vectors from the wall into the hollow.
    """

    ends_m: FloatArray
    normals: FloatArray


def fill_line(surface: TriangleMesh, hollows: HollowMap, height_m: float) -> FillLine:
    """Cut the walls of the hollows with a level plane; without a hollow at that height there are no pieces.

    Args:
        surface: of the object at rest; its faces are turned outwards.
        hollows: of the object, in the frame of the surface.
        height_m: of the plane, in that frame.
    """
    faces = _faces_across(surface, height_m)
    ends_m = _cut(surface.vertices_m[faces], height_m)
    normals = _level_normals(surface.vertices_m[faces])
    middles_m = ends_m.mean(axis=1)[:, :2]
    holds: BoolArray = np.zeros(len(faces), dtype=bool)
    for pitches in _BESIDE_PITCHES:
        holds |= hollows.holds_at(middles_m + pitches * hollows.pitch_m * normals[:, :2], height_m)
    return FillLine(ends_m[holds], normals[holds])


def _faces_across(surface: TriangleMesh, height_m: float) -> IntArray:
    """The faces (K, 3) with corners on both sides, each turned so that its first corner is alone on one."""
    is_above = surface.vertices_m[surface.faces, 2] > height_m
    is_across = is_above.any(axis=1) & ~is_above.all(axis=1)
    faces, above = surface.faces[is_across], is_above[is_across]
    is_alone = above == (above.sum(axis=1) == 1)[:, None]
    turned = (is_alone.argmax(axis=1)[:, None] + np.arange(3)) % 3
    return np.take_along_axis(faces, turned, axis=1)


def _cut(corners_m: FloatArray, height_m: float) -> FloatArray:
    """The pieces (K, 2, 3) in which triangles (K, 3, 3) meet the plane; each first corner is alone."""
    alone, others = corners_m[:, :1], corners_m[:, 1:]
    share = (height_m - alone[..., 2:]) / (others[..., 2:] - alone[..., 2:])
    ends_m: FloatArray = alone + share * (others - alone)
    return ends_m


def _level_normals(corners_m: FloatArray) -> FloatArray:
    """The normals (K, 3) of triangles (K, 3, 3) that stand across a level plane, without their slope."""
    normals = np.cross(corners_m[:, 1] - corners_m[:, 0], corners_m[:, 2] - corners_m[:, 0])
    normals[:, 2] = 0.0
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    level: FloatArray = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    return level
