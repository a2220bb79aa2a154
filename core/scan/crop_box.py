"""Which box holds the object: the parameters' own, else the scan's, else the released code's."""

from __future__ import annotations

from core.parameters.reconstruction import ReconstructionParameters
from core.scan.model import CropBox, Scan

RELEASED_BOX = CropBox((-0.30, -0.55, 0.03), (0.18, -0.15, 0.35))
"""The grid of the released code, in the base frame of the authors' robot."""


def crop_box_of(scan: Scan | None, parameters: ReconstructionParameters) -> CropBox:
    """Return the box that holds the object; without a scan the parameters' or the released."""
    if parameters.crop_min_m is not None and parameters.crop_max_m is not None:
        return CropBox(parameters.crop_min_m, parameters.crop_max_m)
    if scan is not None and scan.crop_box is not None:
        return scan.crop_box
    return RELEASED_BOX
