"""Correcting the views' poses: the surfaces they show of the object, and the table, are made to agree.

What the views cannot tell (the turn of a round object about its axis, where the whole scene lies) stays with
the poses as recorded: each correction is held by the pose error that the table tells. Figures in
docs/decisions/0005-pose-refinement.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

import numpy as np
from scipy.spatial.transform import Rotation

from core.geometry import FloatArray
from core.progress import Reporter
from core.reconstruction.anchors import Anchors, make_anchors
from core.reconstruction.corrections import Refinement, ViewCorrection
from core.reconstruction.planes import Plane
from core.reconstruction.registration import PairSums, compare_views
from core.reconstruction.view_surfaces import ViewSurfaces
from core.scan.model import CropBox, Scan

MOST_ROUNDS = 30
SETTLED = 2e-5
"""Radians and metres of a round's largest step."""
LEAST_REACH_M = 0.004
REACH_PER_POSE_ERROR = 6.0
FARTHEST_REACH_M = 0.025
REACH_SHRINKS = 0.8
UNKNOWN_POSE_SD_M = 0.001
"""When no table tells it: what a well calibrated arm reaches."""
SURFACE_SD_M = 0.0007
"""Of a fitted plane, from depth noise and its window."""
INDEPENDENT_POINTS = 150.0
"""As much as all matches of one view say together: their noise is shared."""


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
    """Turn and shift poses (V, 4, 4) by steps (V, 6) about the centre."""
    turns = Rotation.from_rotvec(steps[:, :3]).as_matrix()
    moved = poses.copy()
    moved[:, :3, :3] = turns @ poses[:, :3, :3]
    moved[:, :3, 3] = np.einsum("vij,vj->vi", turns, poses[:, :3, 3] - center_m) + center_m + steps[:, 3:]
    return moved


def _is_better(before: PairSums, after: PairSums) -> bool:
    if before.residual_m is None or after.residual_m is None:
        return before.residual_m is None
    return after.residual_m < before.residual_m


def _corrections(
    scan: Scan, recorded: FloatArray, poses: FloatArray, before: PairSums, after: PairSums
) -> tuple[ViewCorrection, ...]:
    shifts_m = np.linalg.norm(poses[:, :3, 3] - recorded[:, :3, 3], axis=1)
    turns = Rotation.from_matrix(poses[:, :3, :3] @ recorded[:, :3, :3].transpose(0, 2, 1))
    turns_rad = turns.as_rotvec()
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
