"""Presets that the user saved: files anywhere, remembered by the program."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QSettings

from core.errors import SessionError
from core.files import write_json
from core.parameters import PRESET_NAMES, Parameters, difference
from core.session import explained

_KEY = "presets/files"
_MOST = 12


def preset_names() -> list[str]:
    """Return the shipped presets and the files of the saved ones that are still there."""
    return [*PRESET_NAMES, *(path for path in _remembered() if Path(path).is_file())]


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


def _remembered() -> list[str]:
    found = QSettings().value(_KEY)
    if isinstance(found, str):  # a list of one is read as text
        return [found]
    return [str(path) for path in found] if isinstance(found, list) else []
