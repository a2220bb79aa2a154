"""Runs of the cup alone that are kept from one session to the next, in a folder of bounded size."""

from __future__ import annotations

import os
import tempfile
from contextlib import suppress
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from platform import machine
from zipfile import BadZipFile

import numpy as np

from core.imagination.cup_run import CupRun
from core.imagination.recording import Recording

MOST_BYTES = 128 * 2**20
"""About a thousand runs of 60 candies."""
_AFTER_EMPTYING = 0.8
"""So full it is once the oldest were removed, so that not every new run looks for the oldest."""
_ABANDONED_S = 3600.0
"""A file that was not finished after this time belongs to a program that was killed."""
_SUFFIX, _UNFINISHED = ".npz", ".part"
_DAMAGED = (OSError, ValueError, KeyError, EOFError, BadZipFile)


class KeptRuns:
    """A folder of runs, each under the digest of everything that decided it.

    Runs are copies of what can be computed again: a folder that cannot be written or read costs time, and is
    no error. Several programs may share it, and be killed at any moment: a run is there whole or not at all.

    Attributes:
        folder: that holds them; made with the first run.
    """

    def __init__(self, folder: Path, most_bytes: int = MOST_BYTES) -> None:
        self.folder = folder
        self._most_bytes = most_bytes

    def fetch(self, settings: str) -> CupRun | None:
        """Return the run with these settings, to the last bit as it was computed; none if it is not there."""
        path = self._path(settings)
        try:
            with np.load(path) as arrays:
                run = CupRun(
                    arrays["release_steps"],
                    arrays["poses"],
                    arrays["velocities"],
                    Recording(
                        arrays["time_s"], arrays["positions_m"], arrays["quaternions"], arrays["T_world_body"]
                    ),
                )
        except _DAMAGED:
            return None
        with suppress(OSError):  # a folder that may only be read
            os.utime(path)  # the oldest are those that were not wanted for longest
        return run

    def store(self, settings: str, run: CupRun) -> None:
        """Keep a run; the oldest go when there are too many."""
        recording = run.recording
        with suppress(OSError):
            self.folder.mkdir(parents=True, exist_ok=True)
            descriptor, unfinished = tempfile.mkstemp(_UNFINISHED, dir=self.folder)
            try:
                with os.fdopen(descriptor, "wb") as file:
                    np.savez(
                        file,
                        release_steps=run.release_steps,
                        poses=run.poses,
                        velocities=run.velocities,
                        time_s=recording.time_s,
                        positions_m=recording.positions_m,
                        quaternions=recording.quaternions,
                        T_world_body=recording.T_world_body,
                    )
                Path(unfinished).replace(self._path(settings))
            finally:
                Path(unfinished).unlink(missing_ok=True)
            self._remove_oldest()

    def size(self) -> tuple[int, int]:
        """Return how many runs there are, and their size in bytes."""
        files = self._files(_SUFFIX)
        return len(files), sum(size for _, size, _ in files)

    def empty(self) -> None:
        """Remove all runs.

        Raises:
            OSError: the system refuses.
        """
        for suffix in (_SUFFIX, _UNFINISHED):
            for _, _, path in self._files(suffix):
                path.unlink(missing_ok=True)

    def _remove_oldest(self) -> None:
        files = sorted(self._files(_SUFFIX))
        total = sum(size for _, size, _ in files)
        if total <= self._most_bytes:
            return
        newest_s = files[-1][0]
        for _, size, path in files:
            if total <= _AFTER_EMPTYING * self._most_bytes:
                break
            path.unlink(missing_ok=True)
            total -= size
        for changed_s, _, path in self._files(_UNFINISHED):
            if changed_s < newest_s - _ABANDONED_S:
                path.unlink(missing_ok=True)

    def _files(self, suffix: str) -> list[tuple[float, int, Path]]:
        """When each was last wanted, its size, and where it is; another program may remove it meanwhile."""
        found = []
        for path in self.folder.glob(f"*{suffix}"):
            with suppress(OSError):
                status = path.stat()
                found.append((status.st_mtime, status.st_size, path))
        return found

    def _path(self, settings: str) -> Path:
        return self.folder / (sha256(f"{_program()}\n{settings}".encode()).hexdigest() + _SUFFIX)


@cache
def _program() -> str:
    """What decides a run besides its settings: this package's code, the physics engine, the processor."""
    digest = sha256()
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    return f"{digest.hexdigest()} {version('pybullet')} {version('numpy')} {machine()}"
