"""A session that came as a ZIP file, opened again. The file may be from anybody, so it is not trusted."""

from __future__ import annotations

import shutil
import stat
import time
import zlib
from collections.abc import Sequence
from contextlib import suppress
from os import utime
from pathlib import Path, PurePosixPath
from tempfile import mkdtemp
from zipfile import BadZipFile, ZipFile, ZipInfo

from app.library.places import free_folder
from core.errors import InputError
from core.progress import Reporter
from core.session import Session, explained
from core.session.header import HEADER_FILE


def import_zip(archive: Path, root: Path, reporter: Reporter) -> Path:
    """Unpack a session that `export_zip` packed into a new folder, and return it.

    Args:
        archive: the ZIP file.
        root: where to put the session; its folder keeps its name, with a number behind it if that is taken.
        reporter: told how far it is.

    Raises:
        InputError: the file is no ZIP file, is damaged, or holds something else than one session.
        SessionError: the session in it cannot be opened, or the disk is full.
    """
    try:
        with ZipFile(archive) as opened:
            members, top = _members(opened, archive)
            _check_room(members, root, archive)
            return _unpack(opened, members, top, root, reporter)
    except (BadZipFile, EOFError, NotImplementedError, RuntimeError, zlib.error) as error:
        raise InputError(f"{archive} is no ZIP file that can be read ({error}); export it again.") from error
    except OSError as error:
        raise InputError(f"{archive} cannot be unpacked into {root} ({error.strerror}).") from error


def _members(archive: ZipFile, path: Path) -> tuple[list[ZipInfo], str]:
    """Return the files to unpack and the one folder that all of them are in."""
    members = [member for member in archive.infolist() if not member.is_dir()]
    strange = [member.filename for member in members if not _is_plain(member)]
    if strange:
        raise InputError(f"{path} holds '{strange[0]}', which no session does; it is not unpacked.")
    names = {member.filename for member in members}
    tops = {name.partition("/")[0] for name in names}
    top = tops.pop() if len(tops) == 1 else "."
    if top.startswith(".") or f"{top}/{HEADER_FILE}" not in names or len(names) != len(members):
        raise InputError(f"{path} does not hold one session; give a file that Poursight exported.")
    return members, top


def _is_plain(member: ZipInfo) -> bool:
    """Whether a file lies inside of the archive's folder and is a file at all, not a link."""
    name = PurePosixPath(member.filename)
    mode = member.external_attr >> 16
    return (
        not name.is_absolute()
        and ".." not in name.parts
        and not any(sign in member.filename for sign in "\\:\0")
        and (stat.S_IFMT(mode) in (0, stat.S_IFREG))
    )


def _check_room(members: Sequence[ZipInfo], root: Path, archive: Path) -> None:
    root.mkdir(parents=True, exist_ok=True)
    needed, free = sum(member.file_size for member in members), shutil.disk_usage(root).free
    if needed > free:
        raise InputError(
            f"{archive} needs {needed / 1e6:.0f} MB, but the disk of {root} has {free / 1e6:.0f} MB left; "
            "free some space."
        )


def _unpack(archive: ZipFile, members: Sequence[ZipInfo], top: str, root: Path, reporter: Reporter) -> Path:
    unfinished = Path(mkdtemp(prefix=".importing-", dir=root))
    try:
        with explained(root):
            for number, member in enumerate(members, 1):
                reporter.raise_if_cancelled()
                unpacked = Path(archive.extract(member, unfinished))
                _keep_time(unpacked, member)
                reporter.progress("unpack", number, len(members))
            Session.open(unfinished / top)
            return (unfinished / top).rename(free_folder(root, top))
    finally:
        shutil.rmtree(unfinished, ignore_errors=True)


def _keep_time(path: Path, member: ZipInfo) -> None:
    """Give a file its old time: a report must not look older than what it tells."""
    with suppress(OSError, OverflowError, ValueError):
        seconds = time.mktime((*member.date_time, 0, 0, -1))
        utime(path, (seconds, seconds))
