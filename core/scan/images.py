"""Colour and depth images as PNG files, checked."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image, UnidentifiedImageError

from core.errors import InputError
from core.geometry import AnyArray
from core.scan.model import ColorImage, DepthImage

MILLIMETRES_PER_METRE = 1000
SMALLEST_PLAUSIBLE_DEPTH = 20
"""A depth image whose largest value is below this many millimetres was surely written in metres."""


def read_color(path: Path) -> ColorImage:
    """Read an 8-bit colour image as (H, W, 3) RGB.

    Raises:
        InputError: the file is unreadable, cut short or no 8-bit image.
    """
    mode, pixels = _decode(path, to_rgb=True)
    if mode not in ("RGB", "RGBA", "L", "LA", "P", "1"):
        raise InputError(f"The colour image {path} has pixels of kind '{mode}'; save it as an 8-bit RGB PNG.")
    return pixels


def read_depth(path: Path) -> DepthImage:
    """Read a 16-bit millimetre image as (H, W) metres, 0 where nothing was measured.

    Raises:
        InputError: the file is unreadable, cut short or not in 16-bit millimetres.
    """
    mode, pixels = _decode(path, to_rgb=False)
    wanted = "save it as a 16-bit grey PNG in millimetres"
    if mode == "F":
        raise InputError(f"The depth image {path} holds floating-point numbers (metres?); {wanted}.")
    if not mode.startswith("I"):
        raise InputError(f"The depth image {path} has 8-bit pixels (kind '{mode}'); {wanted}.")
    if pixels.min() < 0 or pixels.max() > np.iinfo(np.uint16).max:
        raise InputError(f"The depth image {path} holds values outside 16 bits; {wanted}.")
    if 0 < pixels.max() < SMALLEST_PLAUSIBLE_DEPTH:
        raise InputError(
            f"The depth image {path} reaches {pixels.max()} at most, so it is in metres; {wanted}."
        )
    return pixels.astype(np.float32) / np.float32(MILLIMETRES_PER_METRE)


def depth_to_millimetres(depth_m: DepthImage) -> AnyArray:
    """Return (H, W) uint16 millimetres; what is not finite or does not fit becomes 0 (no measurement)."""
    with np.errstate(invalid="ignore"):
        millimetres = np.rint(depth_m.astype(float) * MILLIMETRES_PER_METRE)
        fits = (millimetres >= 0) & (millimetres <= np.iinfo(np.uint16).max)
    return np.where(fits, millimetres, 0).astype(np.uint16)


def _decode(path: Path, *, to_rgb: bool) -> tuple[str, AnyArray]:
    try:
        with Image.open(path) as image:
            mode = image.mode
            return mode, np.asarray(image.convert("RGB") if to_rgb else image)
    except Exception as error:  # Pillow raises a different kind for each way in which a file can be damaged
        reason = "it is no image" if isinstance(error, UnidentifiedImageError) else str(error)
        raise InputError(
            f"The image {path} cannot be read ({reason}); copy it again or delete the view's three files."
        ) from error
