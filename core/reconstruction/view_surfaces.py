"""What the views show of the object: oriented points of each, and the planes they are compared with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray, IntArray, transform_points
from core.reconstruction.depth_planes import STRIDE, PlaneImage
from core.scan.model import CropBox, Intrinsics, RgbdFrame, Scan

POINTS_PER_VIEW = 900
SMALLEST_FACING = 0.35
"""Cosine between a point's normal and its ray: surfaces seen flatter say little and are noisy."""


@dataclass(frozen=True)
class ViewSurfaces:
    """All views' surfaces of the object, each in its camera's frame.

    Attributes:
        planes: (V, h, w, 3), see `fit_planes`.
        points_m: (N, 3), points on planes, of all views.
        normals: (N, 3), unit, towards the camera.
        view: (N,), which view a point is of.
        camera: (4,), fx, fy, cx, cy in pixels.
    """

    planes: PlaneImage
    points_m: FloatArray
    normals: FloatArray
    view: IntArray
    camera: FloatArray


def view_surfaces(scan: Scan, planes: Sequence[PlaneImage], block: CropBox) -> ViewSurfaces:
    """Choose points of every view in a block (base frame) around the object."""
    chosen = [
        _points(plane, frame, scan.intrinsics, block)
        for plane, frame in zip(planes, scan.frames, strict=True)
    ]
    points, normals = (np.concatenate(parts) for parts in zip(*chosen, strict=True))
    view = np.repeat(np.arange(len(chosen)), [len(of_view) for of_view, _ in chosen])
    camera = scan.intrinsics
    return ViewSurfaces(
        np.stack(planes), points, normals, view, np.array([camera.fx, camera.fy, camera.cx, camera.cy])
    )


def _points(
    planes: PlaneImage, frame: RgbdFrame, camera: Intrinsics, block: CropBox
) -> tuple[FloatArray, FloatArray]:
    """Return points and normals (N, 3) of one view, evenly thinned out, in the camera's frame."""
    rows, columns = np.nonzero(np.isfinite(planes[..., 0]))
    plane = planes[rows, columns].astype(float)
    x = (columns * STRIDE - camera.cx) / camera.fx
    y = (rows * STRIDE - camera.cy) / camera.fy
    rays = np.column_stack([x, y, np.ones_like(x)])
    inverse_depth = np.einsum("ij,ij->i", plane, rays)
    steepness = np.linalg.norm(plane, axis=1)
    facing = inverse_depth / (steepness * np.linalg.norm(rays, axis=1))
    with np.errstate(divide="ignore", invalid="ignore"):
        points = rays / inverse_depth[:, None]
    in_base = transform_points(frame.T_base_camera, points)
    used = ((in_base > block.min_m) & (in_base < block.max_m)).all(axis=1) & (facing > SMALLEST_FACING)
    index = np.nonzero(used)[0]
    index = index[:: max(1, len(index) // POINTS_PER_VIEW)]
    return points[index], -plane[index] / steepness[index, None]
