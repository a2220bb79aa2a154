"""What the operating system refuses, said in a sentence."""

from __future__ import annotations

import errno
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from core.errors import Remedy, SessionError

_FULL = {errno.ENOSPC, errno.EDQUOT}
_FORBIDDEN = {errno.EROFS, errno.EACCES, errno.EPERM}
_FULL_BELOW_BYTES = 64 * 1024


@contextmanager
def explained(folder: Path) -> Iterator[None]:
    """Turn a full disk and a folder that may not be written into a `SessionError`; let the rest through.

    Raises:
        SessionError: writing in `folder` failed for one of these reasons.
    """
    try:
        yield
    except Exception as error:
        known = _known(error, folder)
        if known is None:
            raise
        raise known from error


def _known(error: Exception, folder: Path) -> SessionError | None:
    causes = [cause for cause in _chain(error) if isinstance(cause, OSError)]
    if any(cause.errno in _FULL for cause in causes) or (causes and _is_full(folder)):
        return SessionError(
            f"The disk that holds {folder} is full: free some space; nothing that was finished is lost.",
            Remedy.RUN_AGAIN,
        )
    for cause in causes:
        if cause.errno in _FORBIDDEN and _lies_in(cause.filename, folder):
            return SessionError(
                f"The folder {folder} cannot be written ({cause.strerror}): make it writable or choose "
                "another one; nothing that was finished before is lost."
            )
    return None


def _chain(error: BaseException) -> Iterator[BaseException]:
    """Yield the error and what led to it: libraries wrap the system's errors in their own."""
    seen: set[int] = set()
    current: BaseException | None = error
    while current is not None and id(current) not in seen:
        seen.add(id(current))
        yield current
        current = current.__cause__ or current.__context__


def _is_full(folder: Path) -> bool:
    """Tell a full disk by its free space: numpy and film encoders fail on it without the system's number."""
    try:
        return shutil.disk_usage(folder).free < _FULL_BELOW_BYTES
    except OSError:
        return False


def _lies_in(filename: object, folder: Path) -> bool:
    if not isinstance(filename, str):
        return False
    path = Path(filename).resolve()
    home = folder.resolve()
    return path.is_relative_to(home) or home.is_relative_to(path)
