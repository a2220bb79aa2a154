"""Where sessions and saved presets live."""

from __future__ import annotations

import os
import re
from datetime import date
from itertools import count
from pathlib import Path

from platformdirs import user_cache_path, user_config_path, user_documents_path

from core.errors import InputError
from core.files import is_file
from core.parameters import PRESET_NAMES
from core.session import explained

SESSIONS_VARIABLE = "POURSIGHT_SESSIONS"
"""The environment variable that names another folder."""

_LONGEST_SLUG = 60


def sessions_folder() -> Path:
    """Return the folder that holds the sessions; it need not exist yet."""
    chosen = os.environ.get(SESSIONS_VARIABLE)
    return Path(chosen).absolute() if chosen else user_documents_path() / "Poursight" / "sessions"


def new_session_folder(name: str, root: Path | None = None) -> Path:
    """Return the folder for a new session: today's date and the name; it does not exist and is not made.

    Args:
        name: as it was typed.
        root: the folder to be in; by default `sessions_folder()`.
    """
    return free_folder(root or sessions_folder(), f"{date.today().isoformat()}-{slug(name)}")


def free_folder(root: Path, name: str) -> Path:
    """Return a path in `root` called `name`, with a number behind it if that exists already."""
    for number in count(1):
        folder = root / (name if number == 1 else f"{name}-{number}")
        if not os.path.lexists(folder):
            return folder
    raise AssertionError("count never ends")


def slug(name: str) -> str:
    """Return a name fit for a folder on any system: letters, digits and single hyphens."""
    words = re.sub(r"[\W_]+", "-", name.casefold()).strip("-")
    return words[:_LONGEST_SLUG].strip("-") or "session"


APPLICATION = "poursight"


def cup_runs_folder() -> Path:
    """Return the folder of runs of the cup that sessions share; it need not exist, and may be removed."""
    return user_cache_path(APPLICATION, appauthor=False) / "cup-runs"


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
    return str(path) if path.is_file() and not is_file(Path(name)) else name
