"""The session itself: opening, locking, and writing a stage whole or not at all."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any

from core.errors import Remedy, SessionError
from core.session import swapping
from core.session.explaining import explained
from core.session.header import HEADER_FILE, Header, has_records
from core.session.locking import SessionLock
from core.session.record import StageRecord, plain


class Session:
    """A folder with one sub-folder a stage.

    Reading (`record`, `is_fresh`, `folder`) needs nothing more. Writing needs the session's lock, which
    `with Session.open(folder) as session:` holds; taking it also clears up what a killed program left behind.

    Attributes:
        path: the session's folder.
        name: what people call it.
        created: ISO 8601 time, UTC.
    """

    def __init__(self, path: Path, header: Header) -> None:
        """Use `open` or `create_or_open`."""
        self.path = path
        self.name = header.name
        self.created = header.created
        self._header = header
        self._lock = SessionLock(path)

    @classmethod
    def open(cls, folder: Path) -> Session:
        """Open a session.

        Raises:
            SessionError: the folder is no session, damaged or of a newer Poursight.
        """
        folder = folder.absolute()
        if not folder.is_dir():
            raise _no_folder(folder)
        if (folder / HEADER_FILE).exists():
            return cls(folder, Header.load(folder))
        if has_records(folder):  # somebody deleted a damaged header; the stages hold all that counts
            return cls(folder, Header.of_new(folder))
        raise SessionError(
            f"{folder} is no session (it holds no {HEADER_FILE}); give the folder of a session."
        )

    @classmethod
    def create_or_open(cls, folder: Path) -> Session:
        """Open a session, or start one in a folder that is new or empty.

        Raises:
            SessionError: the folder is a file, holds other things, or cannot be opened or written.
        """
        folder = folder.absolute()
        if folder.exists() and not folder.is_dir():
            raise _no_folder(folder)
        if not (folder / HEADER_FILE).exists() and not has_records(folder):
            _start(folder)
        return cls.open(folder)

    def __enter__(self) -> Session:
        self._lock.acquire()
        try:
            with explained(self.path):
                swapping.recover(self.path)
                if not (self.path / HEADER_FILE).exists():
                    self._header.save(self.path)
        except BaseException:
            self._lock.release()
            raise
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._lock.release()

    def folder(self, stage: str) -> Path:
        """Return the folder of a finished stage.

        Raises:
            SessionError: the stage has not been finished yet.
        """
        if self.record(stage) is None:
            sentence = f"The session {self.path} holds no finished stage '{stage}'."
            raise SessionError(sentence, Remedy.RUN_AGAIN)
        return self.path / stage

    def record(self, stage: str) -> StageRecord | None:
        """Return what a stage was made from; None when it has not been finished or its record is damaged."""
        return StageRecord.load(self.path / stage)

    def is_fresh(self, stage: str, inputs: Mapping[str, str], parameters: Mapping[str, Any]) -> bool:
        """Return whether a stage is what these inputs and parameters would give.

        Computed by comparison each time. Lost or cut files are noticed by their sizes: asking is cheap.

        Args:
            stage: its name.
            inputs: digests of the stages it is made from, by their names.
            parameters: JSON-able values, the seed among them.
        """
        record = self.record(stage)
        return (
            record is not None
            and (record.inputs, record.parameters) == (dict(inputs), plain(parameters))
            and record.is_whole(self.path / stage)
        )

    @contextmanager
    def writing(
        self,
        stage: str,
        *,
        inputs: Mapping[str, str],
        parameters: Mapping[str, Any],
        seconds: float | None = None,
    ) -> Iterator[Path]:
        """Give an empty folder to write a stage in; at the end it takes the place of the stage's old one.

        When the block raises, or the program is killed in it, the old one stays as it was.

        Args:
            stage: its name, a plain word.
            inputs: digests of the stages it is made from, by their names.
            parameters: JSON-able values, the seed among them.
            seconds: how long the stage took; None: as long as the block.

        Raises:
            SessionError: the disk is full or the folder may not be written.
        """
        if not self._lock.is_held:
            raise RuntimeError("a stage is written inside 'with session:'")
        if not stage.isidentifier():
            raise ValueError(f"'{stage}' is no plain word")
        table = plain(parameters)
        started = time.perf_counter()
        try:
            with explained(self.path):
                folder = swapping.start(self.path, stage)
                yield folder
                took = time.perf_counter() - started if seconds is None else seconds
                StageRecord.of(folder, stage, inputs, table, took).save(folder)
                swapping.commit(self.path, stage)
        except BaseException:
            swapping.abandon(self.path, stage)
            raise


def _start(folder: Path) -> None:
    try:
        with explained(folder):
            folder.mkdir(parents=True, exist_ok=True)
            # A hidden file is what an interrupted start, or a file browser, left here.
            if any(not path.name.startswith(".") for path in folder.iterdir()):
                raise SessionError(
                    f"{folder} holds other files and is no session; give a new or an empty folder."
                )
            Header.of_new(folder).save(folder)
    except OSError as error:
        raise SessionError(
            f"The folder {folder} cannot be made ({error.strerror}); choose another one."
        ) from error


def _no_folder(folder: Path) -> SessionError:
    if folder.exists():
        return SessionError(f"{folder} is a file; a session is a folder: give a new or an empty one.")
    return SessionError(f"There is no session {folder}; check the path.")
