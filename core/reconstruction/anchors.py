"""What holds the poses while the views are made to agree: the table, and the poses as they were recorded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from core.geometry import FloatArray, transform_points
from core.reconstruction.planes import Plane

TABLE_SD_M = 0.0015
"""Of each of nine points of a view's table: a real camera bends a plane by more than its noise."""
TABLE_ARM_M = 0.15
FEWEST_TABLES = 3
STRAY_M = 0.01
"""A table this far off the others does not tell where the common one is."""
TURN_PER_POSE_ERROR = 3.0
"""Radians about each axis for a metre of the table's height: 1 mm and 0.25 degrees go together."""
LEAST_POSE_SD_M = 0.0002


@dataclass(frozen=True)
class Anchors:
    """The recorded poses, and the points of the table that each view should see on one plane.

    Attributes:
        poses: (V, 4, 4), as recorded, camera to base.
        pose_sd_m: standard deviation of a recorded position along each axis.
        center_m: (3,) in the base frame, about which the steps turn.
        tables_m: points (9, 3) of the table in each camera's frame; none where it is not seen.
        normal: (3,) of the common table, up.
        height_m: of the common table over the centre.
    """

    poses: FloatArray
    pose_sd_m: float
    center_m: FloatArray
    tables_m: tuple[FloatArray | None, ...]
    normal: FloatArray
    height_m: float

    def add_to(self, matrix: FloatArray, vector: FloatArray, poses: FloatArray) -> None:
        """Add their normal equations at the present poses to (6 V, 6 V) and (6 V,), in place."""
        for view, (pose, table_m) in enumerate(zip(poses, self.tables_m, strict=True)):
            own = slice(6 * view, 6 * view + 6)
            slopes, errors = self._from_recorded(pose, self.poses[view])
            if table_m is not None:
                more_slopes, more_errors = self._from_table(transform_points(pose, table_m))
                slopes, errors = np.vstack([slopes, more_slopes]), np.append(errors, more_errors)
            matrix[own, own] += slopes.T @ slopes
            vector[own] -= slopes.T @ errors

    def table_sd_m(self, poses: FloatArray) -> float | None:
        """Return the standard deviation of the table's height over the views."""
        heights = [
            transform_points(pose, table_m)[:, 2].mean()
            for pose, table_m in zip(poses, self.tables_m, strict=True)
            if table_m is not None
        ]
        return float(np.std(heights, ddof=1)) if len(heights) >= FEWEST_TABLES else None

    def _from_recorded(self, pose: FloatArray, recorded: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Slopes (6, 6) and errors (6,) of the camera's turn and shift, in their standard deviations."""
        x, y, z = pose[:3, 3] - self.center_m
        slopes = np.eye(6)
        slopes[3:, :3] = [[0, z, -y], [-z, 0, x], [y, -x, 0]]  # a turn about the centre moves the camera
        turn = Rotation.from_matrix(pose[:3, :3] @ recorded[:3, :3].T).as_rotvec()
        errors = np.concatenate([turn, pose[:3, 3] - recorded[:3, 3]])
        sds = np.repeat([TURN_PER_POSE_ERROR * self.pose_sd_m, self.pose_sd_m], 3)
        return slopes / sds[:, None], errors / sds

    def _from_table(self, points_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Slopes (9, 6) and errors (9,) of the table's points (9, 3) against the common table."""
        arms = points_m - self.center_m
        slopes = np.column_stack([np.cross(arms, self.normal), np.tile(self.normal, (len(arms), 1))])
        errors = arms @ self.normal - (self.height_m - self.center_m[2]) * self.normal[2]
        return slopes / TABLE_SD_M, errors / TABLE_SD_M


def make_anchors(
    poses: FloatArray, tables: Sequence[Plane | None], pose_sd_m: float, center_m: FloatArray
) -> Anchors:
    """Take the mean of the views' tables, without the stray ones, as the common one: the scene stays."""
    steps = TABLE_ARM_M * np.array([-1.0, 0.0, 1.0])
    x, y = (axis.ravel() for axis in np.meshgrid(center_m[0] + steps, center_m[1] + steps))
    normal, height_m = _common_table(tables, center_m)
    points = tuple(
        (np.column_stack([x, y, table.height_m(x, y)]) - pose[:3, 3]) @ pose[:3, :3]
        if height_m is not None and table is not None
        else None
        for pose, table in zip(poses, tables, strict=True)
    )
    return Anchors(poses, max(pose_sd_m, LEAST_POSE_SD_M), center_m, points, normal, height_m or 0.0)


def _common_table(tables: Sequence[Plane | None], center_m: FloatArray) -> tuple[FloatArray, float | None]:
    """Return the normal (3,) and the height over the centre; no height when too few views see the table."""
    seen = [table for table in tables if table is not None]
    if len(seen) < FEWEST_TABLES:
        return np.array([0.0, 0.0, 1.0]), None
    heights_m = np.array([float(table.height_m(*center_m[:2])) for table in seen])
    is_near = np.abs(heights_m - np.median(heights_m)) < STRAY_M
    normal = np.array([table.normal for table in seen])[is_near].mean(axis=0)
    return normal / np.linalg.norm(normal), float(heights_m[is_near].mean())
