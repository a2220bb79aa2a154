"""`session.json`: what makes a folder a session."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from core.errors import Remedy, SessionError
from core.files import read_content, reason, write_json
from core.formats import excerpt, parse_json
from core.session.record import RECORD_FILE, utc_now

FORMAT = 1
HEADER_FILE = "session.json"


@dataclass(frozen=True)
class Header:
    """Name and creation time (ISO 8601, UTC) of a session."""

    name: str
    created: str

    @classmethod
    def of_new(cls, folder: Path) -> Header:
        """Make the header of a session that starts now; it is called like its folder."""
        return cls(folder.name, utc_now())

    def save(self, folder: Path) -> None:
        """Write `session.json`, whole or not at all."""
        unfinished = folder / f".{HEADER_FILE}"
        write_json(unfinished, {"format": FORMAT, "name": self.name, "created": self.created})
        unfinished.replace(folder / HEADER_FILE)

    @classmethod
    def load(cls, folder: Path) -> Header:
        """Read `session.json`.

        Raises:
            SessionError: it is damaged or cannot be read, or a newer Poursight wrote it.
        """
        table = _read_table(folder / HEADER_FILE)
        number = table.get("format")
        if isinstance(number, int) and number > FORMAT:
            raise SessionError(
                f"The session {folder} was made by a newer Poursight (format {excerpt(number)}, "
                f"this one knows {FORMAT}); update Poursight to open it."
            )
        name, created = table.get("name"), table.get("created")
        if number != FORMAT or not isinstance(name, str) or not isinstance(created, str):
            raise _damaged(folder / HEADER_FILE, "format, name or created is missing")
        return cls(excerpt(name), excerpt(created))


def has_records(folder: Path) -> bool:
    """Whether a folder holds finished stages."""
    return any(folder.glob(f"*/{RECORD_FILE}"))


def _read_table(path: Path) -> dict[str, Any]:
    try:
        table = parse_json(read_content(path))
    except OSError as error:
        raise SessionError(f"{path} cannot be read ({reason(error)}); make it readable.") from error
    except ValueError as error:
        raise _damaged(path, reason(error)) from error
    if not isinstance(table, dict):
        raise _damaged(path, "it holds no table")
    return table


def _damaged(path: Path, reason: str) -> SessionError:
    return SessionError(
        f"{path} is damaged ({reason}); delete this one file: the stages beside it are kept and a new one is "
        "written.",
        Remedy.RUN_AGAIN,
    )
