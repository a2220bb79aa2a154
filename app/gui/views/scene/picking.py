"""What a click hits. Done in numpy when there is a click, never per frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from app.gui.views.scene.camera import Ray
from core.geometry import AnyArray, FloatArray, IntArray

Hit = tuple[float, int]
"""Distance from the eye in metres, and the index of what was met."""

_REACH_PX = 8
"""How far beside a point a click may be."""


class Target(Protocol):
    """Something a click can hit."""

    def hit(self, ray: Ray) -> Hit | None:
        """The first thing on a line of sight in the target's frame, or None."""


@dataclass(frozen=True, eq=False)
class FaceTarget:
    """Triangles; the index is the face's, or the one given for it.

    Attributes:
        vertices_m: (N, 3).
        faces: (F, 3) of vertex indices.
        element_of_face: (F,) index to report instead of the face's.
    """

    vertices_m: AnyArray
    faces: AnyArray
    element_of_face: IntArray | None = None

    def hit(self, ray: Ray) -> Hit | None:
        """The first face on a line of sight; 200,000 faces take some milliseconds."""
        candidates = np.flatnonzero(_may_meet(self.vertices_m, self.faces, ray))
        corners = self.vertices_m[self.faces[candidates]].astype(float)
        distances = _distances_to_faces(corners, ray)
        if not np.isfinite(distances).any():
            return None
        k = int(np.argmin(distances))
        face = int(candidates[k])
        element = face if self.element_of_face is None else int(self.element_of_face[face])
        return float(distances[k]), element


@dataclass(eq=False)
class BallTarget:
    """Balls of one size, or points if it is zero; NaN ones are absent.

    Attributes:
        centers_m: (N, 3); may be replaced.
        radius_m: of each.
    """

    centers_m: FloatArray
    radius_m: float = 0.0

    def hit(self, ray: Ray) -> Hit | None:
        """The first ball on a line of sight."""
        if not len(self.centers_m):
            return None
        offset = self.centers_m - ray.origin_m
        along = offset @ ray.direction
        aside = np.linalg.norm(offset - along[:, None] * ray.direction, axis=1)
        reach = np.maximum(self.radius_m, _REACH_PX * ray.spread * along if self.radius_m == 0 else 0)
        near = np.where((along > 0) & (aside <= reach), along - self.radius_m, np.inf)
        k = int(np.argmin(near))
        return (float(near[k]), k) if np.isfinite(near[k]) else None


def _may_meet(vertices_m: AnyArray, faces: AnyArray, ray: Ray) -> npt.NDArray[np.bool_]:
    """Which faces (F,) are not wholly on one side of a line, seen along it from two perpendicular sides."""
    first, second = _across(ray.direction)
    offset = np.asarray(vertices_m, dtype=np.float64) - ray.origin_m
    sides = (offset @ first > 0).astype(np.uint8) | (offset @ second > 0).astype(np.uint8) << 1
    at = [sides[faces[:, k]] for k in range(3)]
    some, every = at[0] | at[1] | at[2], at[0] & at[1] & at[2]
    may_meet: npt.NDArray[np.bool_] = (some ^ every) == 3
    return may_meet


def _distances_to_faces(corners_m: FloatArray, ray: Ray) -> FloatArray:
    """Distance (F,) along a line to triangles (F, 3, 3), infinite where it misses (Moeller and Trumbore)."""
    a, b, c = corners_m[:, 0], corners_m[:, 1], corners_m[:, 2]
    u_edge, v_edge = b - a, c - a
    p = np.cross(ray.direction, v_edge)
    determinant = np.einsum("ij,ij->i", u_edge, p)
    with np.errstate(divide="ignore", invalid="ignore"):
        to_origin = ray.origin_m - a
        u = np.einsum("ij,ij->i", to_origin, p) / determinant
        q = np.cross(to_origin, u_edge)
        v = q @ ray.direction / determinant
        distance = np.einsum("ij,ij->i", v_edge, q) / determinant
        is_met = (u >= 0) & (v >= 0) & (u + v <= 1) & (distance > 0)
    return np.where(is_met, distance, np.inf)


def _across(direction: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Two unit vectors (3,), perpendicular to a direction and to each other."""
    helper = np.eye(3)[int(np.abs(direction).argmin())]
    first = np.cross(direction, helper)
    first /= np.linalg.norm(first)
    return first, np.cross(direction, first)
