"""How far the poses of a scan's views let the object stand from where it is believed to."""

from __future__ import annotations

from math import hypot, sqrt

from core.parameters import Parameters


def with_scan_error(parameters: Parameters, pose_sd_m: float | None, n_views: int) -> Parameters:
    """Return the parameters with the risk's object error raised by what a scan's poses leave open.

    The surface is the mean of what the views say, so that their errors, taken as independent, fall with the
    square root of their number. An error that all views share is in `risk.object_error_m`.

    Args:
        parameters: of the imagination.
        pose_sd_m: SD of a view's position along an axis, as the table tells it; none if it is not known.
        n_views: of the scan.
    """
    if pose_sd_m is None or n_views == 0:
        return parameters
    error_m = hypot(parameters.risk.object_error_m, pose_sd_m / sqrt(n_views))
    return parameters.model_copy(
        update={"risk": parameters.risk.model_copy(update={"object_error_m": error_m})}
    )
