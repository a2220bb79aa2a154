"""A stage's record: what its files were made from, with what, and when."""

from __future__ import annotations

import hashlib
import json
import os
import platform
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from datetime import datetime, timezone
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from core.errors import SessionError
from core.files import check_regular, read_json, write_json
from core.formats.tables import Record

_PACKAGES = {
    "poursight": ("poursight",),
    "numpy": ("numpy",),
    "pybullet": ("pybullet",),
    "mujoco-core": ("mujoco-core",),
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
            return cls(**read_json(folder / RECORD_FILE, Record))
        except SessionError:
            return None

    def is_unchanged(self, folder: Path) -> bool:
        """Whether its files hold what was written: reads them all; files that came later do not count."""
        try:
            return _digest(folder, self.files) == self.digest
        except OSError:
            return False

    def is_whole(self, folder: Path) -> bool:
        """Whether all its files are there, as long as they were: lost and cut ones are noticed cheaply."""
        try:
            return all((folder / name).stat().st_size == size for name, size in self.files.items())
        except OSError:
            return False


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


@cache  # reading what is installed takes 3 ms a stage
def _installed_version(packages: tuple[str, ...]) -> str:
    for package in packages:
        try:
            return version(package)
        except PackageNotFoundError:
            continue
    return "not installed"


RECORD_FILE = "record.json"
_CHUNK_BYTES = 1 << 20


def file_sizes(folder: Path) -> dict[str, int]:
    """Return `{relative name: bytes}` of a stage's own files, sorted; the record is not one of them."""
    files = {path.relative_to(folder).as_posix(): path for path in folder.rglob("*") if path.is_file()}
    return {name: files[name].stat().st_size for name in sorted(files) if name != RECORD_FILE}


def folder_digest(folder: Path) -> str:
    """Return the SHA-256, in hex, over the names and contents of a stage's own files.

    Times, owners and the order of creation do not count.
    """
    return _digest(folder, file_sizes(folder))


def _digest(folder: Path, names: Iterable[str]) -> str:
    whole = hashlib.sha256()
    for name in sorted(names):
        # Both parts have a fixed length, so no two sets of files run together to the same bytes.
        whole.update(hashlib.sha256(os.fsencode(name)).digest())
        whole.update(_file_digest(folder / name))
    return whole.hexdigest()


def _file_digest(path: Path) -> bytes:
    check_regular(path)
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while chunk := file.read(_CHUNK_BYTES):
            digest.update(chunk)
    return digest.digest()
