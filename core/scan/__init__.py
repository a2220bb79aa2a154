"""Scans: colour and depth images with poses, read from and written to the authors' layout."""

from core.scan.authors_layout import (
    read_scan,
    stored_scan,
    views_so_far,
    write_camera,
    write_frame,
    write_scan,
)
from core.scan.model import CropBox, Intrinsics, RgbdFrame, Scan, crop_box_of

__all__ = [
    "CropBox",
    "Intrinsics",
    "RgbdFrame",
    "Scan",
    "crop_box_of",
    "read_scan",
    "stored_scan",
    "views_so_far",
    "write_camera",
    "write_frame",
    "write_scan",
]
