"""Views decoded once in a process, though they are read while the arm still scans, and all of them later."""

from __future__ import annotations

from collections import OrderedDict
from pathlib import Path
from threading import Lock

from core.scan.model import RgbdFrame
from core.scan.view_files import ENDINGS, read_color, read_depth, read_pose

MOST_KEPT = 40
"""Views that are kept, the newest; one takes 2 MB, and a stored scan shares them."""
_FileState = tuple[str, int, int]
_Key = tuple[_FileState, ...]
_kept: OrderedDict[_Key, RgbdFrame] = OrderedDict()
_keeping = Lock()
"""Views are decoded by several threads at once."""


def decoded_view(folder: Path, name: str) -> RgbdFrame:
    """Read one view, unless this process did and its files are the same, wherever they have been copied to.

    The arrays are shared: do not write to them.

    Raises:
        InputError: a file cannot be used; the sentence names it.
    """
    try:
        key = tuple(_state(folder / (name + ending)) for ending in ENDINGS)
    except OSError:
        return _decode(folder, name)  # says what is wrong with which file
    with _keeping:
        known = _kept.get(key)
    if known is not None:
        return known
    frame = _decode(folder, name)
    with _keeping:
        _kept[key] = frame
        while len(_kept) > MOST_KEPT:
            _kept.popitem(last=False)
    return frame


def _decode(folder: Path, name: str) -> RgbdFrame:
    pose = read_pose(folder / f"{name}.pose.txt")
    depth = read_depth(folder / f"{name}.depth.png")
    return RgbdFrame(name, read_color(folder / f"{name}.color.png"), depth, pose)


def _state(path: Path) -> _FileState:
    """What tells a file that was written anew from one that was moved or copied."""
    found = path.stat()
    return path.name, found.st_size, found.st_mtime_ns
