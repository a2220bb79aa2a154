"""Reading and writing the open formats of a session, with errors that name the file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from core.errors import SessionError
from core.geometry import AnyArray


def write_json(path: Path, table: dict[str, Any]) -> None:
    """Write a table as JSON for people and programs, whole or not at all; NaN and infinity are refused."""
    unfinished = path.with_name(f".{path.name}.part")
    try:
        unfinished.write_text(json.dumps(table, indent=2, allow_nan=False) + "\n", encoding="utf-8")
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)


def read_json(path: Path) -> dict[str, Any]:
    """Read a table.

    Raises:
        SessionError: the file is missing, cut short or no table.
    """
    try:
        table = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise SessionError(f"{path} cannot be read ({error}); run the stage that writes it again.") from error
    if not isinstance(table, dict):
        raise SessionError(f"{path} holds no table; run the stage that writes it again.")
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
        raise SessionError(f"{path} cannot be read ({error}); run the stage that writes it again.") from error
