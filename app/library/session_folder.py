"""A session's folder: its files, and the parameters it was last used with.

Hidden files (locks, unfinished stages) do not count.
"""

from __future__ import annotations

import hashlib
import os
import shutil
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from core.errors import InputError, SessionError
from core.files import read_json, write_json
from core.parameters import PRESET_NAMES, Parameters, apply_settings, difference, load_preset
from core.session import Session, explained
from core.session.header import HEADER_FILE, Header, has_records
from core.session.operator_choice import CHOICE_FILE
from core.session.pour_runs import EVENTS_FILE, OUTCOME_FILE, RUNS_FOLDER
from core.session.record import RECORD_FILE

REPORT_FILE = "report.html"
THUMBNAIL_FILE = ".thumbnail.png"
UNFINISHED_SCAN = "scan-in-progress"
"""The folder for views of a scan that is not finished."""
PARAMETERS_FILE = "parameters.json"
_PRESET_VALUES = "preset_parameters"


def is_session(folder: Path) -> bool:
    """Whether a folder is a session, even a damaged one."""
    try:
        return (folder / HEADER_FILE).is_file() or has_records(folder)
    except (OSError, ValueError):  # not ours to look into, or no path at all
        return False


def session_files(folder: Path) -> Iterator[os.DirEntry[str]]:
    """Yield a session's files, also those in sub-folders."""
    for entry in _visible(folder):
        if entry.is_dir(follow_symlinks=False):
            yield from session_files(Path(entry.path))
        elif entry.is_file():
            yield entry


def size_bytes(folder: Path) -> int:
    """Return what a session takes on the disk."""
    return sum(entry.stat().st_size for entry in session_files(folder))


def fingerprint(folder: Path) -> str:
    """Return a text that changes when a stage, a run, the header or the report of a session does.

    Made of times and sizes alone: 0.1 ms a session. A stage's folder gets a new time whenever it is replaced
    or a file in it is.
    """
    facts = [_fact(entry) for entry in _visible(folder)]
    runs = folder / RUNS_FOLDER
    for run in _visible(runs) if runs.is_dir() else ():
        facts += [_fact(run), _fact_of(Path(run.path) / EVENTS_FILE)]
    return hashlib.sha256("\n".join(sorted(facts)).encode("utf-8", "surrogateescape")).hexdigest()


def thumbnail_fact(folder: Path) -> str:
    """Return a text that changes when the thumbnail of a session does."""
    return _fact_of(folder / THUMBNAIL_FILE)


def newest_change_ns(folder: Path) -> int:
    """Return when a stage, a run or the operator's choice last changed, in ns since 1970; 0 without any."""
    changed = [*folder.glob(f"*/{RECORD_FILE}"), *folder.glob(CHOICE_FILE)]
    for name in (EVENTS_FILE, OUTCOME_FILE):
        changed += folder.glob(f"{RUNS_FOLDER}/*/{name}")
    return max((path.stat().st_mtime_ns for path in changed), default=0)


def _visible(folder: Path) -> list[os.DirEntry[str]]:
    with os.scandir(folder) as entries:
        return sorted((entry for entry in entries if not entry.name.startswith(".")), key=lambda e: e.name)


def _fact(entry: os.DirEntry[str]) -> str:
    return _fact_of(Path(entry.path))  # a link may lead nowhere


def _fact_of(path: Path) -> str:
    try:
        found = path.stat()
    except OSError:
        return f"{path} missing"
    return f"{path} {found.st_mtime_ns} {found.st_size}"


def rename_session(folder: Path, name: str) -> None:
    """Call a session something else; its folder stays where it is.

    Raises:
        InputError: the name is empty.
        SessionError: the folder is no session, or cannot be written.
    """
    if not name.strip():
        raise InputError("A session needs a name; type one.")
    created = Session.open(folder).created
    with explained(folder):
        Header(name.strip(), created).save(folder)


def remove_if_empty(folder: Path) -> None:
    """Remove a session that holds nothing: what was to be in it could not be made."""
    if is_session(folder) and not has_records(folder) and not (folder / UNFINISHED_SCAN).exists():
        shutil.rmtree(folder, ignore_errors=True)


def remember_parameters(session: Path, preset: str, parameters: Parameters) -> None:
    """Store what differs from the defaults, and the preset, in the session's folder.

    Of a preset in a file its values are stored, too: the file may be moved, or the session go elsewhere.

    Raises:
        SessionError: the folder cannot be written.
    """
    table: dict[str, Any] = {"preset": preset, "parameters": _changes(parameters)}
    name, base = preset_of(session, preset)
    if preset not in PRESET_NAMES and name == preset:
        table[_PRESET_VALUES] = _changes(base)
    with explained(session):
        write_json(session / PARAMETERS_FILE, table)


def preset_of(session: Path, preset: str) -> tuple[str, Parameters]:
    """Return a preset's name and values: its own, or what the session stored of a file that is gone.

    Where neither is to be had, they are those of the defaults.
    """
    with suppress(InputError):
        return preset, load_preset(preset)
    with suppress(InputError, SessionError):
        table = read_json(session / PARAMETERS_FILE)
        values = table.get(_PRESET_VALUES)
        if table.get("preset") == preset and isinstance(values, dict):
            return preset, apply_settings(Parameters(), values)
    return "default", Parameters()


def _changes(parameters: Parameters) -> dict[str, Any]:
    return {name: value for name, (_, value) in difference(parameters, Parameters()).items()}


def remembered_parameters(session: Path) -> tuple[str, Parameters] | None:
    """Return the preset's name and the parameters; none if the session remembers none.

    Raises:
        InputError, SessionError: the file is damaged.
    """
    path = session / PARAMETERS_FILE
    if not path.is_file():
        return None
    preset = read_json(path).get("preset")
    return preset if isinstance(preset, str) else "default", load_preset(str(path))
