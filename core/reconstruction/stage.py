"""The stage from a scan to the object's mesh (Sec. IV-A)."""

from __future__ import annotations

import numpy as np

from core.errors import StageError
from core.mesh import TriangleMesh
from core.parameters.reconstruction import ReconstructionParameters
from core.progress import Reporter
from core.reconstruction.planes import Plane
from core.reconstruction.platform import estimate_platform_height_m
from core.reconstruction.pose_health import PoseHealth, measure_pose_health
from core.reconstruction.result import Reconstruction
from core.reconstruction.segmentation import Part, find_object, find_table, touched_sides
from core.reconstruction.surface import extract_surface, largest_piece
from core.reconstruction.truncation import choose_truncation_m
from core.reconstruction.tsdf import TsdfVolume
from core.reconstruction.unseen import cut_at_height, cut_at_table, fill_unseen
from core.scan.model import Scan

STAGE = "reconstruction"
STRAY_VIEW_M = 0.01


def reconstruct(scan: Scan, parameters: ReconstructionParameters, reporter: Reporter) -> Reconstruction:
    """Fuse all views, cut the object out and close its surface.

    Raises:
        StageError: the crop box holds no object, or too many voxels.
        Cancelled: the user asked to stop.
    """
    health = measure_pose_health(scan.frames, scan.intrinsics, parameters)
    _warn_of_stray_views(health, reporter)
    volume = _fuse(scan, parameters, *choose_truncation_m(parameters, health), reporter)
    table = find_table(scan, parameters) if parameters.segmentation == "plane" else None
    part = find_object(volume, scan, parameters, table)
    support_m = _support_height_m(volume, part, scan, parameters, table, reporter)
    _warn_if_cut_off(volume, part, parameters, support_m, reporter)
    mesh = _object_mesh(volume, part, parameters, table, support_m)
    return Reconstruction(mesh, support_m, volume.truncation_m, health)


def _fuse(
    scan: Scan,
    parameters: ReconstructionParameters,
    truncation_m: float,
    behind_m: float,
    reporter: Reporter,
) -> TsdfVolume:
    volume = TsdfVolume(
        parameters.crop_min_m, parameters.crop_max_m, parameters.voxel_m, truncation_m, behind_m
    )
    for done, frame in enumerate(scan.frames, start=1):
        reporter.raise_if_cancelled()
        volume.integrate(frame, scan.intrinsics, parameters.max_depth_m)
        reporter.progress(STAGE, done, len(scan.frames))
    return volume


def _support_height_m(
    volume: TsdfVolume,
    part: Part,
    scan: Scan,
    parameters: ReconstructionParameters,
    table: Plane | None,
    reporter: Reporter,
) -> float:
    if table is not None:
        middle = volume.centers_m((part.seen.min(axis=0) + part.seen.max(axis=0)) // 2)
        return float(table.height_m(middle[0], middle[1]))
    for known in (parameters.platform_height_m, scan.platform_height_m):
        if known is not None:
            return known
    estimate_m = estimate_platform_height_m(volume, part, scan, parameters)
    if parameters.unseen == "solid":
        reporter.warn(
            f"The platform's height is not known; {estimate_m * 1000:.0f} mm is taken, where the object's "
            "lowest points are; measure it and set reconstruction.platform_height_m."
        )
    return estimate_m


def _object_mesh(
    volume: TsdfVolume,
    part: Part,
    parameters: ReconstructionParameters,
    table: Plane | None,
    support_m: float,
) -> TriangleMesh:
    solid = parameters.unseen == "solid"
    if solid or table is not None:
        part = part.down_to(int((support_m - volume.origin_m[2]) / volume.voxel_m) - 1)
    distance = fill_unseen(volume, part) if solid else volume.distance[part.slices]
    if table is not None:
        distance = cut_at_table(distance, volume, part, table, parameters.plane_margin_m)
    elif solid:
        distance = cut_at_height(distance, volume, part, support_m)
    mesh = extract_surface(distance, volume.centers_m(part.low), volume.voxel_m)
    if len(mesh.faces) == 0:
        raise StageError(
            f"Nothing of the object lies above the platform at {support_m * 1000:.0f} mm; "
            f"its surface ends at {volume.centers_m(part.seen.max(axis=0))[2] * 1000:.0f} mm, so correct "
            "reconstruction.platform_height_m."
        )
    # The released code keeps the specks beside the object, which lie within the cluster's gap.
    return largest_piece(mesh) if solid or table is not None else mesh


def _warn_if_cut_off(
    volume: TsdfVolume, part: Part, parameters: ReconstructionParameters, support_m: float, reporter: Reporter
) -> None:
    # A box that begins just above its platform is how the object is told from the table: no warning for that.
    is_below_box = support_m < volume.origin_m[2] - volume.voxel_m
    sides = touched_sides(part, volume, with_bottom=is_below_box and parameters.segmentation == "box")
    if sides:
        reporter.warn(
            f"The object touches the crop box at {', '.join(sides)}: part of it may be cut off; "
            "enlarge crop_min_m and crop_max_m of the reconstruction."
        )


def _warn_of_stray_views(health: PoseHealth, reporter: Reporter) -> None:
    heights = {view.name: view.height_m for view in health.views if view.height_m is not None}
    if not heights:
        return
    middle = float(np.median(list(heights.values())))
    stray = {name: height - middle for name, height in heights.items() if abs(height - middle) > STRAY_VIEW_M}
    if stray:
        worst = max(stray, key=lambda name: abs(stray[name]))
        reporter.warn(
            f"{len(stray)} of {len(health.views)} views see the table more than "
            f"{STRAY_VIEW_M * 1000:.0f} mm off the others, worst {worst} "
            f"by {stray[worst] * 1000:.0f} mm; check their poses."
        )
