"""The Cell page: a cell is set up step by step; each step can be repeated alone, and undone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PySide6.QtCore import QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QVBoxLayout
from typing_extensions import override

from app.gui.desk.desk import Desk
from app.gui.pages.background_page import BackgroundPage
from app.gui.pages.cell.loading import CellContents, CellKey, Evidence, load_cell
from app.gui.pages.cell.side import CellSide
from app.gui.pages.cell.situation import Situation, now_of, obstacle_of
from app.gui.pages.cell.step_list import StepLine
from app.gui.pages.cell.view import CellView
from app.gui.pages.cell.words import STATES, capitalized, step_words, when
from app.gui.pages.cell.work import CellJobs
from app.gui.pages.page import SplitView
from app.gui.views.scene import Frustum
from app.gui.views.state_mark import State
from app.jobs.cell_events import BoardSought, CameraSeen, LooksPlanned
from app.jobs.scan_events import ScanQuestion
from app.operations.calibration import step_names
from app.operations.calibration.cup_entry import entry_of
from app.operations.calibration.steps import Step, StepState
from core.calibration.board import BoardSpec
from core.errors import PoursightError
from core.geometry import FloatArray


class CellPage(BackgroundPage[CellKey, CellContents]):
    """Shows how far the chosen cell is, and does its steps."""

    KEY = "cell"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk, load_cell)
        self.view, self.side = CellView(), CellSide()
        self._work = CellJobs(desk, self.KEY)
        self._picked = ""
        self._wants_new = False
        self._of: Path | None = None
        self._looks: list[BoardSought] = []
        self._planned: FloatArray = np.empty((0, 4, 4))
        self._question, self._is_paused = "", False
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(SplitView(self.view, self.side))
        self._connect()

    def _connect(self) -> None:
        desk, side = self.desk, self.side
        side.primary.clicked.connect(self._press)
        side.undo.clicked.connect(lambda: self._work.undo(self.step))
        side.live.clicked.connect(self._watch_camera)
        side.start_over.clicked.connect(lambda: self._do(is_restarted=True))
        side.steps.chosen.connect(self._pick)
        side.cell_wanted.connect(self._choose_cell)
        side.new_wanted.connect(self._want_new)
        side.form.changed.connect(self.update_actions)
        side.options.print_wanted.connect(self._print)
        for edited in (side.options.crop.edited, self.view.box_edited):
            edited.connect(lambda low_m, high_m: self._work.enter_crop_box(low_m, high_m, self.report))
        cup = side.options.cup
        cup.read_wanted.connect(lambda: self._work.read_station(cup.show_station))
        side.options.touch.read_wanted.connect(lambda: self._work.read_touch(side.options.touch.tip_m))
        desk.arm.changed.connect(self._show_arm)
        desk.jobs.event_received.connect(self._hear)
        for signal in (desk.jobs.finished, desk.jobs.failed):
            signal.connect(lambda job, _: self._end(job.page))

    # What the cell's file and its records hold

    @override
    def content_key(self) -> CellKey | None:
        settings = self.desk.cell.settings
        return None if settings is None else CellKey(self.desk.cell.path, settings)

    @override
    def show_content(self, former: CellContents | None) -> None:
        if self.failure:
            self.desk.message.emit(self.failure)
        if self.content is None:
            self.update_actions()
            return
        if self._of != self.desk.cell.path:
            self._of, self._picked, self._wants_new = self.desk.cell.path, "", False
        board = self.content.board
        if board is not None:
            self.side.options.show_board(board.board, board.is_measured)
        settings = self.desk.cell.settings
        if settings is not None:
            self.side.options.cup.show_entry(self.desk.cell.path, entry_of(settings), settings.robot.is_real)
            self.side.options.touch.show_tip(self.content.tip_m, self.content.is_checked)
            self.side.options.crop.show_box(settings.place.crop_min_m, settings.place.crop_max_m)
        self.view.show_cell(self.content.shown, BoardSpec() if board is None else board.board)
        self.side.show_cells(self.content.known, self.desk.cell.path, self.is_new)
        self._show_evidence()
        self.update_actions()

    @property
    def is_new(self) -> bool:
        """Whether the form for a new cell is shown: nothing of the shipped one can be changed."""
        return self._wants_new or self.desk.cell.path is None

    @property
    def step(self) -> str:
        """The step that was picked, else the first that is not done; empty if all are."""
        if self._work.is_running:
            return self._work.step
        return self._picked or next((step.name for step in self._steps if not _is_done(step)), "")

    @property
    def _steps(self) -> tuple[Step, ...]:
        return () if self._known is None or self.is_new else self._known.steps

    @property
    def _known(self) -> CellContents | None:
        """What was read of the cell that is chosen; none while another one's contents are still there."""
        content = self.content
        return content if content is not None and content.path == self.desk.cell.path else None

    def _show_evidence(self) -> None:
        """Show what the chosen step looked at, else the last one before it, unless a step is under way."""
        if self.content is None or self._work.is_running:
            return
        found = Evidence()
        for name, seen in self.content.evidence.items():
            found = seen if seen.frusta and name != step_names.VIEWS else found
            if name == (self.step or step_names.HAND_EYE):
                found = seen if seen.frusta else found
                break
        self.view.show_looks(found.frusta, found.T_base_board)
        self.view.now.show_picture(found.color)

    # What the arm does now

    def _hear(self, news: object) -> None:
        if not self._work.is_running:
            return
        if isinstance(news, ScanQuestion):
            self._question = news.sentence
        elif isinstance(news, LooksPlanned):
            self._planned = news.T_base_camera
            self._show_looks()
        elif isinstance(news, CameraSeen):
            self.view.show_live(news.color, news.depth_m)
            return
        elif isinstance(news, BoardSought):
            self._looks.append(news)
            self._planned = self._planned[1:]
            self._show_looks()
            self.view.now.show_picture(news.color, news.corners_px)
        else:
            return
        self.update_actions()

    def _show_looks(self) -> None:
        taken = [
            Frustum(f"look {look.number}", look.T_base_camera, "poor" if look.problem else "taken")
            for look in self._looks
        ]
        planned = [Frustum(f"next {k}", pose) for k, pose in enumerate(self._planned)]
        boards = [look.T_base_board for look in self._looks if look.T_base_board is not None]
        self.view.show_looks([*taken, *planned], boards[-1] if boards else None)

    def _show_arm(self) -> None:
        status, is_there = self.desk.arm.status, self.desk.arm.connected is not None
        state = status.state if status is not None else None
        if self.content is not None and (state is not None or not is_there):
            self.view.bend(None if state is None else state.joints_rad)

    def _end(self, page: str) -> None:
        """A job has ended: what it did is in the files."""
        if page == self.KEY:
            self._picked = step_names.CAMERA if self._work.is_live else ""
            self._question, self._is_paused = "", False
            self.view.end_live()
            self._work.read_again()

    # What the user does

    def _pick(self, step: str) -> None:
        self._picked = step
        self._show_evidence()
        self.update_actions()

    def _choose_cell(self, path: Path | None) -> None:
        self._wants_new = False
        self.desk.cell.choose(path)

    def _want_new(self) -> None:
        self._wants_new = True
        self.update_actions()

    def _press(self) -> None:
        form = self.side.form
        if self._work.is_running and not self._question and not self._is_paused:
            self._is_paused = True
            self._work.pause()
            self.update_actions()
        elif self._work.is_running:
            self._question, self._is_paused = "", False
            self._work.resume()
            self.update_actions()
        elif self.is_new:
            self._work.make(form.name, form.is_simulated, form.address)
        elif self.step:
            self._do()
        else:
            self.desk.page_wanted.emit("scan")

    def _do(self, *, is_restarted: bool = False) -> None:
        step = self.step
        self._looks, self._planned = [], np.empty((0, 4, 4))
        self._question, self._is_paused = "", False
        try:
            words = step_words(step, self.desk.cell.is_simulated)
            self._work.do(step, words.title, self.side.options, is_restarted=is_restarted)
        except PoursightError as error:
            self.report(error)
            return
        self._picked = ""
        self.update_actions()

    def _watch_camera(self) -> None:
        self._work.watch_camera(self.side.live.text())
        self.update_actions()

    def _print(self) -> None:
        try:
            self._work.print_board(self.side.options, _open)
        except PoursightError as error:
            self.report(error)

    # What may be done, and what is said

    def _situation(self) -> Situation:
        desk, options = self.desk, self.side.options
        connected = desk.arm.connected
        return Situation(
            contents=self._known,
            failure=self.failure,
            steps=self._steps,
            step=self.step,
            is_new=self.is_new,
            is_running=self._work.is_running,
            is_live=self._work.is_live,
            is_idle=desk.jobs.is_idle,
            is_simulated=desk.cell.is_simulated,
            is_arm_taken=desk.jobs.is_idle and connected is not None and not connected.is_simulated,
            is_paused=self._is_paused,
            question=self._question,
            looks=tuple(self._looks),
            n_planned=options.n_views,
        )

    @override
    def update_actions(self) -> None:
        now, side = self._situation(), self.side
        said = now_of(now)
        self.view.now.say(said.state, said.headline, said.details)
        side.form.setVisible(now.is_new)
        side.steps.setVisible(bool(now.steps))
        side.steps.set_lines([self._line(step, now) for step in now.steps])
        side.steps.choose(now.step)
        self._show_step(now)
        self.view.offer_box(now.step == step_names.TABLE and now.is_idle)
        obstacle = obstacle_of(now)
        side.show_obstacle(obstacle)
        side.primary.setText(now.primary_text)
        can_begin = now.is_idle and not obstacle and now.contents is not None
        is_complete = side.form.is_complete if now.is_new else True
        is_asked = now.can_pause or (now.is_running and bool(now.question))
        self.offer(side.primary, is_asked or not now.is_running, is_asked or (can_begin and is_complete))
        self.offer(side.undo, now.can_undo and not now.is_running, now.is_idle)
        self.offer(side.live, now.step == step_names.CAMERA and not now.is_running, can_begin)
        self.offer(side.start_over, now.can_continue and not now.is_running, can_begin)
        for widget in (side.form, side.options, side.steps):
            widget.setEnabled(now.is_idle)

    def _line(self, step: Step, now: Situation) -> StepLine:
        is_running = now.is_running and step.name == now.step
        state: State = "running" if is_running else STATES[step.state]
        title = step_words(step.name, now.is_simulated).title
        return StepLine(step.name, title, state, capitalized(step.figure), when(step.time))

    def _show_step(self, now: Situation) -> None:
        chosen = next((step for step in now.steps if step.name == now.step), None)
        self.side.options.show_step("" if chosen is None else chosen.name)
        if chosen is None:
            self.side.show_step("", "", "")
            return
        words = step_words(chosen.name, now.is_simulated)
        figure = "" if chosen.state is StepState.OPEN else f"{capitalized(chosen.figure)}."
        self.side.show_step(words.title, words.what, figure)


def _is_done(step: Step) -> bool:
    return step.state is StepState.DONE


def _open(pdf: Path) -> None:
    QDesktopServices.openUrl(QUrl.fromLocalFile(str(pdf)))
