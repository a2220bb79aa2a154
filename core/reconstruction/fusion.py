"""The views fused around the object (Sec. IV-A): found coarsely, their poses corrected, fused again finely.

A view that sees the inside of a wall also says "solid" behind it. Where that reaches through a thin wall it
contradicts the views from outside, so near a surface its own views must outweigh it: a view's weight falls
with the distance from the surface it saw. All lengths grow with the pose error, or the two sides of a wall
would erase each other. Figures in docs/decisions/0003-truncation.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.parameters.reconstruction import ReconstructionParameters
from core.progress import Reporter
from core.reconstruction.pose_health import Plane, PoseHealth, find_tables, pose_health_of
from core.reconstruction.refinement import refine_poses
from core.reconstruction.registration import (
    PixelWindow,
    PlaneImage,
    facing_image,
    fit_planes,
    view_surfaces,
)
from core.reconstruction.result import Refinement
from core.reconstruction.segmentation import (
    Part,
    estimate_platform_height_m,
    find_object,
    find_table,
    touched_sides,
    whole,
)
from core.reconstruction.tsdf import TsdfVolume
from core.scan.model import CropBox, RgbdFrame, Scan, crop_box, crop_box_of
from core.threads import in_threads

STAGE = "reconstruction"
COARSE_VOXEL_M = 0.004
"""Edge of the voxels in which the object is looked for."""
SMALL_M3 = 0.005
"""Box of an object that is fused in finer voxels: 1.5 million of 1.5 mm."""
STRAY_VIEW_M = 0.01
VOXELS_IN_FRONT = 4.0
FRONT_PER_VIEW_ERROR = 3.0
LARGEST_M = 0.03
FALLOFF_VOXELS = 0.8
FALLOFF_PER_VIEW_ERROR = 2.0
BEHIND_PER_FALLOFF = 2.5
"""There the weight has fallen to 0.002."""
VOXELS_WITHOUT_TABLE = 5.0
"""The released code's, when the pose error is unknown."""
AROUND_OBJECT_M = 0.03
"""Corrected poses move the object by millimetres."""
SURFACE_PER_TABLE_ERROR = 1.8
"""A surface of the object errs more than the table's height: a rotation of the camera shifts it sideways."""


@dataclass(frozen=True)
class FusedObject:
    """The views, fused around the object.

    Attributes:
        volume: of all views, their poses corrected.
        part: the object's, of the volume.
        table: below it; with plane segmentation only.
        support_m: height of the support in the base frame, under the object.
        health: the table in every view, with the poses as recorded.
        refinement: how the poses were corrected; none if they were taken as recorded.
    """

    volume: TsdfVolume
    part: Part
    table: Plane | None
    support_m: float
    health: PoseHealth
    refinement: Refinement | None

    def down_to_support(self) -> Part:
        """Return its part and three layers more, in which a low floor may seem to lie."""
        return _down_to_support(self.volume, self.part, self.support_m)


def fuse_object(scan: Scan, parameters: ReconstructionParameters, reporter: Reporter) -> FusedObject:
    """Fuse all views around the object.

    It is found in coarse voxels of the whole crop box, the poses are corrected, and the object's block is
    fused again in fine voxels; with a set truncation one volume is both, as in the released code.

    Raises:
        StageError: the crop box holds no object, or too many voxels.
        Cancelled: the user asked to stop.
    """
    tables = find_tables(scan, parameters)
    health = pose_health_of(scan, tables, crop_box_of(scan, parameters))
    _warn_of_stray_views(health, reporter)
    steps = Steps(reporter, len(scan.frames) * _n_fusions(parameters))
    found = _find(scan, parameters, view_error_m(health, None), steps)
    planes = None if _is_plain(parameters) else _fit_all_planes(scan, found, parameters, reporter)
    refinement = None
    if parameters.refine_poses and planes is not None:
        block = found.part.box(found.volume)
        surfaces = view_surfaces(scan, planes, block)
        refinement = refine_poses(scan, surfaces, tables, health.sd_height_m, block, reporter)
        scan = refinement.applied_to(scan)
        found = _find(scan, parameters, view_error_m(health, refinement), steps)
    support_m = _support_height_m(found, scan, parameters, reporter)
    _warn_if_cut_off(found.volume, found.part, parameters, support_m, reporter)
    volume, part = found.volume, found.part
    if parameters.truncation_m is None:
        error_m = view_error_m(health, refinement)
        volume = _fuse_finely(found, scan, parameters, error_m, support_m, planes, steps)
        part = whole(volume)
    return FusedObject(volume, part, found.table, support_m, health, refinement)


@dataclass(frozen=True)
class _Found:
    """The object's part of a volume; the table is known with plane segmentation only."""

    volume: TsdfVolume
    part: Part
    table: Plane | None


def _is_plain(parameters: ReconstructionParameters) -> bool:
    """Whether the released code's arithmetic is all that is needed."""
    return parameters.truncation_m is not None and not parameters.refine_poses


def _n_fusions(parameters: ReconstructionParameters) -> int:
    return 1 + parameters.refine_poses + (parameters.truncation_m is None)


def _find(scan: Scan, parameters: ReconstructionParameters, error_m: float | None, steps: Steps) -> _Found:
    is_set = parameters.truncation_m is not None
    voxel_m = parameters.voxel_m if is_set else max(parameters.voxel_m, COARSE_VOXEL_M)
    truncation = choose_truncation(parameters, voxel_m, error_m)
    volume = fuse(scan, crop_box_of(scan, parameters), voxel_m, truncation, parameters.max_depth_m, steps)
    table = find_table(scan, parameters) if parameters.segmentation == "plane" else None
    return _Found(volume, find_object(volume, scan, parameters, table), table)


def _fuse_finely(
    found: _Found,
    scan: Scan,
    parameters: ReconstructionParameters,
    error_m: float | None,
    support_m: float,
    planes: Sequence[PlaneImage] | None,
    steps: Steps,
) -> TsdfVolume:
    block = _down_to_support(found.volume, found.part, support_m).box(found.volume)
    voxel_m = voxel_of(block, parameters)
    truncation = choose_truncation(parameters, voxel_m, error_m)
    return fuse(scan, block, voxel_m, truncation, parameters.max_depth_m, steps, planes)


def _down_to_support(volume: TsdfVolume, part: Part, support_m: float) -> Part:
    return part.down_to(int((support_m - volume.origin_m[2]) / volume.voxel_m) - 3)


def _support_height_m(
    found: _Found, scan: Scan, parameters: ReconstructionParameters, reporter: Reporter
) -> float:
    if found.table is not None:
        seen = found.part.seen
        middle = found.volume.centers_m((seen.min(axis=0) + seen.max(axis=0)) // 2)
        return float(found.table.height_m(middle[0], middle[1]))
    for known in (parameters.platform_height_m, scan.platform_height_m):
        if known is not None:
            return known
    estimate_m = estimate_platform_height_m(found.volume, found.part, scan, parameters)
    if parameters.unseen == "solid":
        reporter.warn(
            f"The platform's height is not known; {estimate_m * 1000:.0f} mm is taken, where the object's "
            "lowest points are; measure it and set reconstruction.platform_height_m."
        )
    return estimate_m


def _warn_if_cut_off(
    volume: TsdfVolume, part: Part, parameters: ReconstructionParameters, support_m: float, reporter: Reporter
) -> None:
    # A box that begins just above its platform separates the object from the table: no warning for that.
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


class Steps:
    """Counts the views of all fusions that a reconstruction needs."""

    def __init__(self, reporter: Reporter, total: int) -> None:
        self._reporter = reporter
        self._total = total
        self._done = 0

    def next(self) -> None:
        """Count one view.

        Raises:
            Cancelled: the user asked to stop.
        """
        self._done += 1
        self._reporter.progress(STAGE, self._done, self._total)
        self._reporter.raise_if_cancelled()


def _fit_all_planes(
    scan: Scan, found: _Found, parameters: ReconstructionParameters, reporter: Reporter
) -> tuple[PlaneImage, ...]:
    """Fit planes in all views where they show the object, down to the crop box's floor.

    Raises:
        Cancelled: the user asked to stop.
    """
    block, floor_m = found.part.box(found.volume), crop_box_of(scan, parameters).min_m[2]
    low, high = np.array([*block.min_m[:2], floor_m]), np.array(block.max_m)
    around = crop_box(low - AROUND_OBJECT_M, high + AROUND_OBJECT_M)

    def fit(frame: RgbdFrame) -> PlaneImage:
        reporter.raise_if_cancelled()
        window = PixelWindow.of_box(around, frame, scan.intrinsics)
        return fit_planes(frame.depth_m, scan.intrinsics, parameters.max_depth_m, window)

    return tuple(in_threads(fit, scan.frames))


def fuse(
    scan: Scan,
    box: CropBox,
    voxel_m: float,
    truncation: Truncation,
    max_depth_m: float,
    steps: Steps,
    planes: Sequence[PlaneImage] | None = None,
) -> TsdfVolume:
    """Fuse all views in a box; with `planes` distances are taken along the surfaces' normals.

    Raises:
        StageError: the box holds too many voxels.
        Cancelled: the user asked to stop.
    """
    volume = TsdfVolume(
        box.min_m, box.max_m, voxel_m, truncation.front_m, truncation.behind_m, truncation.falloff_m
    )
    for index, frame in enumerate(scan.frames):
        facing = None
        if planes is not None:
            facing = facing_image(planes[index], frame.depth_m.shape, scan.intrinsics)
        volume.integrate(frame, scan.intrinsics, max_depth_m, facing)
        steps.next()
    return volume


def voxel_of(block: CropBox, parameters: ReconstructionParameters) -> float:
    """Return the edge of the voxels in which an object's block is fused.

    No wall becomes thinner than they allow, at the cost of the hollow; finer ones take longer, so that they
    are used where there are few (docs/decisions/0053).
    """
    size_m3 = float(np.prod(np.subtract(block.max_m, block.min_m)))
    return min(parameters.voxel_m, parameters.fine_voxel_m) if size_m3 < SMALL_M3 else parameters.voxel_m


@dataclass(frozen=True)
class Truncation:
    """How a view counts: up to `front_m` and `behind_m`, its weight falling to 1/e within `falloff_m`."""

    front_m: float
    behind_m: float
    falloff_m: float = np.inf


def choose_truncation(
    parameters: ReconstructionParameters, voxel_m: float, error_m: float | None
) -> Truncation:
    """Return the truncation as set (the same on both sides), or following voxel and pose error."""
    if parameters.truncation_m is not None:
        return Truncation(parameters.truncation_m, parameters.truncation_m)
    if error_m is None:
        return Truncation(VOXELS_WITHOUT_TABLE * voxel_m, VOXELS_WITHOUT_TABLE * voxel_m)
    least_m = VOXELS_IN_FRONT * voxel_m
    front_m = max(min(least_m + FRONT_PER_VIEW_ERROR * error_m, LARGEST_M), least_m)
    falloff_m = FALLOFF_VOXELS * voxel_m + FALLOFF_PER_VIEW_ERROR * error_m
    return Truncation(front_m, min(BEHIND_PER_FALLOFF * falloff_m, front_m), falloff_m)


def view_error_m(health: PoseHealth, refinement: Refinement | None) -> float | None:
    """Return how far (standard deviation) the surface of one view errs; none if it is unknown."""
    if refinement is not None and refinement.view_error_m is not None:
        return refinement.view_error_m
    return None if health.sd_height_m is None else SURFACE_PER_TABLE_ERROR * health.sd_height_m
