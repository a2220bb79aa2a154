"""The Imagination page: the drop replayed, the verdict with its reason, and the parameters behind it."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from PySide6.QtWidgets import QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.desk.desk import Desk
from app.gui.desk.jobs import RunningJob
from app.gui.pages.imagination.loading import DropKey, ShownDrop, key_of, load
from app.gui.pages.imagination.pictures_part import PicturesPart
from app.gui.pages.imagination.replay_part import DropReplay
from app.gui.pages.imagination.side_part import VerdictSide
from app.gui.pages.page import Page, SplitView
from app.jobs.render_news import PictureDrawn
from app.jobs.session_work import SessionWork
from core.errors import PoursightError


class ImaginationPage(Page):
    """Shows what was imagined, starts imagining and rendering."""

    KEY = "imagination"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self._key: DropKey | None = None
        self._drop: ShownDrop | None = None
        self._drawn: list[Path] | None = None
        self._failure = ""
        self._render_title = self.tr("Render pictures")
        self.replay = DropReplay()
        self.pictures = PicturesPart()
        self.side = VerdictSide(desk)
        left = QWidget()
        column = QVBoxLayout(left)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.replay, 1)
        column.addWidget(self.pictures)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(SplitView(left, self.side))
        self._connect()
        self._show()

    def _connect(self) -> None:
        self.side.primary.clicked.connect(self.imagine)
        self.side.empty_wanted.connect(lambda: self.desk.page_wanted.emit("scan"))
        self.pictures.render_wanted.connect(self.render_pictures)
        jobs = self.desk.jobs
        jobs.news.connect(self._hear)
        jobs.started.connect(self._begin)
        for signal in (jobs.finished, jobs.failed):
            signal.connect(self._end)

    @property
    def drop(self) -> ShownDrop | None:
        """What is shown."""
        return self._drop

    @override
    def refresh(self) -> None:
        session = self.desk.workspace.session
        if session is None:
            self._forget()
            return
        if self._key is not None and self._key.folder != session.path:
            self._forget()
        key = key_of(session)
        if key != self._key:
            self._key = key
            self.desk.background.run(
                "imagination.drop", partial(load, key), partial(self._take, key), self._fail
            )
        self._look()

    def imagine(self) -> None:
        """Imagine the drop and the pours with the parameters as they are now."""
        self._start(self.tr("Imagine"), SessionWork.imagine)

    def render_pictures(self) -> None:
        """Draw the pictures of what was imagined."""
        self._start(self._render_title, SessionWork.render)

    def _start(self, title: str, method: Callable[..., None]) -> None:
        desk = self.desk
        desk.jobs.start(title, self.KEY, desk.session_host, method, desk.workspace.task())

    def _forget(self) -> None:
        self._key = self._drop = self._drawn = None
        self._failure = ""
        self._show()

    def _take(self, key: DropKey, drop: ShownDrop | None) -> None:
        if key == self._key:
            self._drop, self._failure = drop, ""
            self._show()

    def _fail(self, error: PoursightError) -> None:
        self._drop, self._failure = None, str(error)
        self._show()

    def _show(self) -> None:
        """Show what is loaded."""
        self.side.show_failure(self._failure)
        self.replay.show_drop(self._drop)
        if self._drop is not None:
            self.side.show_drop(self._drop)
        self._look()

    def _show_empty(self) -> None:
        workspace = self.desk.workspace
        if self._key is not None and self._key.containability:
            words = (
                self.tr("The drop cannot be shown") if self._failure else self.tr("The drop is being read")
            )
            self.side.show_empty(words, "")
            self.replay.scene.set_empty_text("")
        elif workspace.has("scan") or workspace.has("mesh"):
            said = self.tr("Would candies stay in it? Press Imagine to let them be dropped on the model.")
            self.side.show_empty(said, "")
            self.replay.scene.set_empty_text(self.tr("The drop is replayed here."))
        else:
            said = self.tr("Here candies are dropped on the model of a scanned object.")
            self.side.show_empty(said, self.tr("Go to Scan"))
            self.replay.scene.set_empty_text(self.tr("Scan an object first."))

    def _hear(self, news: object) -> None:
        if (
            isinstance(news, PictureDrawn)
            and news.session == self.desk.workspace.folder
            and self._drawn is not None
        ):
            self._drawn.append(news.path)
            self._show_pictures()

    def _begin(self, job: RunningJob) -> None:
        if job.page == self.KEY and job.title == self._render_title:
            self._drawn = []
        self._look()

    def _end(self, _job: RunningJob, _result: object) -> None:
        self._drawn = None
        self._look()

    def _look(self) -> None:
        """Enable what can be done now, and say it where there is no drop."""
        if self._drop is None:
            self._show_empty()
        workspace, is_idle = self.desk.workspace, self.desk.jobs.is_idle
        primary = self.side.primary
        has_input = workspace.has("scan") or workspace.has("mesh")
        is_done = self._is_done()
        primary.setEnabled(has_input and not is_done and is_idle)
        if is_done:
            primary.setToolTip(self.tr("This is up to date; change a parameter to imagine it otherwise"))
        else:
            primary.setToolTip(self.tr("Drop candies on the model, and pour into it if they stay"))
        self.side.stale.look(workspace, primary.text())
        self.pictures.button.setEnabled(is_done and is_idle)
        self._show_pictures()

    def _is_done(self) -> bool:
        """Whether there is nothing to imagine."""
        return all(self.desk.workspace.is_fresh(stage) for stage in ("containability", "pouring"))

    def _show_pictures(self) -> None:
        """Those that are being drawn, or those that belong to the drop that is shown."""
        drop, pictures = self._drop, self.pictures
        pictures.setVisible(drop is not None)
        if drop is None:
            pictures.show_none()
        elif self._drawn is not None:
            pictures.button.hide()
            pictures.show_drawing(self._drawn, drop.containability.is_open_container)
        else:
            paths = self._rendered()
            is_old = self._is_done() and not self.desk.workspace.is_fresh("evidence")
            pictures.button.setVisible(not paths or is_old)
            if paths:
                pictures.show_drawn(paths)
            else:
                pictures.show_none(self.tr("Pictures and films for the report are not drawn yet."))

    def _rendered(self) -> list[Path]:
        """The files of the evidence, if it is of the drop that is shown."""
        session = self.desk.workspace.session
        record = None if session is None else session.record("evidence")
        if session is None or record is None or self._key is None:
            return []
        if record.inputs.get("containability") != self._key.containability:
            return []
        return sorted(session.path / "evidence" / name for name in record.files if name != "evidence.json")
