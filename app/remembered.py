"""The parameters a session was last used with: nothing chosen means these again."""

from __future__ import annotations

from pathlib import Path

from core.files import read_json, write_json
from core.parameters import Parameters, difference, load_preset
from core.session import explained

PARAMETERS_FILE = "parameters.json"


def remember_parameters(session: Path, preset: str, parameters: Parameters) -> None:
    """Keep what differs from the defaults, and the preset's name, in the session's folder.

    Raises:
        SessionError: the folder cannot be written.
    """
    changes = {name: value for name, (_, value) in difference(parameters, Parameters()).items()}
    with explained(session):
        write_json(session / PARAMETERS_FILE, {"preset": preset, "parameters": changes})


def remembered_parameters(session: Path) -> tuple[str, Parameters] | None:
    """Return the preset's name and the parameters; none if the session remembers none.

    Raises:
        InputError, SessionError: the file is damaged.
    """
    path = session / PARAMETERS_FILE
    if not path.is_file():
        return None
    return str(read_json(path).get("preset", "default")), load_preset(str(path))
