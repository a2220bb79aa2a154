"""How much light from around reaches each vertex of a surface: what gives a hollow its depth."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from core.geometry import AnyArray, FloatArray

_N_AXES = 24
"""Directions come in pairs: what is before and what is behind takes one map of depths."""
_N_SAMPLES = 20_000
_CELLS = 76
"""Each way, in a map of depths of the unit ball."""
_SLACK = 4 / _CELLS
"""Two cells: so far before a vertex its own surface is not in its way."""
_GAIN = 1.15
"""The map is coarse: at its edges a plane takes itself for something in the way."""
_DARKEST = 0.42
_GOLDEN_RAD = np.pi * (3 - 5**0.5)
_R2 = np.array([0.7548776662466927, 0.5698402909980532])
"""Steps of Roberts' sequence, whose points fill a square evenly."""


def ambient_light(vertices_m: AnyArray, faces: AnyArray) -> npt.NDArray[np.float32]:
    """Return the share (V,) of light that reaches each vertex, from 0.42 in a narrow hollow to 1 in the open.

    A vertex of a plane in the open sees half of all directions, which counts as all.
    """
    if not len(faces):
        return np.ones(len(vertices_m), dtype=np.float32)
    samples = surface_points_m(vertices_m, faces, _N_SAMPLES)
    middle = (samples.min(axis=0) + samples.max(axis=0)) / 2
    radius_m = max(float(np.linalg.norm(samples - middle, axis=1).max()), 1e-6) * 1.05
    placed, met = (np.ascontiguousarray((one - middle).T) / radius_m for one in (vertices_m, samples))
    n_seen = np.zeros(len(vertices_m))
    for axis in _axes():
        frame = _frame(axis)
        n_seen += _n_open_ends(frame @ placed, frame @ met)
    share = np.minimum(_GAIN * n_seen / _N_AXES, 1.0)
    smooth = _smoothed(share, np.asarray(faces, dtype=np.intp))
    return (_DARKEST + (1 - _DARKEST) * smooth).astype(np.float32)


def surface_points_m(vertices_m: AnyArray, faces: AnyArray, n: int) -> FloatArray:
    """Return n points (n, 3) on a surface, as dense everywhere."""
    triangles = np.asarray(vertices_m, dtype=np.float64)[np.asarray(faces, dtype=np.intp)]
    a, b, c = (triangles[:, k] for k in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    reached = np.cumsum(areas)
    face = np.searchsorted(reached, (np.arange(n) + 0.5) / n * reached[-1])
    u, v = ((np.arange(1, len(face) + 1)[:, None] * _R2) % 1).T
    is_outside = u + v > 1
    u, v = np.where(is_outside, 1 - u, u), np.where(is_outside, 1 - v, v)
    samples: FloatArray = a[face] + u[:, None] * (b - a)[face] + v[:, None] * (c - a)[face]
    return samples


def _n_open_ends(points: FloatArray, samples: FloatArray) -> npt.NDArray[np.int8]:
    """At how many ends (N,), 0 to 2, a line along z leaves points (3, N) without meeting samples (3, M).

    All are within the unit ball.
    """
    own, cells = (
        ((one[0] + 1) * (_CELLS / 2)).astype(np.intp) * _CELLS + ((one[1] + 1) * (_CELLS / 2)).astype(np.intp)
        for one in (points, samples)
    )
    top, bottom = np.full(_CELLS * _CELLS, -np.inf), np.full(_CELLS * _CELLS, np.inf)
    np.maximum.at(top, cells, samples[2])
    np.minimum.at(bottom, cells, samples[2])
    n_open: npt.NDArray[np.int8] = (points[2] >= top[own] - _SLACK).astype(np.int8)
    n_open += points[2] <= bottom[own] + _SLACK
    return n_open


def _axes() -> FloatArray:
    """Unit vectors (_N_AXES, 3), evenly over half a sphere."""
    k = np.arange(_N_AXES)
    z = (k + 0.5) / _N_AXES
    radius, angle = np.sqrt(1 - z * z), k * _GOLDEN_RAD
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z])


def _frame(axis: FloatArray) -> FloatArray:
    """Rows (3, 3): two unit vectors across an axis, and the axis."""
    across = np.cross(axis, np.eye(3)[int(np.abs(axis).argmin())])
    across /= np.linalg.norm(across)
    return np.array([across, np.cross(axis, across), axis])


def _smoothed(share: FloatArray, faces: npt.NDArray[np.intp]) -> FloatArray:
    """The mean (V,) over the faces around each vertex."""
    of_face = share[faces].mean(axis=1)
    total, n = (
        sum(np.bincount(faces[:, k], weights, minlength=len(share)) for k in range(3))
        for weights in (of_face, np.ones(len(faces)))
    )
    smooth: FloatArray = np.where(n > 0, total / np.maximum(n, 1), share)
    return smooth
