"""Where sessions live unless somebody chooses another folder."""

from __future__ import annotations

import os
import re
from datetime import date
from itertools import count
from pathlib import Path

from platformdirs import user_documents_path

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
        name: as somebody typed it.
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
