"""The library as the page needs it: read, searched and given pictures in the background."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from app.gui.desk.background import Background
from app.library.index import Library
from app.library.places import sessions_folder
from app.library.summary import SessionSummary
from app.library.thumbnail import make_thumbnail
from core.errors import SessionError


@dataclass(frozen=True)
class Found:
    """What a search found.

    Attributes:
        sessions: the newest first.
        n_all: how many sessions there are at all.
        text: that was looked for.
    """

    sessions: tuple[SessionSummary, ...]
    n_all: int
    text: str


class Shelf(QObject):
    """Keeps the sessions that were found, and has pictures made of those that lack one.

    Signals: `found` with a `Found`; `pictured` with a session's folder and its new picture.

    Attributes:
        root: the folder that holds the sessions.
    """

    found = Signal(object)
    pictured = Signal(object, object)

    def __init__(self, background: Background, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.root = sessions_folder()
        self._background = background
        self._library = Library((self.root,))
        self._text = ""
        self._sessions: tuple[SessionSummary, ...] = ()
        self._tried: set[SessionSummary] = set()
        self._is_drawing = False
        self._is_paused = True

    def refresh(self) -> None:
        """Look what sessions there are now; pictures are made from then on."""
        self._is_paused = False
        self._background.run("history", partial(_look, self._library, self._text, True), self._take)

    def search(self, text: str) -> None:
        """Show only sessions that hold every word of `text`."""
        self._text = text
        self._background.run("history", partial(_look, self._library, text, False), self._take)

    def pause(self) -> None:
        """Make no more pictures until the next `refresh`."""
        self._is_paused = True

    def remember(self, folder: Path) -> None:
        """Keep a session that lies elsewhere."""
        self._background.run("history remember", partial(_remember, self._library, folder), _nothing)

    def forget(self, folder: Path) -> None:
        """Leave out a session that lies elsewhere, and look again."""
        self._background.run(
            "history forget", partial(_forget, self._library, folder), lambda _: self.refresh()
        )

    def _take(self, found: Found) -> None:
        self._sessions = found.sessions
        self.found.emit(found)
        self._draw_next()

    def _draw_next(self) -> None:
        if self._is_drawing or self._is_paused:
            return
        lacking = (s for s in self._sessions if _lacks_picture(s) and s not in self._tried)
        session = next(lacking, None)
        if session is None:
            return
        self._tried.add(session)
        self._is_drawing = True
        draw = partial(make_thumbnail, session.path)
        self._background.run("history picture", draw, partial(self._keep, session.path), self._pass_over)

    def _keep(self, folder: Path, picture: Path | None) -> None:
        self._is_drawing = False
        if picture is not None:
            self.pictured.emit(folder, picture)
        self._draw_next()

    def _pass_over(self, _error: object) -> None:
        """A session whose picture cannot be made is shown without one."""
        self._is_drawing = False
        self._draw_next()


def _look(library: Library, text: str, is_anew: bool) -> Found:
    everything = library.refresh() if is_anew else library.search("")
    return Found(library.search(text), len(everything), text)


def _remember(library: Library, folder: Path) -> None:
    with suppress(SessionError):  # a library that cannot be written still shows what lies in it
        library.remember(folder)


def _forget(library: Library, folder: Path) -> None:
    with suppress(SessionError):
        library.forget(folder)


def _nothing(_result: object) -> None:
    pass


def _lacks_picture(session: SessionSummary) -> bool:
    has_source = "scan" in session.stages or "mesh" in session.stages
    return has_source and session.thumbnail is None and not session.problem
