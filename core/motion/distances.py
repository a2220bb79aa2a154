"""Distances between segments, and between segments and boxes, many at once and without iteration."""

from __future__ import annotations

import numpy as np

from core.geometry import FloatArray

_TINY = 1e-12


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
    """How far points are beyond a box's sides, with sign, by axis."""
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
