"""The object's photographed colours: each vertex gets what the views that see it agree on.

A view counts by how squarely it looks at the place, if nothing of the object is between and the depth it
measured there is the surface's; where it measured none, as beside an edge, it may see what is behind.
Exposure differs from view to view: each gets a gain for each channel, so that places seen by several look
alike in all. Colours follow from the finished surface, and change nothing of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from core.files import read_arrays, write_arrays
from core.geometry import AnyArray, BoolArray, FloatArray, invert_pose, transform_points
from core.mesh import TriangleMesh
from core.scan.model import Intrinsics, RgbdFrame, Scan

COLORS_FILE = "colors.npz"
_LEAST_COSINE = 0.2
"""Of the line of sight against the normal; at less a pixel is smeared over the surface."""
_CELL_PX = 3
"""Of the map that tells which parts of the object are in front."""
_BEHIND_M = 0.006
"""Farther behind the nearest part a vertex is hidden."""
_DEPTH_ERROR = 0.015
"""Share of the distance by which the measured depth may differ from the surface's."""
_ROUNDS = 4
_OUTLIER = 0.12
"""So far off the other views' colour, of 1, a view counts 1/e: glare, and poses that err."""
_MOST_GAIN = 1.6
_GREY = 0.7
_FILL_ROUNDS = 60


@dataclass(frozen=True, eq=False)
class ModelColors:
    """The photographed colours of the reconstructed surface.

    Attributes:
        rgb: (V, 3) uint8, sRGB, of each vertex.
    """

    rgb: npt.NDArray[np.uint8]

    def save(self, folder: Path) -> None:
        """Write `colors.npz` into an existing folder."""
        write_arrays(folder / COLORS_FILE, rgb=self.rgb)

    @staticmethod
    def load(folder: Path) -> ModelColors:
        """Read what `save` wrote.

        Raises:
            SessionError: the file is missing or damaged.
        """
        return ModelColors(read_arrays(folder / COLORS_FILE)["rgb"])


def photographed(mesh: TriangleMesh, scan: Scan) -> ModelColors:
    """Colour a surface from the views of a scan, whose poses are those it was reconstructed with."""
    normals = mesh.vertex_normals
    seen = [_seen_by(frame, scan.intrinsics, mesh, normals) for frame in scan.frames]
    n = len(mesh.vertices_m)
    weights = np.array([weight for weight, _ in seen]).reshape(-1, n)
    colors = np.array([color for _, color in seen]).reshape(-1, n, 3)
    fused = _agreed(colors, weights)
    filled = _filled(fused, weights.sum(axis=0) > 0, mesh.faces)
    return ModelColors(np.rint(255 * np.clip(filled, 0, 1)).astype(np.uint8))


def _seen_by(
    frame: RgbdFrame, intrinsics: Intrinsics, mesh: TriangleMesh, normals: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """How much a view tells of each vertex (V,), and the colour (V, 3), 0 to 1, it has there."""
    points = transform_points(invert_pose(frame.T_base_camera), mesh.vertices_m)
    z = np.maximum(points[:, 2], 1e-6)
    u = intrinsics.fx * points[:, 0] / z + intrinsics.cx
    v = intrinsics.fy * points[:, 1] / z + intrinsics.cy
    height, width = frame.color.shape[:2]
    is_inside = (points[:, 2] > 0.05) & (u >= 1) & (u < width - 2) & (v >= 1) & (v < height - 2)
    u, v = np.where(is_inside, u, 1.0), np.where(is_inside, v, 1.0)
    to_eye = frame.T_base_camera[:3, 3] - mesh.vertices_m
    cosine = np.einsum("ij,ij->i", normals, to_eye) / np.linalg.norm(to_eye, axis=1)
    is_seen = is_inside & (cosine > _LEAST_COSINE) & _is_in_front(u, v, z, is_inside)
    measured = frame.depth_m[np.rint(v).astype(np.intp), np.rint(u).astype(np.intp)]
    is_seen &= np.abs(measured - z) < _DEPTH_ERROR * z
    return np.where(is_seen, cosine**2 / z**2, 0.0), _bilinear(frame.color, u, v)


def _is_in_front(u: FloatArray, v: FloatArray, z: FloatArray, is_inside: BoolArray) -> BoolArray:
    """Which vertices (V,) no other part of the object hides: the surface's own vertices are dense."""
    columns, rows = (u / _CELL_PX).astype(np.intp), (v / _CELL_PX).astype(np.intp)
    nearest = np.full((int(rows.max()) + 3, int(columns.max()) + 3), np.inf)
    np.minimum.at(nearest, (rows[is_inside] + 1, columns[is_inside] + 1), z[is_inside])
    in_front: BoolArray = z <= nearest[rows + 1, columns + 1] + _BEHIND_M
    return in_front


def _bilinear(image: npt.NDArray[np.uint8], u: FloatArray, v: FloatArray) -> FloatArray:
    """Colours (N, 3), 0 to 1, of an image (H, W, 3) between its pixels."""
    column, row = np.floor(u).astype(np.intp), np.floor(v).astype(np.intp)
    right, down = (u - column)[:, None], (v - row)[:, None]
    top = (1 - right) * image[row, column] + right * image[row, column + 1]
    bottom = (1 - right) * image[row + 1, column] + right * image[row + 1, column + 1]
    mixed: FloatArray = ((1 - down) * top + down * bottom) / 255
    return mixed


def _agreed(colors: FloatArray, weights: FloatArray) -> FloatArray:
    """The colours (V, 3) that views (K, V, 3) with weights (K, V) agree on, with a gain for each view."""
    gains = np.ones((len(colors), 1, 3))
    trust = weights
    mean = _mean(colors, trust)
    for _ in range(_ROUNDS):
        shared = np.where((weights > 0).sum(axis=0) > 1, trust, 0.0)
        told = np.einsum("kv,kvc,kvc->kc", shared, colors, colors)
        wanted = np.einsum("kv,kvc,vc->kc", shared, colors, mean)
        gains = np.where(told > 0, wanted / np.maximum(told, 1e-12), 1.0)[:, None, :]
        gains = np.clip(
            gains / np.exp(np.log(np.maximum(gains, 1e-6)).mean(axis=0)), 1 / _MOST_GAIN, _MOST_GAIN
        )
        off = np.abs(gains * colors - mean).max(axis=2)
        trust = weights * np.exp(-((off / _OUTLIER) ** 2))
        mean = _mean(gains * colors, np.maximum(trust, 1e-6 * weights))
    return mean


def _mean(colors: FloatArray, weights: FloatArray) -> FloatArray:
    mean: FloatArray = (
        np.einsum("kv,kvc->vc", weights, colors) / np.maximum(weights.sum(axis=0), 1e-12)[:, None]
    )
    return mean


def _filled(colors: FloatArray, is_known: BoolArray, faces: AnyArray) -> FloatArray:
    """The colours (V, 3), those that no view saw taken from their neighbours, step by step."""
    filled = np.where(is_known[:, None], colors, 0.0)
    known = is_known.astype(float)
    pairs = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    starts, ends = np.vstack([pairs, pairs[:, ::-1]]).T
    for _ in range(_FILL_ROUNDS):
        is_open = known == 0
        if not is_open.any():
            break
        is_edge = is_open[starts] & (known[ends] > 0)
        if not is_edge.any():
            break
        n = np.bincount(starts[is_edge], minlength=len(filled))
        for channel in range(3):
            total = np.bincount(starts[is_edge], filled[ends[is_edge], channel], minlength=len(filled))
            filled[n > 0, channel] = total[n > 0] / n[n > 0]
        known[n > 0] = 1
    lonely = known == 0
    filled[lonely] = filled[~lonely].mean(axis=0) if (~lonely).any() else _GREY
    return filled
