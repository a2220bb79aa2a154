"""Arguments and options that several commands share, and the one place where paths and words enter."""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path
from typing import Annotated

import typer

from core.errors import InputError
from core.files import check_writable
from core.formats import excerpt, is_text

_MISSING = {errno.ENOENT, errno.ENOTDIR}
"""The commands themselves say what they miss."""
STDOUT = Path("-")


def given_text(text: str) -> str:
    """Return what was typed for people to read, perhaps nothing.

    Raises:
        InputError: it is not UTF-8, which no file could hold, or has signs that are no writing.
    """
    if not is_text(text) or not "".join(text.split()).isprintable():
        raise InputError(
            f"The text '{_shown(text)}' is not UTF-8, or has signs that cannot be shown; type it anew."
        )
    return text


def given_word(text: str) -> str:
    """Return a word that was typed: a name, an address, or a setting; the commands know which there are.

    Raises:
        InputError: it is empty, longer than a line, not UTF-8, or has signs that cannot be shown.
    """
    if not text.strip():
        raise InputError("A name or a value is empty; type one, or leave its option out.")
    if not is_text(text) or not text.isprintable():
        raise InputError(
            f"'{_shown(text)}' is not UTF-8, or has signs that cannot be shown; type it on one line."
        )
    return text


def given_path(text: str) -> Path:
    """Return a path that was typed, of a file or folder that is there or shall be made.

    Raises:
        InputError: no program could use it: it is empty, too long or not UTF-8, it leads through a folder
            that may not be entered, or to a pipe or a device.
    """
    if not text.strip():
        raise InputError("A path is empty; name a file or a folder.")
    if not is_text(text) or not text.isprintable():
        raise InputError(
            f"The path {_shown(text)} is not UTF-8, or has signs that cannot be shown; rename it."
        )
    try:
        mode = Path(text).stat().st_mode
    except OSError as error:
        if error.errno in _MISSING:
            return Path(text)
        raise InputError(
            f"The path {_shown(text)} cannot be used ({error.strerror}); name another one."
        ) from error
    if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
        raise InputError(f"{_shown(text)} is neither a file nor a folder; name one.")
    if not os.access(text, os.R_OK | (os.X_OK if stat.S_ISDIR(mode) else 0)):
        raise InputError(f"{_shown(text)} cannot be read (Permission denied); make it readable.")
    return Path(text)


def written_file(text: str) -> Path:
    """Return a path that was typed, of a file to be written; checked before the work is done.

    Raises:
        InputError: as in `given_path`, or it is a folder, or lies in none that may be written.
    """
    path = given_path(text)
    if path.is_dir():
        raise InputError(f"{_shown(text)} is a folder; name a file in it.")
    if not path.parent.is_dir():
        raise InputError(
            f"{_shown(text)} cannot be written: its folder does not exist; make it, or name a file elsewhere."
        )
    try:
        check_writable(path)
    except OSError as error:
        raise InputError(
            f"{_shown(text)} cannot be written ({error.strerror}); name a file elsewhere."
        ) from error
    return path


def written_answer(text: str) -> Path:
    """Return a file to be written, as `written_file` does, or `STDOUT`.

    Raises:
        InputError: as in `written_file`.
    """
    return STDOUT if text == str(STDOUT) else written_file(text)


def _shown(text: str) -> str:
    return excerpt(text.encode("utf-8", "backslashreplace").decode())


SessionArgument = Annotated[
    Path, typer.Argument(metavar="SESSION", help="A session's folder.", parser=given_path)
]
SessionOption = Annotated[
    Path, typer.Option("--session", metavar="DIR", help="The session's folder.", parser=given_path)
]
CellOption = Annotated[
    Path | None,
    typer.Option(
        "--cell", metavar="FILE", help="The cell's file; by default the simulated cell.", parser=given_path
    ),
]
PourCellOption = Annotated[
    Path | None,
    typer.Option(
        "--cell", metavar="FILE", help="The cell's file; by default the cell of the scan.", parser=given_path
    ),
]
PresetOption = Annotated[
    str | None,
    typer.Option(
        "--preset", metavar="P", help="default, paper, authors, or a preset file.", parser=given_word
    ),
]
SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="NAME=VALUE",
        help="Set a parameter; see 'poursight parameters'.",
        parser=given_word,
    ),
]
SeedOption = Annotated[int | None, typer.Option("--seed", help="Seed of all randomness.")]
WorkersOption = Annotated[
    int | None,
    typer.Option("--workers", min=1, max=256, help="Worker processes; by default one a processor."),
]
