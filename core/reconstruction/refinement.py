"""Correcting the views' poses: the surfaces they show of the object, and the table, are made to agree.

What the views cannot show (the rotation of a round object about its axis, where the whole scene lies) stays
with the poses as recorded: each correction is held by the pose error that the table shows. Figures in
docs/decisions/0005-pose-refinement.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np
from scipy.spatial.transform import Rotation

from core.geometry import FloatArray, transform_points
from core.progress import Reporter
from core.reconstruction.pose_health import Plane
from core.reconstruction.registration import PairSums, ViewSurfaces, compare_views
from core.reconstruction.result import Refinement, ViewCorrection
from core.scan.model import CropBox, Scan

MOST_ROUNDS = 30
SETTLED = 2e-5
"""Radians and metres of a round's largest step."""
LEAST_REACH_M = 0.004
REACH_PER_POSE_ERROR = 6.0
FARTHEST_REACH_M = 0.025
REACH_SHRINKS = 0.8
UNKNOWN_POSE_SD_M = 0.001
"""When no table shows it: what a well calibrated arm achieves."""
SURFACE_SD_M = 0.0007
"""Of a fitted plane, from depth noise and its window."""
INDEPENDENT_POINTS = 150.0
"""All matches of one view together weigh as much as this many: their noise is shared."""
TABLE_SD_M = 0.0015
"""Of each of nine points of a view's table: a real camera bends a plane by more than its noise."""
TABLE_ARM_M = 0.15
FEWEST_TABLES = 3
STRAY_M = 0.01
"""A table this far off the others is left out of the common one."""
ROTATION_PER_POSE_ERROR = 3.0
"""Radians about each axis for a metre of the table's height: 1 mm and 0.25 degrees go together."""
LEAST_POSE_SD_M = 0.0002


def refine_poses(
    scan: Scan,
    surfaces: ViewSurfaces,
    tables: Sequence[Plane | None],
    table_sd_m: float | None,
    block: CropBox,
    reporter: Reporter,
) -> Refinement:
    """Move all poses together until the views agree; poses that agree no better stay as they were.

    Args:
        scan: the views with their recorded poses.
        surfaces: what they show of the object.
        tables: the table in each view, none where it is not seen.
        table_sd_m: scatter of its height over the views, the measure of the pose error.
        block: where the object lies, in the base frame.
        reporter: asked whether to stop.

    Raises:
        Cancelled: the user asked to stop.
    """
    recorded = np.array([frame.T_base_camera for frame in scan.frames])
    pose_sd_m = UNKNOWN_POSE_SD_M if table_sd_m is None else table_sd_m
    center_m = (np.array(block.min_m) + np.array(block.max_m)) / 2
    anchors = make_anchors(recorded, tables, pose_sd_m, center_m)
    reach_m = min(FARTHEST_REACH_M, LEAST_REACH_M + REACH_PER_POSE_ERROR * pose_sd_m)
    before = compare_views(surfaces, recorded, center_m, reach_m)
    poses = _agree(surfaces, anchors, reach_m, reporter)
    after = compare_views(surfaces, poses, center_m, reach_m)
    if not _is_better(before, after):
        poses, after = recorded, before
    views = _corrections(scan, recorded, poses, before, after)
    nearest_m = compare_views(surfaces, poses, center_m, LEAST_REACH_M).residual_m
    return Refinement(
        views,
        before.residual_m,
        after.residual_m,
        anchors.table_sd_m(recorded),
        anchors.table_sd_m(poses),
        None if nearest_m is None else nearest_m / sqrt(2),  # two views err in a distance between them
    )


def _agree(surfaces: ViewSurfaces, anchors: Anchors, reach_m: float, reporter: Reporter) -> FloatArray:
    """Return the poses (V, 4, 4) at the least squares (Gauss-Newton); the reach shrinks in every round."""
    poses = anchors.poses
    for _ in range(MOST_ROUNDS):
        reporter.raise_if_cancelled()
        sums = compare_views(surfaces, poses, anchors.center_m, reach_m)
        weight = INDEPENDENT_POINTS / max(float(sums.n_matches.mean()), 1.0) / SURFACE_SD_M**2
        matrix, vector = weight * sums.matrix, weight * sums.vector
        anchors.add_to(matrix, vector, poses)
        steps: FloatArray = np.linalg.solve(matrix, vector).astype(float).reshape(-1, 6)
        poses = _moved(poses, steps, anchors.center_m)
        if reach_m == LEAST_REACH_M and np.abs(steps).max() < SETTLED:
            break
        reach_m = max(LEAST_REACH_M, REACH_SHRINKS * reach_m)
    return poses


def _moved(poses: FloatArray, steps: FloatArray, center_m: FloatArray) -> FloatArray:
    """Rotate and shift poses (V, 4, 4) by steps (V, 6) about the centre."""
    rotations = Rotation.from_rotvec(steps[:, :3]).as_matrix()
    moved = poses.copy()
    moved[:, :3, :3] = rotations @ poses[:, :3, :3]
    moved[:, :3, 3] = np.einsum("vij,vj->vi", rotations, poses[:, :3, 3] - center_m) + center_m + steps[:, 3:]
    return moved


def _is_better(before: PairSums, after: PairSums) -> bool:
    if before.residual_m is None or after.residual_m is None:
        return before.residual_m is None
    return after.residual_m < before.residual_m


def _corrections(
    scan: Scan, recorded: FloatArray, poses: FloatArray, before: PairSums, after: PairSums
) -> tuple[ViewCorrection, ...]:
    shifts_m = np.linalg.norm(poses[:, :3, 3] - recorded[:, :3, 3], axis=1)
    rotations = Rotation.from_matrix(poses[:, :3, :3] @ recorded[:, :3, :3].transpose(0, 2, 1))
    turns_rad = rotations.as_rotvec()
    return tuple(
        ViewCorrection(
            frame.name,
            float(shifts_m[view]),
            float(np.linalg.norm(turns_rad[view])),
            before.residuals_m[view],
            after.residuals_m[view],
            poses[view],
        )
        for view, frame in enumerate(scan.frames)
    )


@dataclass(frozen=True)
class Anchors:
    """The recorded poses, and the points of the table that each view should see on one plane.

    Attributes:
        poses: (V, 4, 4), as recorded, camera to base.
        pose_sd_m: standard deviation of a recorded position along each axis.
        center_m: (3,) in the base frame, about which the steps rotate.
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
        """Slopes (6, 6) and errors (6,) of the camera's rotation and shift, in their standard deviations."""
        x, y, z = pose[:3, 3] - self.center_m
        slopes = np.eye(6)
        slopes[3:, :3] = [[0, z, -y], [-z, 0, x], [y, -x, 0]]  # a rotation about the centre moves the camera
        rotation = Rotation.from_matrix(pose[:3, :3] @ recorded[:3, :3].T).as_rotvec()
        errors = np.concatenate([rotation, pose[:3, 3] - recorded[:3, 3]])
        sds = np.repeat([ROTATION_PER_POSE_ERROR * self.pose_sd_m, self.pose_sd_m], 3)
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
