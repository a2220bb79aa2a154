"""Distances between segments, boxes and solid truncated cones, such as a closed cup; many at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray

_TINY = 1e-12
_PROJECTIONS = 40
"""Alternating projections between cone and box: close to a box the bound is then mostly good to 0.1 mm."""
_EXACT_M = 1e-5
_GOLDEN = (np.sqrt(5) - 1) / 2
_SECTIONS = 20
"""Golden sections of a segment: 0.5 m shrink to 0.03 mm."""


def segment_segment_distance(
    start_a_m: FloatArray, end_a_m: FloatArray, start_b_m: FloatArray, end_b_m: FloatArray
) -> FloatArray:
    """Distances (...) in metres between segments a and b, given by their ends (..., 3); 0 where they cross.

    Follows Ericson, "Real-Time Collision Detection", 2005, section 5.1.9.
    """
    u, v, w = end_a_m - start_a_m, end_b_m - start_b_m, start_a_m - start_b_m
    a, e, b = _dot(u, u), _dot(v, v), _dot(u, v)
    c, f = _dot(u, w), _dot(v, w)
    safe_a, safe_e = np.maximum(a, _TINY), np.maximum(e, _TINY)
    determinant = a * e - b * b
    parallel = determinant < _TINY * safe_a * safe_e
    s = np.where(parallel, 0.0, np.clip((b * f - c * e) / np.where(parallel, 1.0, determinant), 0, 1))
    t = np.clip((b * s + f) / safe_e, 0, 1)
    s = np.clip((b * t - c) / safe_a, 0, 1)
    between = w + s[..., None] * u - t[..., None] * v
    return np.sqrt(_dot(between, between))


def segment_box_distance(start_m: FloatArray, end_m: FloatArray, half_size_m: FloatArray) -> FloatArray:
    """Distances (...) in metres from segments to boxes, in the boxes' own frames; 0 where they touch or
    enter.

    Along the segment the squared distance is convex and piecewise quadratic, so its slope is piecewise
    linear: the smallest distance lies at an end or where the slope passes zero between two kinks.

    Args:
        start_m: (..., 3) one end.
        end_m: (..., 3) the other end.
        half_size_m: (..., 3) half the sides of each box, whose middle is the origin.
    """
    along = end_m - start_m
    moving = np.where(np.abs(along) < _TINY, 1.0, along)
    kinks = np.concatenate([(half_size_m - start_m) / moving, (-half_size_m - start_m) / moving], axis=-1)
    edges = np.zeros((*along.shape[:-1], 1))
    places = np.sort(np.concatenate([edges, np.clip(kinks, 0, 1), edges + 1], axis=-1), axis=-1)
    points = start_m[..., None, :] + places[..., None] * along[..., None, :]
    slopes = np.einsum("...ki,...i->...k", _outside(points, half_size_m[..., None, :]), along)
    nearest = start_m + _zero_of(places, slopes)[..., None] * along
    distance: FloatArray = np.linalg.norm(_outside(nearest, half_size_m), axis=-1)
    return distance


def _outside(points: FloatArray, half_size_m: FloatArray) -> FloatArray:
    """Signed distances of points beyond a box's sides, by axis."""
    return points - np.clip(points, -half_size_m, half_size_m)


def _zero_of(places: FloatArray, slopes: FloatArray) -> FloatArray:
    """Where (...) the rising, piecewise linear slopes (..., K) over places (..., K) pass zero, within 0 and
    1.
    """
    after = np.minimum((slopes < 0).sum(axis=-1, keepdims=True), places.shape[-1] - 1)
    before = np.maximum(after - 1, 0)
    low, high = np.take_along_axis(slopes, before, -1), np.take_along_axis(slopes, after, -1)
    start, end = np.take_along_axis(places, before, -1), np.take_along_axis(places, after, -1)
    rise = high - low
    share = np.clip(-low / np.where(rise < _TINY, 1.0, rise), 0, 1)
    return np.asarray(np.where(low < 0, start + share * (end - start), start))[..., 0]


def _dot(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("...i,...i->...", a, b))


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
        """(3,) center of its axis."""
        return np.array([0.0, 0.0, self.height_m / 2])

    @property
    def reach_m(self) -> float:
        """Radius of the sphere around `middle_m` that encloses it."""
        return float(np.hypot(max(self.low_radius_m, self.high_radius_m), self.height_m / 2))

    def nearest(self, points_m: FloatArray) -> FloatArray:
        """Return its points (..., 3) nearest to points (..., 3) of its frame."""
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
        """Return the distances (...) of points (..., 3) of its frame; 0 inside."""
        return np.asarray(np.sqrt(_squared(points_m - self.nearest(points_m))))

    def support(self, directions: FloatArray) -> FloatArray:
        """Return its support (...) along directions (..., 3) from its frame's origin."""
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
    own axes, or found by projecting a point from one body to the other and back (von Neumann).

    Args:
        cone: the cone.
        T_box_cone: (M, 4, 4) its pose in each box's frame.
        half_size_m: (M, 3) half the sides of each box.
        exact_below_m: larger distances may be given too small, but not below this.
    """
    origin = T_box_cone[:, :3, 3]
    # along the box's own axes: the cone's reach in that direction is its support
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
        """The gap (M,) between box and cone along unit directions (M, 3) from the box to the cone."""
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
    return _dot(vectors, vectors)
