"""One writer a session, also across programs. The system drops the lock of a program that died."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from filelock import FileLock, Timeout

from core.errors import SessionError
from core.files import read_content, write_whole
from core.session.explaining import explained


class SessionLock:
    """The exclusive lock of a session's folder; beside it lies the holder's process number for others."""

    def __init__(self, folder: Path) -> None:
        """Prepare the lock of `folder` without taking it."""
        self._folder = folder
        self._writer = folder / ".writer"
        # The window takes and releases the session in whichever thread is at it.
        self._lock = FileLock(folder / ".lock", blocking=False, thread_local=False)

    @property
    def is_held(self) -> bool:
        """Whether this object holds the lock."""
        return self._lock.is_locked

    def acquire(self) -> None:
        """Take the lock at once.

        Raises:
            SessionError: another program holds it, or the folder cannot be written.
        """
        try:
            with explained(self._folder):
                self._lock.acquire()
        except Timeout:
            raise SessionError(
                f"The session {self._folder} is being written by another program{self._holder()}; "
                "close it first."
            ) from None
        with suppress(OSError):  # a courtesy to whom the lock will refuse
            write_whole(self._writer, str(os.getpid()))

    def release(self) -> None:
        """Give the lock back."""
        with suppress(OSError):
            self._writer.unlink(missing_ok=True)
        self._lock.release()

    def _holder(self) -> str:
        try:
            number = read_content(self._writer).decode("ascii").strip()
        except (OSError, ValueError):
            return ""
        return f" (process {number})" if number.isdigit() else ""
