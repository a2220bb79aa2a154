"""How near a solid truncated cone, such as a closed cup, comes to boxes and segments; many at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray

_PROJECTIONS = 40
"""Alternating projections between cone and box: near a box the bound is then mostly good to 0.1 mm."""
_EXACT_M = 1e-5
_GOLDEN = (np.sqrt(5) - 1) / 2
_SECTIONS = 20
"""Golden sections of a segment: what is left of 0.5 m is 0.03 mm."""
_TINY = 1e-12


@dataclass(frozen=True)
class Cone:
    """A solid truncated cone around the z-axis of its frame, from z = 0 up.

    Attributes:
        low_radius_m: at z = 0.
        high_radius_m: at the other end.
        height_m: from end to end.
    """

    low_radius_m: float
    high_radius_m: float
    height_m: float

    @property
    def middle_m(self) -> FloatArray:
        """(3,) middle of its axis."""
        return np.array([0.0, 0.0, self.height_m / 2])

    @property
    def reach_m(self) -> float:
        """Radius of the ball around `middle_m` that takes it in."""
        return float(np.hypot(max(self.low_radius_m, self.high_radius_m), self.height_m / 2))

    def nearest(self, points_m: FloatArray) -> FloatArray:
        """Return its points (..., 3) that are nearest to points (..., 3) of its frame."""
        radius = np.hypot(points_m[..., 0], points_m[..., 1])
        z = points_m[..., 2]
        widening = self.high_radius_m - self.low_radius_m
        inside_z = np.clip(z, 0, self.height_m)
        inside_radius = np.minimum(radius, self.low_radius_m + widening * inside_z / self.height_m)
        # the lids, or where the point is itself inside; then the slanted side, where that is nearer
        lid = np.stack([np.minimum(radius, np.where(z < self.height_m / 2, *self._radii)), inside_z], axis=-1)
        lid[..., 0] = np.where((z >= 0) & (z <= self.height_m), inside_radius, lid[..., 0])
        side = self._on_side(radius, z)
        flat = np.stack([radius, z], axis=-1)
        is_side = _squared(side - flat) < _squared(lid - flat)
        best = np.where(is_side[..., None], side, lid)
        scale = best[..., 0] / np.maximum(radius, _TINY)
        return np.stack([points_m[..., 0] * scale, points_m[..., 1] * scale, best[..., 1]], axis=-1)

    def distance(self, points_m: FloatArray) -> FloatArray:
        """Return how far (...) points (..., 3) of its frame are; 0 inside."""
        return np.asarray(np.sqrt(_squared(points_m - self.nearest(points_m))))

    def support(self, directions: FloatArray) -> FloatArray:
        """Return how far (...) it reaches along directions (..., 3) from its frame's origin."""
        across = np.hypot(directions[..., 0], directions[..., 1])
        high = self.high_radius_m * across + self.height_m * directions[..., 2]
        return np.maximum(self.low_radius_m * across, high)

    @property
    def _radii(self) -> tuple[float, float]:
        return self.low_radius_m, self.high_radius_m

    def _on_side(self, radius: FloatArray, z: FloatArray) -> FloatArray:
        """Nearest places (..., 2), radius and z, of the slanted side."""
        slant = np.array([self.high_radius_m - self.low_radius_m, self.height_m])
        along = ((radius - self.low_radius_m) * slant[0] + z * slant[1]) / (slant @ slant)
        return np.asarray(np.array([self.low_radius_m, 0.0]) + np.clip(along, 0, 1)[..., None] * slant)


def cone_segment_distance(cone: Cone, start_m: FloatArray, end_m: FloatArray) -> FloatArray:
    """Distances (...) between a cone and segments (..., 3) to (..., 3) of its frame; at most 0.03 mm too
    large for segments up to half a metre.

    Along a segment the distance to a convex body is convex: golden sections find its smallest value.
    """
    along = end_m - start_m
    low, high = np.zeros(start_m.shape[:-1]), np.ones(start_m.shape[:-1])
    first, second = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    at_first = cone.distance(start_m + first[..., None] * along)
    at_second = cone.distance(start_m + second[..., None] * along)
    for _ in range(_SECTIONS):
        left = at_first <= at_second
        high, low = np.where(left, second, high), np.where(left, low, first)
        place = np.where(left, high - _GOLDEN * (high - low), low + _GOLDEN * (high - low))
        value = cone.distance(start_m + place[..., None] * along)
        first, second = np.where(left, place, second), np.where(left, first, place)
        at_first, at_second = np.where(left, value, at_second), np.where(left, at_first, value)
    return np.minimum(at_first, at_second)


def cone_box_distance(
    cone: Cone, T_box_cone: FloatArray, half_size_m: FloatArray, exact_below_m: float = np.inf
) -> FloatArray:
    """Distances (M,) between a cone and boxes around their frames' origins; never too large, negative where
    they overlap.

    Every direction gives a lower bound, the gap between the two along it. The best one is among the box's
    own axes or is found by projecting a point from one body to the other and back (von Neumann).

    Args:
        cone: the cone.
        T_box_cone: (M, 4, 4) its pose in each box's frame.
        half_size_m: (M, 3) half the sides of each box.
        exact_below_m: larger distances may be given too small, but not below this.
    """
    origin = T_box_cone[:, :3, 3]
    # along the box's own axes: the cone's reach that way is its support
    up = T_box_cone[:, :3, :3]
    ahead = np.abs(origin + up @ cone.middle_m) - half_size_m - cone.reach_m
    bound = ahead.max(axis=1)
    for sign in (1.0, -1.0):
        gaps = sign * origin - cone.support(-sign * up) - half_size_m
        bound = np.maximum(bound, gaps.max(axis=1))
    near = bound < exact_below_m
    if near.any():
        bound[near] = _projected_gap(cone, T_box_cone[near], half_size_m[near], bound[near])
    return np.asarray(bound)


def _projected_gap(
    cone: Cone, T_box_cone: FloatArray, half_size_m: FloatArray, bound: FloatArray
) -> FloatArray:
    """The best bound (M,) that alternating projections find, or the given one (M,) if that is better."""
    rotation, origin = T_box_cone[:, :3, :3], T_box_cone[:, :3, 3]

    def gap(directions: FloatArray) -> FloatArray:
        """The room (M,) between box and cone along unit directions (M, 3) from the box to the cone."""
        in_cone = -np.einsum("mij,mi->mj", rotation, directions)
        nearest = np.einsum("mi,mi->m", origin, directions) - cone.support(in_cone)
        return np.asarray(nearest - (np.abs(directions) * half_size_m).sum(axis=-1))

    on_cone = np.einsum("mij,j->mi", rotation, cone.middle_m) + origin
    for _ in range(_PROJECTIONS):
        on_box = np.clip(on_cone, -half_size_m, half_size_m)
        in_cone = cone.nearest(np.einsum("mij,mi->mj", rotation, on_box - origin))
        on_cone = np.einsum("mij,mj->mi", rotation, in_cone) + origin
        between = on_cone - on_box
        length = np.sqrt(_squared(between))
        apart = length > _TINY
        direction = between / np.where(apart, length, 1.0)[:, None]
        bound = np.where(apart, np.maximum(bound, gap(direction)), bound)
        if np.where(apart, length - bound, 0.0).max() < _EXACT_M:
            break
    return np.asarray(bound)


def _squared(vectors: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("...i,...i->...", vectors, vectors))
