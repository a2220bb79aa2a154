"""Reading and writing the open formats of a session, with errors that name the file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from core.errors import Remedy, SessionError
from core.geometry import AnyArray


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file whole or not at all; text as UTF-8.

    Raises:
        OSError: the file cannot be written; what was there before is untouched.
    """
    unfinished = path.with_name(f".{path.name}.part")
    try:
        if isinstance(content, str):
            unfinished.write_text(content, encoding="utf-8")
        else:
            unfinished.write_bytes(content)
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)


def write_json(path: Path, table: dict[str, Any]) -> None:
    """Write a table as JSON for people and programs, whole or not at all; NaN and infinity are refused."""
    write_whole(path, json.dumps(table, indent=2, allow_nan=False) + "\n")


def read_json(path: Path) -> dict[str, Any]:
    """Read a table.

    Raises:
        SessionError: the file is missing, cut short or no table.
    """
    try:
        table = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise SessionError(f"{path} cannot be read ({error}).", Remedy.RUN_AGAIN) from error
    if not isinstance(table, dict):
        raise SessionError(f"{path} does not contain a JSON object.", Remedy.RUN_AGAIN)
    return table


def write_arrays(path: Path, **arrays: AnyArray) -> None:
    """Write named arrays as one compressed NPZ."""
    np.savez_compressed(path, allow_pickle=False, **arrays)


def read_arrays(path: Path) -> dict[str, AnyArray]:
    """Read named arrays.

    Raises:
        SessionError: the file is missing or damaged.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}
    except Exception as error:  # zipfile, zlib and numpy each raise their own
        raise SessionError(f"{path} cannot be read ({error}).", Remedy.RUN_AGAIN) from error
