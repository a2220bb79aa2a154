"""Scans: colour and depth images with poses, read from and written to the authors' layout."""

from core.scan.authors_layout import read_scan
from core.scan.crop_box import crop_box_of
from core.scan.model import CropBox, Intrinsics, RgbdFrame, Scan
from core.scan.writing import write_camera, write_frame, write_scan

__all__ = [
    "CropBox",
    "Intrinsics",
    "RgbdFrame",
    "Scan",
    "crop_box_of",
    "read_scan",
    "write_camera",
    "write_frame",
    "write_scan",
]
