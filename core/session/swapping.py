"""Putting a stage's new folder in the place of its old one, so that a kill at any moment leaves one of them.

.stage.writing    being written, worth nothing yet
.stage.new        whole and on the disk: from this rename on it counts, even if the program dies now
.stage.old        what stood there before, about to be removed
"""

from __future__ import annotations

import os
import shutil
from pathlib import Path

_WRITING, _NEW, _OLD = ".writing", ".new", ".old"


def start(folder: Path, stage: str) -> Path:
    """Make the empty temporary folder for `stage` in the session's `folder`."""
    if _beside(folder, stage, _NEW).exists():  # a swap failed half-way earlier in this program
        _put_in_place(folder, stage)
    writing = _beside(folder, stage, _WRITING)
    _remove(writing)
    writing.mkdir()
    return writing


def abandon(folder: Path, stage: str) -> None:
    """Remove the temporary folder; what cannot be removed now goes at the next opening."""
    shutil.rmtree(_beside(folder, stage, _WRITING), ignore_errors=True)


def commit(folder: Path, stage: str) -> None:
    """Let the temporary folder take the place of the stage's old one."""
    writing, new = _beside(folder, stage, _WRITING), _beside(folder, stage, _NEW)
    flush(writing)
    writing.rename(new)
    _put_in_place(folder, stage)


def recover(folder: Path) -> None:
    """Finish or undo what a killed program left half done. The session must be locked."""
    for new in folder.glob(f".*{_NEW}"):
        _put_in_place(folder, new.name[1 : -len(_NEW)])
    for leftover in [*folder.glob(f".*{_WRITING}"), *folder.glob(f".*{_OLD}")]:
        _remove(leftover)


def _put_in_place(folder: Path, stage: str) -> None:
    place, old = folder / stage, _beside(folder, stage, _OLD)
    if os.path.lexists(place):
        _remove(old)
        place.rename(old)
    _beside(folder, stage, _NEW).rename(place)
    flush_entry(folder)
    _remove(old)


def _beside(folder: Path, stage: str, ending: str) -> Path:
    return folder / f".{stage}{ending}"


def _remove(folder: Path) -> None:
    """Remove what stands there; of a link (a stage that somebody put on another disk) only the link."""
    if folder.is_symlink() or folder.is_file():
        folder.unlink()
    elif folder.exists():
        shutil.rmtree(folder)


def flush(folder: Path) -> None:
    """Have all files of a folder on the disk, against a power cut."""
    for path in [*folder.rglob("*"), folder]:
        flush_entry(path)


def flush_entry(path: Path) -> None:
    """Have a file's content, or the names in a folder, on the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
