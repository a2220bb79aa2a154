"""Temporary folders that do not outlive their program: what a killed one left is removed by the next one."""

from __future__ import annotations

import shutil
import tempfile
import time
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from weakref import finalize

from filelock import FileLock, Timeout

_PREFIX = "poursight-"
_HELD = ".held"
_BEING_MADE_S = 2.0
"""A folder that is younger may be about to be locked."""


class ScratchFolder:
    """A temporary folder; it goes when closed, or with this object, or, after a kill, with the next one.

    Attributes:
        path: of the folder.
    """

    def __init__(self) -> None:
        remove_left()
        self.path = Path(tempfile.mkdtemp(prefix=_PREFIX))
        self._lock = FileLock(self.path / _HELD, blocking=False, thread_local=False)
        self._lock.acquire()  # the system drops it when the program ends, however that happens
        self._remove = finalize(self, _close, self.path, self._lock)

    def __enter__(self) -> Path:
        return self.path

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Remove the folder."""
        self._remove()


def remove_left() -> None:
    """Remove the folders of programs that are gone; what cannot be removed, such as others', stays."""
    for folder in Path(tempfile.gettempdir()).glob(f"{_PREFIX}*/{_HELD}"):
        with suppress(OSError):
            if time.time() - folder.stat().st_mtime > _BEING_MADE_S:
                _remove_if_left(folder.parent)


def _remove_if_left(folder: Path) -> None:
    lock = FileLock(folder / _HELD, blocking=False, thread_local=False)
    try:
        lock.acquire()
    except Timeout:
        return
    _close(folder, lock)


def _close(folder: Path, lock: FileLock) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    lock.release()
