"""A stage's record: what its files were made from, with what, and when."""

from __future__ import annotations

import json
import platform
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from datetime import datetime, timezone
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from core.errors import SessionError
from core.files import read_json, write_json
from core.session.digests import RECORD_FILE, file_sizes, folder_digest

_PACKAGES = {
    "poursight": ("poursight",),
    "numpy": ("numpy",),
    "pybullet": ("pybullet",),
    "open3d": ("open3d", "open3d-cpu"),
}


@dataclass(frozen=True)
class StageRecord:
    """What `record.json` of a stage says.

    Attributes:
        stage: the stage's name.
        inputs: digests of the stages it was made from, by their names.
        parameters: its parameters, the seed among them, as plain JSON values.
        digest: SHA-256 over the names and contents of its files.
        files: sizes of its files in bytes, by their names.
        versions: versions of the programs that made it.
        created: ISO 8601 time, UTC.
        seconds: how long the stage took.
    """

    stage: str
    inputs: dict[str, str]
    parameters: dict[str, Any]
    digest: str
    files: dict[str, int]
    versions: dict[str, str]
    created: str
    seconds: float

    @classmethod
    def of(
        cls, folder: Path, stage: str, inputs: Mapping[str, str], parameters: dict[str, Any], seconds: float
    ) -> StageRecord:
        """Make the record of the files that lie in `folder` now."""
        return cls(
            stage,
            dict(inputs),
            parameters,
            folder_digest(folder),
            file_sizes(folder),
            program_versions(),
            utc_now(),
            round(seconds, 3),
        )

    def save(self, folder: Path) -> None:
        """Write `record.json`."""
        write_json(folder / RECORD_FILE, asdict(self))

    @classmethod
    def load(cls, folder: Path) -> StageRecord | None:
        """Read `record.json`; None when it is missing or damaged: then the stage has to be run again."""
        try:
            record = cls(**read_json(folder / RECORD_FILE))
        except (SessionError, TypeError):
            return None
        tables = (record.inputs, record.parameters, record.files, record.versions)
        return record if all(isinstance(table, dict) for table in tables) else None


def plain(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Return parameters as JSON gives them back (tuples become lists), so that old and new compare.

    Raises:
        TypeError, ValueError: a value cannot be written as JSON.
    """
    table: dict[str, Any] = json.loads(json.dumps(dict(parameters), allow_nan=False))
    return table


def program_versions() -> dict[str, str]:
    """Return the versions of Python and of the packages that decide a result, without importing them."""
    found = {name: _installed_version(packages) for name, packages in _PACKAGES.items()}
    return {"python": platform.python_version()} | found


def utc_now() -> str:
    """Return the time now, ISO 8601, UTC, to the second."""
    return datetime.now(timezone.utc).isoformat(timespec="seconds")


def _installed_version(packages: tuple[str, ...]) -> str:
    for package in packages:
        try:
            return version(package)
        except PackageNotFoundError:
            continue
    return "not installed"
