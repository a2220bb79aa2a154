"""Reading a cell file: its settings, or one sentence on what is wrong with it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from core.errors import InputError
from core.files import read_content, reason
from core.formats import excerpt
from core.resources import RESOURCES
from hardware.cell.settings import CellSettings

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

CELL_FOLDER = RESOURCES / "cells"
SIMULATED_CELL = CELL_FOLDER / "simulated.toml"


def read_cell(path: Path = SIMULATED_CELL) -> CellSettings:
    """Read and check a cell file; paths in it count from its folder.

    Raises:
        InputError: the file cannot be read, or something in it is missing, unknown or impossible.
    """
    try:
        table = tomllib.loads(read_content(path).decode("utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"The cell file {path} cannot be read ({reason(error)}); "
            f"{CELL_FOLDER} holds examples to start from."
        ) from error
    except (ValueError, RecursionError) as error:
        raise InputError(
            f"The cell file {path} is not valid TOML ({reason(error)}); correct it there."
        ) from error
    _resolve_recording(table, path.parent)
    try:
        return CellSettings.model_validate(table)
    except ValidationError as error:
        raise InputError(_explain(error, path)) from error


def _resolve_recording(table: dict[str, Any], folder: Path) -> None:
    camera = table.get("camera")
    if isinstance(camera, dict) and isinstance(camera.get("recording"), str):
        camera["recording"] = folder / camera["recording"]


def _explain(error: ValidationError, path: Path) -> str:
    """One sentence on the first thing wrong."""
    first = error.errors()[0]
    name = excerpt(".".join(str(part) for part in first["loc"]))
    if first["type"] == "missing":
        return f"The cell file {path} lacks '{name}'; compare it with {SIMULATED_CELL}."
    if first["type"] == "extra_forbidden":
        return f"The cell file {path} holds '{name}', which no cell has; correct its spelling or remove it."
    said = excerpt(str(first["msg"]).removeprefix("Value error, "))
    return f"In the cell file {path}, {name or 'something'} is not possible ({said}); correct it there."
