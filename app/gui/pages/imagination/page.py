"""The Imagination page: the drop replayed, the verdict with its reason, and the parameters behind it."""

from __future__ import annotations

from collections.abc import Callable
from math import degrees
from pathlib import Path

from PySide6.QtWidgets import QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.desk.desk import Desk
from app.gui.desk.jobs import RunningJob
from app.gui.desk.workspace import IMAGINING
from app.gui.pages.background_page import BackgroundPage
from app.gui.pages.imagination.drop import DropKey, ShownBody, ShownDrop, key_of, load
from app.gui.pages.imagination.side import VerdictSide
from app.gui.pages.imagination.view import DropReplay, PicturesPart
from app.gui.pages.page import SplitView
from app.gui.views.labels import say
from app.jobs.session_work import PictureDrawn, SessionWork
from core.imagination.results import PoursSoFar
from core.pipeline.session_view import ALL_IMAGINED


class ImaginationPage(BackgroundPage[DropKey, ShownDrop | ShownBody | None]):
    """Shows what was imagined, starts imagining and rendering."""

    KEY = "imagination"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk, load)
        self._rendered: list[Path] | None = None  # so far, while pictures are rendered
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
        self.show_content(None)

    def _connect(self) -> None:
        self.side.primary.clicked.connect(self.imagine)
        self.side.empty_wanted.connect(lambda: self.desk.page_wanted.emit("scan"))
        self.pictures.render_wanted.connect(self.render_pictures)
        self.side.retention.tilt_pointed_at.connect(self._tilt)
        self.replay.timeline.time_changed.connect(lambda _: self.side.retention.point_at(None))
        jobs = self.desk.jobs
        jobs.event_received.connect(self._hear)
        jobs.started.connect(self._begin)
        for signal in (jobs.finished, jobs.failed):
            signal.connect(self._end)

    @override
    def content_key(self) -> DropKey | None:
        view = self.desk.workspace.view
        return None if view is None else key_of(view)

    @override
    def show_content(self, former: ShownDrop | ShownBody | None) -> None:
        say(self.side.failed, self.failure)
        shown, drop = self.content, self.drop
        if drop is not None:
            is_same = isinstance(former, ShownDrop) and former.digest == drop.digest
            if is_same:
                self.replay.put_back()
            else:
                self.replay.show_drop(drop, is_played=self._is_imagining)
            self.side.show_drop(drop)
        elif isinstance(shown, ShownBody):
            self.replay.show_body(shown)
        else:
            self.replay.show_nothing()
        self.update_actions()

    @property
    def drop(self) -> ShownDrop | None:
        """The drop that is shown; none if there is none."""
        return self.content if isinstance(self.content, ShownDrop) else None

    @property
    def _is_imagining(self) -> bool:
        job = self.desk.jobs.running
        return job is not None and job.steps is not None and job.host is self.desk.session_host

    @override
    def update_actions(self) -> None:
        if self.drop is None:
            self._show_empty()
        workspace, is_idle = self.desk.workspace, self.desk.jobs.is_idle
        primary = self.side.primary
        has_input = workspace.has("scan") or workspace.has("mesh")
        is_done = self._is_done()
        primary.setEnabled(has_input and not is_done and is_idle)
        if is_done:
            primary.setToolTip(self.tr("This is up to date; change a parameter to imagine it differently"))
        else:
            primary.setToolTip(self.tr("Drop candies on the model, and pour into it if they stay"))
        self.side.stale.look(workspace, primary.text())
        if self._is_imagining:  # the button was pressed
            self.side.stale.hide()
        self.pictures.button.setEnabled(is_done and is_idle)
        self._show_pictures()

    def imagine(self) -> None:
        """Imagine the drop and the pours with the parameters as they are now."""
        self._start(self.tr("Imagine"), SessionWork.imagine, *IMAGINING)

    def render_pictures(self) -> None:
        """Render pictures of what was imagined."""
        self._start(self._render_title, SessionWork.render, "evidence")

    def _start(self, title: str, method: Callable[..., None], *stages: str) -> None:
        desk = self.desk
        steps = desk.workspace.steps_to(*stages)
        desk.jobs.start(title, self.KEY, desk.session_host, method, desk.workspace.task(), steps=steps)

    def _show_empty(self) -> None:
        workspace = self.desk.workspace
        button = ""
        if workspace.has("containability"):
            said = self.tr("The drop cannot be shown") if self.failure else self.tr("Loading the drop ...")
            scene = ""
        elif self._is_imagining:
            said, scene = self.tr("Dropping candies on it ..."), ""
        elif workspace.has("scan") or workspace.has("mesh"):
            said = self.tr("Would candies stay in it? Press Imagine to drop some on the model.")
            scene = self.tr("The drop is replayed here.")
        else:
            said = self.tr("Here candies are dropped on the model of a scanned object.")
            scene = self.tr("Scan an object first.")
            button = self.tr("Go to Scan")
        self.side.show_empty(said, button)
        self.replay.scene.set_empty_text(scene)

    def _tilt(self, tilt_rad: float) -> None:
        """Show the object as far tilted as is pointed at in the chart, towards the worst side."""
        retention = None if self.drop is None else self.drop.retention
        if retention is None:
            return
        shares = retention.share_at(tilt_rad)
        worst = int(shares.argmin())
        words = self.tr("Tilted by {angle:.0f}°: {n} of {all} candies left on the worst side").format(
            angle=degrees(tilt_rad), n=round(float(shares[worst]) * retention.n_load), all=retention.n_load
        )
        self.replay.show_tilt(tilt_rad, float(retention.direction_rad[worst]), words)

    def _hear(self, event: object) -> None:
        if isinstance(event, PoursSoFar):
            self.side.show_pours_so_far(event)
        if not isinstance(event, PictureDrawn) or self._rendered is None:
            return
        if event.session == self.desk.workspace.folder:
            self._rendered.append(event.path)
            self._show_pictures()

    def _begin(self, job: RunningJob) -> None:
        self.side.end_pours()
        if job.page == self.KEY and job.title == self._render_title:
            self._rendered = []
            self._show_pictures()

    def _end(self, _job: RunningJob, _result: object) -> None:
        self.side.end_pours()
        self._rendered = None
        self._show_pictures()

    def _is_done(self) -> bool:
        """Whether there is nothing to imagine."""
        return all(self.desk.workspace.is_fresh(stage) for stage in ALL_IMAGINED)

    def _show_pictures(self) -> None:
        """Those that are being rendered, or those that belong to the drop that is shown."""
        drop, pictures = self.drop, self.pictures
        pictures.setVisible(drop is not None)
        if drop is None:
            pictures.show_none()
        elif self._rendered is not None:
            pictures.button.hide()
            found = drop.containability
            pictures.show_drawing(self._rendered, found is not None and found.is_open_container)
        else:
            paths = self._evidence()
            is_old = self._is_done() and not self.desk.workspace.is_fresh("evidence")
            pictures.button.setVisible(not paths or is_old)
            if paths:
                pictures.show_drawn(paths)
            else:
                pictures.show_none(self.tr("The report's pictures and films are not rendered yet."))

    def _evidence(self) -> list[Path]:
        """The files of the evidence, if it is of the drop that is shown."""
        session, key = self.desk.workspace.session, self.content_key()
        record = self.desk.workspace.record("evidence")
        if session is None or record is None or key is None:
            return []
        if record.inputs.get("containability") != key.containability:
            return []
        return sorted(session.path / "evidence" / name for name in record.files if name != "evidence.json")
