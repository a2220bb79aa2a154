"""Scans in the layout of the authors' released data: reading, checking and writing.

`rgbd/frame-NNNNNN.{color.png,depth.png,pose.txt}` and `camera-intrinsics.txt`; beside it an optional
`scan.json`, which is ours: what the cell knew of the place where the object stood, each figure optional.
`{"platform_height_m": z, "crop_min_m": [x, y, z], "crop_max_m": [x, y, z]}`, in the robot's base frame.
"""

from __future__ import annotations

import io
import json
import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from core.errors import InputError, SessionError
from core.files import read_content, reason, write_whole
from core.formats import parse_json
from core.geometry import AnyArray
from core.progress import Reporter
from core.scan.decoded import decoded_view
from core.scan.model import CropBox, Intrinsics, RgbdFrame, Scan
from core.scan.view_files import (
    ENDINGS,
    check_intrinsics_fit,
    depth_to_millimetres,
    matrix_text,
    read_intrinsics,
)

STAGE = "import"
FRAMES_FOLDER = "rgbd"
INTRINSICS_FILE = "camera-intrinsics.txt"
FACTS_FILE = "scan.json"
SMALLEST_EDGE_M = 0.01
FEWEST_VIEWS = 3
SAME_POSE = 1e-9

_FileState = tuple[str, int, int]

_stored: dict[tuple[Path, frozenset[_FileState]], Scan] = {}


def read_scan(folder: Path, reporter: Reporter) -> Scan:
    """Read and check all views in `folder`, or in the folder `rgbd` in it.

    Views without information (no depth at all, an exact repetition) are left out with a warning.

    Raises:
        InputError: a file is missing or cannot be used; the sentence names it.
        Cancelled: the user asked to stop.
    """
    frames_folder = _find_frames(folder)
    names = _complete_views(frames_folder)
    intrinsics_path = _find_intrinsics(folder, frames_folder)
    intrinsics = read_intrinsics(intrinsics_path)
    frames = _read_frames(frames_folder, names, reporter)
    _check_one_size(frames, frames_folder)
    height, width = frames[0].depth_m.shape
    check_intrinsics_fit(intrinsics, width, height, intrinsics_path)
    useful = leave_out_useless(frames, frames_folder, reporter)
    return Scan(tuple(useful), intrinsics, *read_facts(intrinsics_path.parent / FACTS_FILE))


def views_so_far(folder: Path) -> Scan | None:
    """Read the views of a scan that is being made, as far as they are whole; none before the first.

    What cannot be used is left to whoever reads the finished scan: it says so.
    """
    images = folder / FRAMES_FOLDER
    names = sorted(path.name.removesuffix(ENDINGS[-1]) for path in images.glob(f"frame-*{ENDINGS[-1]}"))
    try:
        intrinsics = read_intrinsics(folder / INTRINSICS_FILE)
        frames = tuple(decoded_view(images, name) for name in names)
        return Scan(frames, intrinsics, *read_facts(folder / FACTS_FILE)) if frames else None
    except InputError:
        return None


def stored_scan(folder: Path, reporter: Reporter) -> Scan:
    """Read a session's scan, decoded once per process for as long as its files stay as they are.

    Its warnings are given when it is decoded, that is not every time. The arrays are shared: do not write to
    them.

    Raises:
        InputError: a file is missing or cannot be used.
        Cancelled: the user asked to stop.
    """
    key = folder.resolve(), _file_states(folder)
    if key not in _stored:
        scan = read_scan(folder, reporter)
        _stored.clear()  # one scan takes 50 MB
        _stored[key] = scan
    return _stored[key]


def _file_states(folder: Path) -> frozenset[_FileState]:
    """What distinguishes files that were rewritten from those that were not."""
    found = []
    for path in (*folder.glob("*"), *folder.glob(f"{FRAMES_FOLDER}/*")):
        with suppress(OSError):  # gone since it was listed
            state = path.stat()
            found.append((path.name, state.st_ino, state.st_mtime_ns))
    return frozenset(found)


def _find_frames(folder: Path) -> Path:
    if not folder.is_dir():
        raise InputError(
            f"There is no folder {folder}; give the folder that holds {INTRINSICS_FILE} and rgbd."
        )
    for candidate in (folder / FRAMES_FOLDER, folder):
        if candidate.is_dir() and _view_files(candidate):
            return candidate
    raise InputError(
        f"The folder {folder} holds no views; give one with {FRAMES_FOLDER}/frame-*.color.png, "
        "frame-*.depth.png and frame-*.pose.txt."
    )


def _view_files(folder: Path) -> set[str]:
    try:
        names = {path.name for path in folder.glob("frame-*")}
    except OSError as error:
        raise InputError(f"The folder {folder} cannot be read ({error}); check its permissions.") from error
    return {name for name in names if name.endswith(ENDINGS)}


def _complete_views(folder: Path) -> list[str]:
    files = _view_files(folder)
    views = sorted({file.removesuffix(end) for file in files for end in ENDINGS if file.endswith(end)})
    for view in views:
        for end in ENDINGS:
            if view + end not in files:
                raise InputError(
                    f"{folder / (view + end)} is missing; copy it there or delete the other files of {view}."
                )
    return views


def _find_intrinsics(folder: Path, frames_folder: Path) -> Path:
    places = [folder, frames_folder]
    if folder.name == FRAMES_FOLDER:
        places.append(folder.parent)
    for place in places:
        if (place / INTRINSICS_FILE).is_file():
            return place / INTRINSICS_FILE
    raise InputError(
        f"{folder / INTRINSICS_FILE} is missing; put the camera matrix there as three lines of three numbers."
    )


def _read_frames(folder: Path, names: list[str], reporter: Reporter) -> list[RgbdFrame]:
    frames: list[RgbdFrame] = []
    with ThreadPoolExecutor() as pool:  # Pillow decodes without the GIL
        for frame in pool.map(partial(decoded_view, folder), names):
            frames.append(frame)
            reporter.progress(STAGE, len(frames), len(names))
            reporter.raise_if_cancelled()
    return frames


def _check_one_size(frames: list[RgbdFrame], folder: Path) -> None:
    expected = frames[0].depth_m.shape
    for frame in frames:
        for ending, shape in ((".depth.png", frame.depth_m.shape), (".color.png", frame.color.shape[:2])):
            if shape != expected:
                raise InputError(
                    f"The image {folder / (frame.name + ending)} is {shape[1]} x {shape[0]} but "
                    f"{frames[0].name}.depth.png is {expected[1]} x {expected[0]}; "
                    "all colour and depth images of a scan must have one size."
                )


def facts_text(platform_height_m: float | None, crop_box: CropBox | None) -> str:
    """Return what `read_facts` gives back; empty when nothing is known."""
    facts: dict[str, Any] = {}
    if platform_height_m is not None:
        facts["platform_height_m"] = platform_height_m
    if crop_box is not None:
        facts |= {"crop_min_m": crop_box.min_m, "crop_max_m": crop_box.max_m}
    return json.dumps(facts, allow_nan=False) + "\n" if facts else ""


def read_facts(path: Path) -> tuple[float | None, CropBox | None]:
    """Return the platform's height and the crop box; none where the file is missing.

    Raises:
        InputError: the file is damaged; the sentence names it.
    """
    if not path.exists():
        return None, None
    try:
        facts = dict(parse_json(read_content(path)).items())
    except (OSError, ValueError, AttributeError) as error:
        raise InputError(f"{path} cannot be read ({reason(error)}); correct it or delete it.") from error
    return _platform_height(facts.get("platform_height_m"), path), _crop_box(facts, path)


def _platform_height(height: Any, path: Path) -> float | None:
    if height is None:
        return None
    if not _is_length(height):
        raise InputError(f"platform_height_m in {path} must be a height in metres in the base frame.")
    return float(height)


def _crop_box(facts: dict[str, Any], path: Path) -> CropBox | None:
    if facts.get("crop_min_m") is None and facts.get("crop_max_m") is None:
        return None
    low, high = _corner(facts.get("crop_min_m"), path), _corner(facts.get("crop_max_m"), path)
    if any(b - a < SMALLEST_EDGE_M for a, b in zip(low, high, strict=True)):
        raise InputError(
            f"crop_max_m in {path} must exceed crop_min_m by at least {SMALLEST_EDGE_M} m in every direction."
        )
    return CropBox(low, high)


def _corner(value: Any, path: Path) -> tuple[float, float, float]:
    if not (isinstance(value, list) and len(value) == 3 and all(_is_length(number) for number in value)):
        raise InputError(f"crop_min_m and crop_max_m in {path} must be three metres each in the base frame.")
    return float(value[0]), float(value[1]), float(value[2])


def _is_length(value: Any) -> bool:
    return not isinstance(value, bool) and isinstance(value, int | float) and math.isfinite(value)


def leave_out_useless(frames: Sequence[RgbdFrame], folder: Path, reporter: Reporter) -> list[RgbdFrame]:
    """Return the frames without empty and repeated ones; what is left out is reported as a warning.

    Raises:
        InputError: leaving out leaves fewer than three views.
    """
    kept = _without_repeated(_without_empty(frames, folder, reporter), folder, reporter)
    if len(kept) < min(FEWEST_VIEWS, len(frames)) or not kept:
        raise InputError(
            f"Only {len(kept)} of the {len(frames)} views in {folder} can be used, the others are empty or "
            f"repeated; at least {FEWEST_VIEWS} are needed, so scan again."
        )
    return kept


def _without_empty(frames: Sequence[RgbdFrame], folder: Path, reporter: Reporter) -> list[RgbdFrame]:
    kept = []
    for frame in frames:
        if frame.depth_m.any():
            kept.append(frame)
        else:
            reporter.warn(
                f"The depth image {folder / frame.name}.depth.png is empty (all zero); this view is left out."
            )
    return kept


def _without_repeated(frames: Sequence[RgbdFrame], folder: Path, reporter: Reporter) -> list[RgbdFrame]:
    kept: list[RgbdFrame] = []
    for frame in frames:
        twins = [
            other for other in kept if np.abs(other.T_base_camera - frame.T_base_camera).max() < SAME_POSE
        ]
        copies = [other for other in twins if np.array_equal(other.depth_m, frame.depth_m)]
        if copies:
            reporter.warn(
                f"The view {folder / frame.name} repeats {copies[0].name} (same pose, same depth image); "
                "it is left out."
            )
            continue
        if twins:
            reporter.warn(
                f"The views {folder / frame.name} and {twins[0].name} have the same pose but different "
                "images; check that their pose files belong to them."
            )
        kept.append(frame)
    return kept


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
    _write(folder / INTRINSICS_FILE, matrix_text(intrinsics.matrix))
    facts = facts_text(platform_height_m, crop_box)
    if facts:
        _write(folder / FACTS_FILE, facts)
    else:
        (folder / FACTS_FILE).unlink(missing_ok=True)


def write_frame(frame: RgbdFrame, folder: Path) -> None:
    """Write one view into the scan `folder` (its images go to `rgbd`); the pose comes last.

    Raises:
        SessionError: a file cannot be written.
    """
    place = folder / FRAMES_FOLDER
    _write(place / f"{frame.name}.color.png", _png(frame.color))
    _write(place / f"{frame.name}.depth.png", _png(depth_to_millimetres(frame.depth_m)))
    _write(place / f"{frame.name}.pose.txt", matrix_text(frame.T_base_camera))


def _png(pixels: AnyArray) -> bytes:
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, format="PNG", compress_level=1)
    return buffer.getvalue()


def _write(path: Path, content: str | bytes) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, content)
    except OSError as error:
        raise SessionError(
            f"{path} cannot be written ({error.strerror}); free space or choose another folder."
        ) from error
