"""The Scan page: the arm looks at the object from all sides, or a scan or a mesh comes from a file."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtWidgets import QVBoxLayout
from typing_extensions import override

from app.gui.desk.desk import Desk
from app.gui.pages.background_page import BackgroundPage
from app.gui.pages.cell_model import load_shown_cell
from app.gui.pages.scan.dropping import DropTarget
from app.gui.pages.scan.left import ScanLeft, ScanSplit
from app.gui.pages.scan.loading import ScanContents, ScanKey, load_scan, object_names
from app.gui.pages.scan.side import ScanSide
from app.gui.pages.scan.situation import Action, Situation, remarks_of, verdict_of
from app.gui.pages.scan.views import ShownImages, ViewTable
from app.gui.pages.scan.work import ScanJobs
from app.gui.views.scene import PreparedMesh, prepare_mesh
from app.jobs.scan_events import MeshGrown, ScanQuestion, ViewDone, ViewsPlanned
from app.operations.scan_run import ScanRequest
from app.operations.scanning import Proposal
from core.pipeline.freshness import Freshness

_REAL_CELL_NAME = "object"


class ScanPage(BackgroundPage[ScanKey, ScanContents]):
    """Shows the session's scan, and the one that is running."""

    KEY = "scan"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk, load_scan)
        self.left, self.side = ScanLeft(), ScanSide()
        self._work = ScanJobs(desk, self.KEY, self)
        self._views = ViewTable()
        self._images = ShownImages(self.side, self._views, desk.background)
        self._views_of: Path | None = None
        self._grown: PreparedMesh | None = None
        self._proposal: Proposal | None = None
        self._can_pause = self._is_paused = False
        self._question = ""
        self._is_pressed = self._has_arm = False
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(ScanSplit(self.left, self.side))
        self._drops = DropTarget(self)
        self._connect()
        desk.background.run("scan.objects", object_names, self.side.choice.set_names)
        self._show_cell()

    def _connect(self) -> None:
        desk, side = self.desk, self.side
        side.primary.clicked.connect(self._press)
        side.start_over.clicked.connect(lambda: self._scan(ScanRequest(restart=True)))
        side.take_again.clicked.connect(self._take_selected)
        side.follow.clicked.connect(self._follow)
        side.file_chosen.connect(self._import)
        side.choice.changed.connect(self.update_actions)
        self.left.view_picked.connect(self._select)
        self.left.verdict.action.clicked.connect(self._act)
        self._drops.arrived.connect(self._import)
        self._drops.refused.connect(self.report)
        self._work.proposed.connect(self._take_proposal)
        desk.cell.changed.connect(self._show_cell)
        desk.arm.changed.connect(self._show_arm)
        desk.jobs.event_received.connect(self._hear)

    # What the session holds

    @override
    def content_key(self) -> ScanKey | None:
        workspace = self.desk.workspace
        return ScanKey(workspace.session, self.desk.cell.settings, workspace.parameters.seed)

    @override
    def refresh(self) -> None:
        if self._work.is_scanning:
            self._is_outdated = True  # the scan reports itself; afterwards the files are read
        else:
            super().refresh()

    @override
    def forget(self) -> None:
        self._proposal = self._grown = None
        self._images.forget()
        super().forget()

    @override
    def show_content(self, former: ScanContents | None) -> None:
        if self.failure:
            self._is_pressed = False
            self.desk.message.emit(self.failure)
        if self.content is not None and not self._work.is_scanning:
            self._show_contents(self.content, is_first=former is None)
            if former is None and self.content.source == "nothing" and self.folder is not None:
                self.side.choice.choose_by_words(self.desk.workspace.session_name)
        self.update_actions()
        self._press_when_requested()

    def _show_contents(self, contents: ScanContents, *, is_first: bool) -> None:
        self._own_views()
        self._views.take_over(contents)
        if is_first and contents.object_name is not None:
            self.side.choice.choose(contents.object_name)
        view = self.left.view
        view.show_alone(contents.mesh if contents.source == "mesh" else None)
        view.show_box(contents.box)
        if contents.source != "mesh" and (contents.mesh is not None or self._grown is None):
            view.show_mesh(contents.mesh)  # what grew while the views were taken stays until there is a model
        self._show_views()
        selected = self._images.selected
        if selected is None and contents.n_taken:
            self._select(min(self._images.latest, len(contents.views) - 1))
        elif selected is not None and selected < len(self._views.views):
            self._images.select(selected, None)

    def _show_cell(self) -> None:
        settings = self.desk.cell.settings
        self.side.choice.show_cell(settings)
        self.load("cell", settings, load_shown_cell, self.left.view.show_cell)

    # What the arm does now

    def _hear(self, news: object) -> None:
        if not self._work.is_scanning:
            return
        if isinstance(news, ScanQuestion):
            self._question, self._can_pause, self._is_paused = news.sentence, True, True
        elif isinstance(news, ViewsPlanned):
            self._can_pause = True
            self._own_views()
            self._views.plan(news)
            self._show_views()
        elif isinstance(news, ViewDone):
            self._show_done(news)
        elif isinstance(news, MeshGrown):
            self.load("growing mesh", news, _prepared, self._show_growing)
        else:
            return
        self.update_actions()

    def _show_done(self, news: ViewDone) -> None:
        index = self._views.done(news)
        if index is None:
            return
        self._images.newest(index, news)
        self.left.grid.set_item(index, self._views.thumbnail(index))
        self._show_frusta()

    def _show_growing(self, mesh: PreparedMesh) -> None:
        if self._work.is_scanning:
            self._grown = mesh
            self.left.view.show_mesh(mesh)

    def _show_arm(self) -> None:
        arm, is_there = self.desk.arm, self.desk.arm.connected is not None
        self.left.view.show_arm(arm.last_seen_rad, is_connected=is_there)
        if is_there is not self._has_arm:
            self._has_arm = is_there
            self.side.choice.ask_clearance(arm.was_stopped)
            self.update_actions()

    def _own_views(self) -> None:
        """The table is about the open session from now on; until now it showed what was there before."""
        if self._views_of != self.folder:
            self._views_of = self.folder
            self._views.forget()

    def _show_views(self) -> None:
        self.left.grid.set_items(self._views.thumbnails())
        self.left.fit_thumbnails()
        self._show_frusta()

    def _show_frusta(self) -> None:
        self.left.view.show_views(self._views.views, self._images.selected)

    # What the user does

    @override
    def press_primary(self) -> None:
        if self._work.is_scanning:
            return
        self._is_pressed = True
        self._press_when_requested()

    def scan(self, source: str) -> None:
        """Choose what stands in the simulated cell and scan it, as soon as the page is ready."""
        self.side.choice.choose(source)
        self.press_primary()

    def _press_when_requested(self) -> None:
        if self._is_pressed and self.content is not None and self.desk.cell.settings is not None:
            self._is_pressed = False
            super().press_primary()

    def _press(self) -> None:
        now = self._situation()
        if not now.is_scanning:
            self._scan(ScanRequest(restart=now.is_same and not now.can_continue))
            return
        self._is_paused = not self._is_paused
        if self._is_paused:
            self._work.pause()
        else:
            self._question = ""
            self._work.resume()
        self.update_actions()

    def _scan(self, request: ScanRequest) -> None:
        """Scan in the open session if it may hold this scan, otherwise in a new one."""
        now = self._situation()
        source = self.side.choice.source
        if self.desk.workspace.session is None or now.needs_new_session:
            request = ScanRequest()
            if not self.desk.new_session(_REAL_CELL_NAME if source is None else Path(source).stem):
                return
        if not (request.retake or request.adaptive or now.can_continue):
            self.left.view.show_alone(None)
            self.left.view.show_mesh(None)
        self._proposal = None
        self._can_pause = self._is_paused = False
        self._question = ""
        self._images.forget()
        self._follow()
        self._work.scan(source, request)
        self.side.choice.forget_clearance()
        self.update_actions()

    def _take_selected(self) -> None:
        selected = self._images.selected
        if selected is not None:
            self._scan(ScanRequest(retake=(self._views.views[selected].name,)))

    def _act(self) -> None:
        action = verdict_of(self._situation()).action
        if action is Action.CHECK:
            self._work.check()
        elif action is Action.PROPOSE:
            self._work.propose()
        elif action is Action.TAKE_MORE:
            self._scan(ScanRequest(adaptive=True))
        elif action is Action.TAKE_POOR:
            self._scan(ScanRequest(retake=tuple(self._views.poor)))

    def _import(self, path: Path) -> None:
        """Import a folder of views or a mesh; into a new session, unless the open one holds nothing yet."""
        desk, contents = self.desk, self.content
        if not desk.jobs.is_idle:
            desk.message.emit(self.tr("Wait until the running job has ended, or cancel it; then import."))
            return
        is_empty = self.folder is not None and contents is not None and contents.source == "nothing"
        self._work.import_path(path, into_open=is_empty)

    def _take_proposal(self, proposal: Proposal) -> None:
        self._proposal = proposal
        self.update_actions()

    def _select(self, index: int) -> None:
        self._images.select(index, self._work.frames_in_progress)
        self.left.grid.select(index)
        self._show_frusta()
        self.update_actions()

    def _follow(self) -> None:
        self._images.follow()
        self.left.grid.select(None)
        self._show_frusta()
        self.update_actions()

    # What may be done, and what is said

    def _situation(self) -> Situation:
        desk = self.desk
        running, connected = desk.jobs.running, desk.arm.connected
        return Situation(
            contents=self.content,
            failure=self.failure,
            views=self._views,
            source=self.side.choice.source,
            is_ready=self.side.choice.is_ready,
            is_idle=desk.jobs.is_idle,
            is_scanning=self._work.is_scanning,
            can_pause=self._can_pause,
            is_paused=self._is_paused,
            question=self._question,
            is_checking=running is not None and running.page == self.KEY,
            is_arm_taken=desk.jobs.is_idle and connected is not None and not connected.is_simulated,
            was_stopped=desk.arm.was_stopped,
            is_stale=desk.workspace.stages.get("quality") is Freshness.STALE,
            is_simulated=desk.cell.is_simulated,
            proposal=self._proposal,
        )

    @override
    def update_actions(self) -> None:
        self._is_paused = self._is_paused and self._work.is_scanning
        now, side = self._situation(), self.side
        verdict = verdict_of(now)
        self.left.verdict.show_verdict(
            verdict.state, verdict.headline, verdict.details, verdict.button, verdict.tooltip
        )
        has_selected = self._images.selected is not None
        can_act = now.is_idle and (verdict.action is Action.CHECK or now.can_scan)
        self.offer(self.left.verdict.action, verdict.action is not Action.NONE, can_act)
        self.offer(side.start_over, now.can_continue and not now.is_scanning, now.can_scan)
        is_scan = now.contents is not None and now.contents.source == "scan"
        self.offer(side.take_again, is_scan and now.is_same, now.can_take_again and has_selected)
        self.offer(side.follow, now.is_scanning and has_selected)
        self.offer(side.import_folder, True, now.is_idle)
        self.offer(side.import_mesh, True, now.is_idle)
        side.primary.setText(now.primary_text)
        self.offer(side.primary, True, now.can_pause if now.is_scanning else now.can_scan)
        if self.hasFocus() and side.primary.isEnabled():
            side.primary.setFocus()
        side.choice.setEnabled(now.is_idle)
        side.show_camera(now.contents is None or now.contents.source != "mesh" or now.is_scanning)
        side.remark(*remarks_of(now))


def _prepared(grown: MeshGrown) -> PreparedMesh:
    return prepare_mesh(grown.vertices_m, grown.faces)
