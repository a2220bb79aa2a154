"""A page that shows what the open session holds, read in the background."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, Generic, TypeVar, cast

from typing_extensions import override

from app.gui.desk.desk import Desk
from app.gui.pages.page import Page
from app.gui.remedies import worded
from core.errors import PoursightError

Key = TypeVar("Key")
Content = TypeVar("Content")
Part = TypeVar("Part")
PartKey = TypeVar("PartKey")

_CONTENT = "content"


class BackgroundPage(Page, Generic[Key, Content]):
    """Reads its content in a thread and shows it when it is there.

    A subclass says which content it needs (`content_key`), shows it (`show_content`), and enables what can be
    done (`update_actions`). Content is read once for each key; what arrives for a key that is no longer
    needed is dropped, and the content of another session disappears at once.

    Attributes:
        content: what was read; none before that, and after a failure.
        failure: why it could not be read; empty if it could.
        folder: of the session that is shown; none if no session is open.
    """

    def __init__(self, desk: Desk, read: Callable[[Key], Content]) -> None:
        """`read` is called in a thread and must not touch widgets."""
        super().__init__(desk)
        self.content: Content | None = None
        self.failure = ""
        self.folder: Path | None = None
        self._read_content = read
        self._part_keys: dict[str, object] = {}
        for signal in (desk.jobs.started, desk.jobs.finished, desk.jobs.failed):
            signal.connect(lambda *_: self._outdate_actions())

    @property
    def shown_key(self) -> Key | None:
        """What `content` was read for, or is being read for."""
        return cast("Key | None", self._part_keys.get(_CONTENT))

    def content_key(self) -> Key | None:
        """Return what has to be read now, found without reading files; none if there is nothing to show.

        For a key that equals the one before nothing is read again. A key compared by identity
        (`dataclass(eq=False)`) is read at every refresh.
        """
        raise NotImplementedError

    def show_content(self, former: Content | None) -> None:
        """Show `content` or `failure`; `former` is what the page showed of the same session until now."""

    def update_actions(self) -> None:
        """Enable what can be done now; called after each refresh, and as jobs begin and end."""

    def _outdate_actions(self) -> None:
        """A hidden page is brought up to date when it is shown: seven at once would be felt as a stall."""
        if self.isVisible():
            self.update_actions()
        else:
            self._is_outdated = True

    @override
    def refresh(self) -> None:
        folder = self.desk.workspace.folder
        if folder != self.folder:
            self.folder = folder
            self.forget()
        key = self.content_key()
        if key is None and (self.content is not None or self.failure):
            self._take_content(None)
        self.load(_CONTENT, key, self._read_content, self._take_content, self._take_failure)
        self.update_actions()

    def forget(self) -> None:
        """Show nothing: the session was closed, or another one was opened."""
        self._part_keys.pop(_CONTENT, None)
        self.content = None
        self._take_content(None)

    def load(
        self,
        part: str,
        key: PartKey | None,
        read: Callable[[PartKey], Part],
        show: Callable[[Part], None],
        fail: Callable[[PoursightError], None] | None = None,
    ) -> None:
        """Read a part of the page in the background, unless it was read for this key.

        Args:
            part: its name, unique within the page.
            key: what is to be read; none: nothing, and what is under way is dropped.
            read: called with the key in a thread; must not touch widgets.
            show: called with what was read, unless another key was asked for meanwhile.
            fail: called with what went wrong; without it the message bar shows it.
        """
        if key == self._part_keys.get(part):
            return
        self._part_keys[part] = key
        if key is None:
            return

        def if_still_needed(then: Callable[[Any], None], outcome: Any) -> None:
            if self._part_keys.get(part) is key:
                then(outcome)

        self.desk.background.run(
            f"{self.KEY}.{part}",
            partial(read, key),
            partial(if_still_needed, show),
            partial(if_still_needed, fail or self.report),
        )

    def report(self, error: PoursightError) -> None:
        """Show an error in the message bar."""
        self.desk.message.emit(worded(error))

    def _take_content(self, content: Content | None) -> None:
        former, self.content, self.failure = self.content, content, ""
        self.show_content(former)

    def _take_failure(self, error: PoursightError) -> None:
        former, self.content, self.failure = self.content, None, worded(error)
        self.show_content(former)
