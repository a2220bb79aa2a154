"""Where presets lie that people save under a name: the user's config folder."""

from __future__ import annotations

from pathlib import Path

from platformdirs import user_config_path

from app.library.places import slug
from core.errors import InputError
from core.parameters import PRESET_NAMES
from core.session import explained

APPLICATION = "poursight"


def presets_folder() -> Path:
    """Return the folder of named presets; it need not exist yet."""
    return user_config_path(APPLICATION, appauthor=False) / "presets"


def preset_file(name: str) -> Path:
    """Return the file for a preset of that name; its folder is made, the file is not.

    Raises:
        InputError: the name is empty or one of the shipped presets'.
        SessionError: the folder cannot be made.
    """
    stem = slug(name) if name.strip() else ""
    if not stem:
        raise InputError("A preset needs a name; type one.")
    if stem in PRESET_NAMES:
        raise InputError(f"'{stem}' is the name of a preset that the program ships; choose another name.")
    folder = presets_folder()
    with explained(folder):
        folder.mkdir(parents=True, exist_ok=True)
    return folder / f"{stem}.json"


def named_preset(name: str) -> str:
    """Return what `load_preset` takes for a name: the user's preset of that name, or the name as it is."""
    if name in PRESET_NAMES or not name.strip():
        return name
    path = presets_folder() / f"{slug(name)}.json"
    return str(path) if path.is_file() and not Path(name).is_file() else name
