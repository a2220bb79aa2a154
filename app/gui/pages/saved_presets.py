"""Presets that the user saved: files anywhere, remembered by the program."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QSettings

from app.library.places import presets_folder
from core.errors import PoursightError, SessionError
from core.files import read_json, write_json
from core.parameters import PRESET_NAMES, Parameters, difference
from core.session import explained

_KEY = "presets/files"
_MOST = 12


def preset_names() -> list[str]:
    """Return the shipped presets, those saved under a name, and remembered files that are still there."""
    named = [str(path) for path in sorted(presets_folder().glob("*.json"))]
    others = [path for path in _remembered() if path not in named and Path(path).is_file()]
    return [*PRESET_NAMES, *named, *others]


def preset_tips(names: list[str]) -> dict[str, str]:
    """Return the descriptions in preset files, such as what they were fitted to."""
    return {name: f"{said}\n{name}" for name in names if (said := _description(name))}


def save_preset(path: Path, parameters: Parameters) -> None:
    """Write parameters as a preset, as `--preset` takes it, and remember the file.

    Raises:
        SessionError: the file cannot be written.
    """
    changes = {name: value for name, (_, value) in difference(parameters, Parameters()).items()}
    try:
        with explained(path.parent):
            write_json(path, {"description": f"Saved as {path.stem}.", "parameters": changes})
    except OSError as error:
        raise SessionError(
            f"The preset {path} cannot be written ({error.strerror}); choose another folder."
        ) from error
    remember_preset(path)


def remember_preset(path: Path) -> None:
    """Offer a preset's file from now on."""
    others = [known for known in _remembered() if known != str(path)]
    QSettings().setValue(_KEY, [str(path), *others][:_MOST])


def _description(name: str) -> str:
    if not name.endswith(".json"):
        return ""
    try:
        return str(read_json(Path(name)).get("description", ""))
    except PoursightError:
        return ""


def _remembered() -> list[str]:
    found = QSettings().value(_KEY)
    if isinstance(found, str):  # a list of one is read as text
        return [found]
    return [str(path) for path in found] if isinstance(found, list) else []
