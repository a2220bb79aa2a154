"""The pictures and films of one imagination, able to save and load themselves."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from core.errors import Remedy, SessionError
from core.files import read_json, write_json, write_whole

_INDEX = "evidence.json"


@dataclass(frozen=True)
class Evidence:
    """Pictures (PNG) and films (MP4).

    Attributes:
        files: name (`drop_1_start.png` to `drop_6_end.png`, `pours.png`, `drop.mp4`, `pour.mp4`) to bytes.
        renderer: what drew them, `EGL` or `TinyRenderer`; empty when there is none.
    """

    files: dict[str, bytes]
    renderer: str

    def save(self, folder: Path) -> None:
        """Write the files and `evidence.json`, which lists them."""
        for name, content in self.files.items():
            (folder / name).write_bytes(content)
        write_json(folder / _INDEX, {"renderer": self.renderer, "files": list(self.files)})

    @classmethod
    def load(cls, folder: Path) -> Evidence:
        """Read what `save` wrote.

        Raises:
            SessionError: a file is missing or damaged.
        """
        table = read_json(folder / _INDEX)
        try:
            files = {name: (folder / name).read_bytes() for name in table["files"]}
        except OSError as error:
            raise SessionError(f"{error.filename} cannot be read.", Remedy.RUN_AGAIN) from error
        return cls(files, table["renderer"])


def show_early(folder: Path | None, name: str, content: bytes) -> None:
    """Put a picture, whole or not at all, where somebody is waiting for it before the others are done."""
    if folder is not None:
        write_whole(folder / name, content)
