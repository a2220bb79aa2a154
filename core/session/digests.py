"""Digests: what a stage's files hold, in one line of text."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

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
    whole = hashlib.sha256()
    for name in file_sizes(folder):
        # Both parts have a fixed length, so no two sets of files run together to the same bytes.
        whole.update(hashlib.sha256(os.fsencode(name)).digest())
        whole.update(_file_digest(folder / name))
    return whole.hexdigest()


def _file_digest(path: Path) -> bytes:
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while chunk := file.read(_CHUNK_BYTES):
            digest.update(chunk)
    return digest.digest()
