"""The camera as the calibration takes it: a pinhole, after its lens's distortion is removed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from core.geometry import FloatArray
from core.scan.model import ColorImage, Intrinsics


@dataclass(frozen=True)
class Lens:
    """Intrinsics and distortion, the latter as OpenCV and the cameras' drivers give it.

    Attributes:
        intrinsics: of the pinhole.
        distortion: k1, k2, p1, p2, k3 (Brown and Conrady).
    """

    intrinsics: Intrinsics
    distortion: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)

    def undistorted(self, points_px: FloatArray) -> FloatArray:
        """Take image points (N, 2) to where a pinhole would see them."""
        return self._unprojected(points_px) @ np.diag([self.intrinsics.fx, self.intrinsics.fy]) + self._middle

    def rays(self, points_px: FloatArray) -> FloatArray:
        """Directions (N, 3) in the camera frame, with z = 1, of image points (N, 2)."""
        flat = self._unprojected(points_px)
        return np.column_stack([flat, np.ones(len(flat))])

    def distorted(self, points_m: FloatArray) -> FloatArray:
        """Project points (N, 3) in the camera frame to the image (N, 2) as the lens shows it."""
        import cv2

        flat = np.ascontiguousarray(points_m, dtype=float).reshape(-1, 1, 3)
        image, _ = cv2.projectPoints(
            flat, np.zeros(3), np.zeros(3), self.intrinsics.matrix, np.array(self.distortion)
        )
        return np.asarray(image.reshape(-1, 2), dtype=float)

    def as_pinhole(self, color: ColorImage) -> ColorImage:
        """Return the image (H, W, 3) that a pinhole would show, of one that the lens shows."""
        if not any(self.distortion):
            return color
        import cv2

        return np.asarray(cv2.undistort(color, self.intrinsics.matrix, np.array(self.distortion)))

    @cached_property
    def _middle(self) -> FloatArray:
        return np.array([self.intrinsics.cx, self.intrinsics.cy])

    def _unprojected(self, points_px: FloatArray) -> FloatArray:
        """Points (N, 2) at the distance 1 before the pinhole."""
        if not any(self.distortion):
            return np.asarray((points_px - self._middle) / [self.intrinsics.fx, self.intrinsics.fy])
        import cv2

        points = np.ascontiguousarray(points_px, dtype=float).reshape(-1, 1, 2)
        flat = cv2.undistortPointsIter(
            points, self.intrinsics.matrix, np.array(self.distortion), np.eye(3), np.eye(3), (3, 50, 1e-12)
        )
        return np.asarray(flat.reshape(-1, 2), dtype=float)


def project(intrinsics: Intrinsics, points_m: FloatArray) -> FloatArray:
    """Project points (..., 3) in the camera frame to the image (..., 2), as a pinhole."""
    u = intrinsics.fx * points_m[..., 0] / points_m[..., 2] + intrinsics.cx
    v = intrinsics.fy * points_m[..., 1] / points_m[..., 2] + intrinsics.cy
    return np.stack([u, v], axis=-1)
