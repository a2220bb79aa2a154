"""Deleting a session so that it can be had back."""

from __future__ import annotations

from pathlib import Path

from app.library.files import is_session
from core.errors import SessionError
from core.session.locking import SessionLock


def send_to_trash(path: Path) -> None:
    """Move a session's folder into the desktop's trash.

    Raises:
        SessionError: the folder is no session, a program has it open, or there is no trash; then it stays.
    """
    folder = path.absolute()
    if not is_session(folder):
        raise SessionError(f"{folder} is no session; only sessions are deleted here.")
    lock = SessionLock(folder)
    lock.acquire()
    try:
        _move(folder)
    finally:
        lock.release()


def _move(folder: Path) -> None:
    from send2trash import send2trash

    try:
        send2trash(folder)
    except OSError as error:
        reason = error.strerror or str(error) or "there is no trash on its disk"
        raise SessionError(
            f"The session {folder} cannot be moved to the trash ({reason}); nothing was deleted: "
            "delete the folder in a file manager."
        ) from error
