"""Presets: `default` is what the fields say; every other one is a file of differences from it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from core.errors import InputError
from core.parameters.model import Parameters
from core.parameters.settings import apply_settings, nearest
from core.resources import RESOURCES

PRESET_FOLDER = RESOURCES / "presets"
PRESET_NAMES = ("default", *sorted(path.stem for path in PRESET_FOLDER.glob("*.json")))


def load_preset(name_or_file: str) -> Parameters:
    """Return a shipped preset by its name, or one saved in a JSON file of `{"parameters": {name: value}}`.

    Raises:
        InputError: there is no such preset, or its file cannot be used.
    """
    if name_or_file == "default":
        return Parameters()
    if name_or_file in PRESET_NAMES:
        return apply_settings(Parameters(), _read(PRESET_FOLDER / f"{name_or_file}.json"))
    if Path(name_or_file).is_file():
        return apply_settings(Parameters(), _read(Path(name_or_file)))
    raise InputError(
        f"There is no preset '{name_or_file}'; did you mean '{nearest(name_or_file, PRESET_NAMES)}'? "
        f"Known are {', '.join(PRESET_NAMES)}, or give a preset file."
    )


def _read(path: Path) -> dict[str, Any]:
    try:
        settings = json.loads(path.read_text(encoding="utf-8"))["parameters"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(
            f"The preset file {path} cannot be read ({error!r}); it must be JSON with a table 'parameters'."
        ) from error
    if not isinstance(settings, dict):
        raise InputError(f"In the preset file {path}, 'parameters' must be a table of names and values.")
    return settings
