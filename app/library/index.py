"""The library: which sessions there are, summed up once and again when they change; and deleting one."""

from __future__ import annotations

import errno
import threading
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from app.library.session_folder import fingerprint, is_session, thumbnail_fact
from app.library.summary import SessionSummary, summarize
from core.errors import SessionError
from core.files import read_content
from core.formats import is_text
from core.session import explained
from core.session.locking import SessionLock

INDEX_FILE = ".library-index.json"
"""In the first root; it saves time and can be deleted."""
REMEMBERED_FILE = ".remembered-sessions.json"
"""In the first root: the folders of sessions elsewhere."""

_FORMAT = 1
"""Of the summaries in the index; after a change all sessions are read again."""


@dataclass(frozen=True)
class _Entry:
    """A session's summary and what the session looked like then."""

    fingerprint: str
    summary: SessionSummary


_Index = dict[str, _Entry]
_INDEX = TypeAdapter(_Index)
_PATHS = TypeAdapter(list[Path])


class Library:
    """The sessions in some folders, and those elsewhere that were opened.

    Every method may be called in any thread; `refresh` not in the window's: it reads the disk.
    """

    def __init__(self, roots: Sequence[Path]) -> None:
        """Look for sessions right in `roots`; the first one also holds the library's own two files."""
        self._roots = tuple(root.absolute() for root in roots)
        self._home = self._roots[0]
        self._entries: _Index | None = None
        self._lock = threading.Lock()

    def refresh(self) -> tuple[SessionSummary, ...]:
        """Return the sessions there are now, the newest first; only what changed is read."""
        with self._lock:
            before = self._read_index() if self._entries is None else self._entries
            found = [entry for folder in self._folders() if (entry := _entry(folder, before)) is not None]
            self._entries = {str(entry.summary.path): entry for entry in found}
            if self._entries != before:
                self._write_index()
            return _newest_first(self._entries)

    def search(self, text: str) -> tuple[SessionSummary, ...]:
        """Return those sessions of the last `refresh` that hold every word of `text`, the newest first.

        Looked for, in upper or lower case, in name, source, verdict, outcome and date ("2026-11-20" or
        "November").
        """
        words = text.casefold().split()
        with self._lock:
            summaries = _newest_first(self._entries or {})
        return tuple(summary for summary in summaries if all(word in _searchable(summary) for word in words))

    def remember(self, path: Path) -> None:
        """Add a session that lies elsewhere to the library, if it is not there already.

        Raises:
            SessionError: the folder is no session, or the library cannot be written.
        """
        folder = path.absolute()
        if not is_session(folder):
            raise SessionError(f"{folder} is no session; give the folder of a session.")
        with self._lock:
            remembered = self._read_remembered()
            if folder.parent not in self._roots and folder not in remembered and is_text(str(folder)):
                self._write_remembered([*remembered, folder])

    def forget(self, path: Path) -> None:
        """Remove a session that lies elsewhere from the library; nothing is deleted.

        Raises:
            SessionError: the library cannot be written.
        """
        with self._lock:
            remembered = self._read_remembered()
            if path.absolute() in remembered:
                self._write_remembered([folder for folder in remembered if folder != path.absolute()])

    def _folders(self) -> list[Path]:
        """Return the sessions' folders, each once; what vanished elsewhere is forgotten."""
        inside = [folder for root in self._roots for folder in _children(root) if is_session(folder)]
        remembered = self._read_remembered()
        # A whole folder that is missing may be a disk that is not plugged in.
        kept = [folder for folder in remembered if _exists(folder) or not _exists(folder.parent)]
        if kept != remembered:
            with suppress(SessionError):
                self._write_remembered(kept)
        return list(dict.fromkeys([*inside, *(folder for folder in kept if is_session(folder))]))

    def _read_index(self) -> _Index:
        try:
            return _INDEX.validate_json(read_content(self._home / INDEX_FILE))
        except (OSError, ValidationError):  # missing, damaged or of another version: it is rebuilt
            return {}

    def _write_index(self) -> None:
        # A path that is not UTF-8 cannot be written: such a session is read again each time.
        known = {path: entry for path, entry in (self._entries or {}).items() if is_text(path)}
        with suppress(OSError, SessionError):  # then the next start takes longer
            self._write(INDEX_FILE, _INDEX.dump_json(known))

    def _read_remembered(self) -> list[Path]:
        try:
            return _PATHS.validate_json(read_content(self._home / REMEMBERED_FILE))
        except (OSError, ValidationError):
            return []

    def _write_remembered(self, folders: list[Path]) -> None:
        try:
            self._write(REMEMBERED_FILE, _PATHS.dump_json(folders, indent=2))
        except OSError as error:
            raise SessionError(
                f"The library in {self._home} cannot be written ({error.strerror}); make it writable."
            ) from error

    def _write(self, name: str, content: bytes) -> None:
        unfinished = self._home / f"{name}.{threading.get_native_id()}.part"
        with explained(self._home):
            self._home.mkdir(parents=True, exist_ok=True)
            try:
                unfinished.write_bytes(content)
                unfinished.replace(self._home / name)
            finally:
                unfinished.unlink(missing_ok=True)


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
        _move_to_trash(folder)
    finally:
        lock.release()


def _entry(folder: Path, before: _Index) -> _Entry | None:
    """Return a session's summary, the one from before if nothing changed; none if it vanished meanwhile."""
    try:
        now = f"{_FORMAT} {fingerprint(folder)} {thumbnail_fact(folder)}"
    except FileNotFoundError:
        return None
    except OSError:
        return _Entry("", summarize(folder))
    known = before.get(str(folder))
    if known is not None and known.fingerprint == now and not known.summary.problem:
        return known
    return _Entry(now, summarize(folder))


def _children(root: Path) -> list[Path]:
    try:
        return [path for path in root.iterdir() if not path.name.startswith(".") and path.is_dir()]
    except OSError:  # not there yet, or not ours to read: then it holds no sessions
        return []


def _exists(folder: Path) -> bool:
    """Whether it is there; yes, too, if that cannot be known."""
    try:
        return folder.exists()
    except (OSError, ValueError) as error:
        return getattr(error, "errno", None) == errno.EACCES


def _newest_first(entries: _Index) -> tuple[SessionSummary, ...]:
    summaries = (entry.summary for entry in entries.values())
    return tuple(sorted(summaries, key=lambda summary: (summary.created, summary.name), reverse=True))


def _searchable(summary: SessionSummary) -> str:
    made = summary.created_here
    date = "" if made is None else f"{made:%Y-%m-%d %d %B %Y}"
    words = (summary.name, summary.source, summary.verdict_words, summary.outcome, date)
    return " ".join(words).casefold()


def _move_to_trash(folder: Path) -> None:
    from send2trash import send2trash

    try:
        send2trash(folder)
    except OSError as error:
        reason = error.strerror or str(error) or "there is no trash on its disk"
        raise SessionError(
            f"The session {folder} cannot be moved to the trash ({reason}); nothing was deleted: "
            "delete the folder in a file manager."
        ) from error
