"""What the job that renders tells on the way: each picture as soon as it is drawn."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from app.jobs.face import JobFace
from core.progress import Reporter


@dataclass(frozen=True)
class PictureDrawn:
    """A picture can be looked at before the others are done.

    Attributes:
        session: the folder of the session it belongs to.
        path: of its file, called as in the evidence; it goes when the next pictures are drawn.
    """

    session: Path
    path: Path


class PictureWatch(Reporter):
    """Passes everything on to a job's face, and tells it of the pictures that have come into a folder."""

    def __init__(self, face: JobFace, session: Path, folder: Path) -> None:
        super().__init__()
        self._face = face
        self._session = session
        self._folder = folder
        self._told: set[Path] = set()

    def progress(self, stage: str, done: float, total: float) -> None:
        """Pass it on; it comes often enough to look for pictures."""
        self._face.progress(stage, done, total)
        for path in sorted(set(self._folder.glob("*.png")) - self._told):
            self._told.add(path)
            self._face.tell(PictureDrawn(self._session, path))

    def warn(self, sentence: str) -> None:
        """Pass it on."""
        self._face.warn(sentence)

    def raise_if_cancelled(self) -> None:
        """Ask the face."""
        self._face.raise_if_cancelled()
