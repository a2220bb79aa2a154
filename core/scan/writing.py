"""Writing scans in the authors' layout, each file whole or not at all."""

from __future__ import annotations

import io
from contextlib import suppress
from pathlib import Path

from PIL import Image

from core.errors import SessionError
from core.geometry import AnyArray
from core.scan.authors_layout import FACTS_FILE, FRAMES_FOLDER, INTRINSICS_FILE
from core.scan.facts import facts_text
from core.scan.images import depth_to_millimetres
from core.scan.matrices import matrix_text
from core.scan.model import CropBox, Intrinsics, RgbdFrame, Scan


def write_scan(scan: Scan, folder: Path) -> None:
    """Write a whole scan so that `read_scan` gives it back (depth rounded to a millimetre).

    Raises:
        SessionError: a file cannot be written.
    """
    write_camera(scan.intrinsics, scan.platform_height_m, folder, scan.crop_box)
    for frame in scan.frames:
        write_frame(frame, folder)


def write_camera(
    intrinsics: Intrinsics, platform_height_m: float | None, folder: Path, crop_box: CropBox | None = None
) -> None:
    """Write what all views share: the camera matrix and, when known, the platform's height and the crop box.

    Raises:
        SessionError: a file cannot be written.
    """
    _write_whole(folder / INTRINSICS_FILE, matrix_text(intrinsics.matrix).encode())
    facts = facts_text(platform_height_m, crop_box)
    if facts:
        _write_whole(folder / FACTS_FILE, facts.encode())
    else:
        (folder / FACTS_FILE).unlink(missing_ok=True)


def write_frame(frame: RgbdFrame, folder: Path) -> None:
    """Write one view into the scan `folder` (its images go to `rgbd`); the pose comes last.

    Raises:
        SessionError: a file cannot be written.
    """
    place = folder / FRAMES_FOLDER
    _write_whole(place / f"{frame.name}.color.png", _png(frame.color))
    _write_whole(place / f"{frame.name}.depth.png", _png(depth_to_millimetres(frame.depth_m)))
    _write_whole(place / f"{frame.name}.pose.txt", matrix_text(frame.T_base_camera).encode())


def _png(pixels: AnyArray) -> bytes:
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, format="PNG", compress_level=1)
    return buffer.getvalue()


def _write_whole(path: Path, content: bytes) -> None:
    part = path.with_name(f".{path.name}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part.write_bytes(content)
        part.replace(path)
    except OSError as error:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise SessionError(
            f"{path} cannot be written ({error.strerror}); free space or choose another folder."
        ) from error
