"""Scans as the authors' released data lay them out.

`rgbd/frame-NNNNNN.{color.png,depth.png,pose.txt}` and `camera-intrinsics.txt`; beside it an optional
`scan.json` (facts.py), which is ours.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from core.errors import InputError
from core.progress import Reporter
from core.scan.facts import read_facts
from core.scan.images import read_color, read_depth
from core.scan.matrices import check_intrinsics_fit, read_intrinsics, read_pose
from core.scan.model import RgbdFrame, Scan
from core.scan.views import leave_out_useless

STAGE = "import"
FRAMES_FOLDER = "rgbd"
INTRINSICS_FILE = "camera-intrinsics.txt"
FACTS_FILE = "scan.json"
ENDINGS = (".color.png", ".depth.png", ".pose.txt")


def read_scan(folder: Path, reporter: Reporter) -> Scan:
    """Read and check all views in `folder`, or in the folder `rgbd` in it.

    Views that say nothing (no depth at all, an exact repetition) are left out with a warning.

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
    def read(name: str) -> RgbdFrame:
        pose = read_pose(folder / f"{name}.pose.txt")
        depth = read_depth(folder / f"{name}.depth.png")
        return RgbdFrame(name, read_color(folder / f"{name}.color.png"), depth, pose)

    frames: list[RgbdFrame] = []
    with ThreadPoolExecutor() as pool:  # Pillow decodes without the GIL
        for frame in pool.map(read, names):
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
