"""What the refinement changed in the views' poses; to be read and shown without what computes it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from core.geometry import FloatArray
from core.scan.model import Scan


@dataclass(frozen=True)
class ViewCorrection:
    """What one view's pose was changed by, and how well it fits the others.

    Attributes:
        name: of the view.
        shift_m: how far the camera was moved.
        turn_rad: by what angle it was turned.
        residual_before_m: distance (rms) of its points from the surfaces of the other views, with the
            recorded poses; none if it meets no other view.
        residual_after_m: the same with the corrected poses.
        T_base_camera: (4, 4), the corrected pose.
    """

    name: str
    shift_m: float
    turn_rad: float
    residual_before_m: float | None
    residual_after_m: float | None
    T_base_camera: FloatArray


@dataclass(frozen=True)
class Refinement:
    """The corrections of all views, in the order of the scan, and what they brought.

    Attributes:
        views: one correction each.
        residual_before_m: distance (rms) between the views' surfaces, with the recorded poses; none if no two
            views show the same.
        residual_after_m: the same with the corrected poses.
        table_sd_before_m: standard deviation of the table's height over the views; none without a table.
        table_sd_after_m: the same with the corrected poses.
        view_error_m: how far (standard deviation) the surface that one view shows errs after the correction,
            by the nearest matches; noise of the depth included.
    """

    views: tuple[ViewCorrection, ...]
    residual_before_m: float | None
    residual_after_m: float | None
    table_sd_before_m: float | None
    table_sd_after_m: float | None
    view_error_m: float | None

    def applied_to(self, scan: Scan) -> Scan:
        """Return the scan with the corrected poses."""
        frames = zip(scan.frames, self.views, strict=True)
        return replace(
            scan, frames=tuple(replace(frame, T_base_camera=view.T_base_camera) for frame, view in frames)
        )
