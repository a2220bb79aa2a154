"""Reading and writing the open formats of a session, with errors that name the file."""

from __future__ import annotations

import csv
import errno
import json
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from io import BytesIO, StringIO
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any

import numpy as np

from core.errors import InputError, Remedy, SessionError
from core.formats import MADE_BY_REPORT, check_arrays, check_table, excerpt, kind_of, parse_json
from core.geometry import AnyArray


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file whole or not at all; text as UTF-8.

    Raises:
        OSError: the file cannot be written; what was there before is untouched.
    """
    unfinished = _unfinished(path)
    try:
        if isinstance(content, str):
            unfinished.write_text(content, encoding="utf-8")
        else:
            unfinished.write_bytes(content)
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)


def check_writable(path: Path) -> None:
    """Find out whether `write_whole` can write a file, before there is something to write.

    Raises:
        OSError: its folder takes no file, or none of such a name.
    """
    with suppress(FileNotFoundError):
        _unfinished(path).lstat()  # its name may be too long
    TemporaryFile(dir=path.parent).close()  # /proc, for one, says of itself that it can be written


def _unfinished(path: Path) -> Path:
    return path.with_name(f".{path.name}.part")


def make_folder(folder: Path) -> None:
    """Make a folder and those above it, unless it is there.

    Raises:
        InputError: there is a file of that name, or no folder can be made there.
        OSError: the system refuses.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError) as error:
        raise InputError(f"{folder} cannot be made a folder, for there is a file; choose another.") from error
    except FileNotFoundError as error:  # /proc, for one
        raise InputError(f"{folder} cannot be made: no folder can be made there; choose another.") from error


def write_json(path: Path, table: dict[str, Any]) -> None:
    """Write a table as JSON for people and programs, whole or not at all; NaN and infinity are refused."""
    write_whole(path, json.dumps(table, indent=2, allow_nan=False) + "\n")


def read_content(path: Path) -> bytes:
    """Read a whole file.

    Raises:
        OSError: it cannot be read, or is a folder, a pipe or a device, on which one would wait forever.
    """
    check_regular(path)
    return path.read_bytes()


def check_regular(path: Path) -> None:
    """Refuse what cannot be read to its end.

    Raises:
        OSError: it is not there, or a folder, a pipe or a device.
    """
    if not stat.S_ISREG(path.stat().st_mode):
        raise OSError(errno.EINVAL, "it is no regular file", str(path))


def reason(error: BaseException) -> str:
    """Return why something could not be read, fit for brackets in a sentence: the file's content is cut."""
    said = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return excerpt(said) or type(error).__name__


def is_file(path: Path) -> bool:
    """Whether a file is there; no, too, if its path is too long or cannot be followed."""
    try:
        return path.is_file()
    except OSError:
        return False


def read_json(path: Path, kind: type | None = None) -> dict[str, Any]:
    """Read a table; of a session's file only what this version knows, once it is what it must be.

    Args:
        path: the file.
        kind: what it must hold; by default what `core.formats` says of a file of that name in that folder.

    Raises:
        SessionError: the file is missing, cut short, no table, or not what it must be.
    """
    kind = kind or kind_of(path)
    remedy = _remedy(path)
    try:
        content = read_content(path)
        table = parse_json(content)
    except (OSError, ValueError) as error:
        raise SessionError(f"{path} cannot be read ({reason(error)}).", remedy) from error
    if not isinstance(table, dict):
        raise SessionError(f"{path} does not contain a JSON object.", remedy)
    if kind is None:
        return table
    try:
        known: dict[str, Any] = check_table(content, kind)
    except ValueError as error:
        raise SessionError(f"{path} is damaged ({reason(error)}).", remedy) from error
    return known


def read_csv(path: Path) -> tuple[tuple[str, ...], list[dict[str, str | None]]]:
    """Return the columns and the rows of a CSV in UTF-8.

    Raises:
        OSError: the file cannot be read.
        ValueError: it is no such text.
    """
    text = read_content(path).decode("utf-8-sig")
    try:
        reader = csv.DictReader(StringIO(text, newline=""))
        rows = list(reader)
    except csv.Error as error:
        raise ValueError(str(error)) from error
    columns = tuple(reader.fieldnames or ())
    # What stands behind the last column has no name.
    return columns, [{column: row.get(column) for column in columns} for row in rows]


def write_arrays(path: Path, **arrays: AnyArray) -> None:
    """Write named arrays as one compressed NPZ."""
    np.savez_compressed(path, allow_pickle=False, **arrays)


def read_arrays(path: Path) -> dict[str, AnyArray]:
    """Read named arrays; those of a session's file are what `core.formats` says.

    Raises:
        SessionError: the file is missing or damaged.
    """
    try:
        with np.load(BytesIO(read_content(path)), allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
    except Exception as error:  # zipfile, zlib and numpy each raise their own
        raise SessionError(f"{path} cannot be read ({reason(error)}).", _remedy(path)) from error
    try:
        check_arrays(path, arrays)
    except ValueError as error:
        raise SessionError(f"{path} is damaged ({reason(error)}).", _remedy(path)) from error
    return arrays


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Turn what files raise that are whole but do not fit together into a sentence that names their place.

    Raises:
        SessionError: the block raised what damaged content does.
    """
    try:
        yield
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        said = reason(error) if isinstance(error, ValueError) else excerpt(repr(error))
        raise SessionError(f"{path} is damaged ({said}).", _remedy(path)) from error


def _remedy(path: Path) -> Remedy:
    """Return what makes a file anew: all stages but the motions are made by a report."""
    names = {path.name, path.parent.name}
    if "motion" in names:
        return Remedy.JUDGE_MOTIONS
    return Remedy.RUN_STAGES if names & MADE_BY_REPORT else Remedy.RUN_AGAIN
