"""The files of a scan's views, each checked: colour and depth images as PNG, poses and intrinsics as text."""

from __future__ import annotations

import math
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image, UnidentifiedImageError

from core.errors import InputError
from core.files import read_content, reason
from core.geometry import AnyArray, FloatArray, rotation_error
from core.scan.model import ColorImage, DepthImage, Intrinsics

ENDINGS = (".color.png", ".depth.png", ".pose.txt")
"""Of a view's files, in the order in which they are written."""
MILLIMETRES_PER_METRE = 1000
SMALLEST_PLAUSIBLE_DEPTH = 20
"""A depth image whose largest value is below this many millimetres was surely written in metres."""
ROTATION_TOLERANCE = 1e-3
"""Largest entry of |R R^T - I|: accepts poses written with four digits, rejects what is not a rotation."""
FARTHEST_CAMERA_M = 10.0
"""No robot arm carries its camera farther; this tells poses in millimetres from poses in metres."""


def read_color(path: Path) -> ColorImage:
    """Read an 8-bit colour image as (H, W, 3) RGB.

    Raises:
        InputError: the file is unreadable, truncated or not an 8-bit image.
    """
    mode, pixels = _decode(path, to_rgb=True)
    if mode not in ("RGB", "RGBA", "L", "LA", "P", "1"):
        raise InputError(f"The colour image {path} has pixels of kind '{mode}'; save it as an 8-bit RGB PNG.")
    return pixels


def read_depth(path: Path) -> DepthImage:
    """Read a 16-bit millimetre image as (H, W) metres, 0 where nothing was measured.

    Raises:
        InputError: the file is unreadable, truncated or not in 16-bit millimetres.
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
        with Image.open(BytesIO(read_content(path))) as image:
            mode = image.mode
            return mode, np.asarray(image.convert("RGB") if to_rgb else image)
    except Exception as error:  # Pillow raises a different kind for each way in which a file can be damaged
        why = "it is not an image" if isinstance(error, UnidentifiedImageError) else reason(error)
        raise InputError(
            f"The image {path} cannot be read ({why}); copy it again or delete the view's three files."
        ) from error


def read_pose(path: Path) -> FloatArray:
    """Read `T_base_camera` (4, 4) in metres.

    Raises:
        InputError: the file cannot be read or holds no pose.
    """
    pose = _read_matrix(path, 4, "pose")
    if np.abs(pose[3] - [0.0, 0.0, 0.0, 1.0]).max() > 1e-6:
        raise InputError(f"The last row of the pose in {path} must be 0 0 0 1; write camera-to-base poses.")
    if np.abs(pose[:3, :3]).max() > 2.0 or rotation_error(pose[:3, :3]) > ROTATION_TOLERANCE:
        raise InputError(
            f"The upper left 3x3 part of the pose in {path} is not a rotation; "
            "export the camera-to-base pose of this view again or delete the view's three files."
        )
    if np.abs(pose[:3, 3]).max() > FARTHEST_CAMERA_M:
        raise InputError(
            f"The pose in {path} puts the camera more than {FARTHEST_CAMERA_M:.0f} m from the base; "
            "write its translation in metres."
        )
    return pose


def read_intrinsics(path: Path) -> Intrinsics:
    """Read the camera matrix (3, 3) in pixels.

    Raises:
        InputError: the file cannot be read or holds no camera matrix.
    """
    matrix = _read_matrix(path, 3, "camera matrix")
    expected = np.array([[matrix[0, 0], 0, matrix[0, 2]], [0, matrix[1, 1], matrix[1, 2]], [0, 0, 1]])
    if matrix[0, 0] <= 0 or matrix[1, 1] <= 0 or np.abs(matrix - expected).max() > 1e-6:
        raise InputError(
            f"{path} holds no pinhole camera matrix; write it as 'fx 0 cx', '0 fy cy', '0 0 1' in pixels."
        )
    return Intrinsics(*(float(matrix[index]) for index in ((0, 0), (1, 1), (0, 2), (1, 2))))


def check_intrinsics_fit(intrinsics: Intrinsics, width: int, height: int, path: Path) -> None:
    """Raise `InputError` if the camera matrix from `path` belongs to images of another size."""
    # Half or twice the resolution moves the principal point by a quarter of the image or more.
    fits = abs(intrinsics.cx / width - 0.5) < 0.25 and abs(intrinsics.cy / height - 0.5) < 0.25
    if not fits:
        raise InputError(
            f"The camera matrix in {path} has its principal point at ({intrinsics.cx:g}, {intrinsics.cy:g}) "
            f"but the images are {width} x {height}; use the intrinsics of this resolution."
        )


def matrix_text(matrix: FloatArray) -> str:
    """Return rows of numbers that read back to the same doubles."""
    return "".join(" ".join(repr(float(value)) for value in row) + "\n" for row in matrix)


def _read_matrix(path: Path, size: int, what: str) -> FloatArray:
    try:
        rows = [line.split() for line in read_content(path).decode("utf-8").splitlines() if line.strip()]
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"The {what} in {path} cannot be read ({reason(error)}); copy the file again."
        ) from error
    if [len(row) for row in rows] != [size] * size:
        raise InputError(f"{path} must hold a {size}x{size} {what}, {size} numbers in each of {size} lines.")
    try:
        values = [[float(word) for word in row] for row in rows]
    except ValueError as error:
        raise InputError(
            f"The {what} in {path} contains something that is not a number ({reason(error)}); "
            f"write {size}x{size} numbers."
        ) from error
    if not all(math.isfinite(value) for row in values for value in row):
        raise InputError(
            f"The {what} in {path} holds NaN or infinity; export it again or delete the view's three files."
            if size == 4
            else f"The {what} in {path} holds NaN or infinity; write the calibrated values in pixels."
        )
    return np.array(values)
