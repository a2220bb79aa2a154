"""The window: the frame around the pages, and which page is shown. It makes no decision about the work."""

from __future__ import annotations

import linecache
from functools import partial
from importlib import import_module
from pathlib import Path

from PySide6.QtCore import QThread, QTimer, Signal
from PySide6.QtGui import QCloseEvent, QKeyEvent
from PySide6.QtWidgets import QHBoxLayout, QMainWindow, QStackedWidget, QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.desk.desk import Desk
from app.gui.desk.jobs import RunningJob
from app.gui.desk.memory import Memory
from app.gui.desk.page_states import page_states, with_failure
from app.gui.pages.page import Page, SplitView
from app.gui.pages.registry import OTHERS, WORK, import_page, make_page, tab_facts
from app.gui.pages.welcome.page import WelcomePage
from app.gui.shell.closing import may_close
from app.gui.shell.focus import FocusKeeper, press_by_enter
from app.gui.shell.frame import TabList, TopBar
from app.gui.shell.job_bar import JobBar, LogDrawer, MessageBar, next_step
from app.gui.shell.stop_dock import StopDock
from app.gui.stop.messages import Answered
from app.jobs.arm_events import StopDone
from app.jobs.messages import Failed, FailureKind
from app.library.index import Library
from app.library.places import sessions_folder

SMALLEST_PX = (1100, 700)
USUAL_PX = (1280, 800)
MUG = "mug"
BREATH_MS = 30
STARTED_BY_NEXT = ("scan", "reconstruction", "imagination", "robot")
"""Pages whose job starts with the click on "Next"."""
ARM_PAGES = ("scan", "robot")
"""Pages whose work moves the arm: with a real one "Next" only shows them."""
_OPENGL = "app.gui.views.scene.renderer"
"""Where pyqtgraph and PyOpenGL come in; a scene itself imports it when the first one is made."""


class Preload(QThread):
    """Imports the slow modules in a thread once the window is on the screen.

    PySide looks into the source of whatever is imported, and Python keeps what was looked into: 320,000 lines
    in the end, 30 MB. They are given back after each import, so that the next one gets their memory.
    """

    @override
    def run(self) -> None:
        import_module(_OPENGL)
        for key in (*WORK, *OTHERS):
            linecache.clearcache()
            import_page(key)
        linecache.clearcache()


class MainWindow(QMainWindow):
    """Everything the user sees.

    Signals: `ready` once everything slow at the start is done.
    """

    ready = Signal()

    def __init__(self, memory: Memory) -> None:
        super().__init__()
        self.setWindowTitle("Poursight")
        self.setMinimumSize(*SMALLEST_PX)
        self.resize(*USUAL_PX)
        self.memory = memory
        self.desk = Desk(self)
        self._failed_page: str | None = None
        self._states = page_states(self.desk.workspace, None)
        self._asks_before_closing = True
        self._stop_dock: StopDock | None = None
        self._pages: dict[str, Page] = {}
        self._laid_out: set[str] = set()
        self._stack = QStackedWidget()
        self._tabs = TabList(tuple(map(tab_facts, WORK)), tuple(map(tab_facts, OTHERS)))
        self.messages = MessageBar()
        self.log = LogDrawer(self.desk.jobs)
        self.job_bar = JobBar(self.desk.jobs)
        self.top_bar = TopBar(self.desk, self)
        self.welcome = WelcomePage(self.desk, memory)
        self._stack.addWidget(self.welcome)
        self._preload = Preload(self)
        self._lay_out()
        self._focus = FocusKeeper(self, self._stack.currentWidget)
        self._connect()
        self._show_states()

    def begin(self) -> None:
        """Start the slow part; the window is on the screen by now."""
        self.desk.cell.restore()
        self._preload.finished.connect(self._make_pages)
        self._preload.start()

    def _make_pages(self) -> None:
        """Make the pages one by one, so that no click has to wait for one; then all is ready."""
        missing = [key for key in (*WORK, *OTHERS) if key not in self._pages]
        if missing:
            self.page(missing[0])
            QTimer.singleShot(BREATH_MS, self, self._make_pages)
            return
        from app.gui.views.scene.warm_up import warm_up

        self.desk.prepare()  # not before: it would compete with the pages' imports for processors
        warm_up(self.ready.emit)

    @property
    def shown(self) -> str:
        """Key of the page that is shown."""
        page = self._stack.currentWidget()
        return "" if page is None else page.objectName()

    def page(self, key: str) -> Page:
        """Return a page, made at its first use."""
        if key == WelcomePage.KEY:
            return self.welcome
        if key not in self._pages:
            with self.top_bar.stop.deaf():
                page = make_page(key, self.desk)
                self._stack.addWidget(page)
            self._pages[key] = page
        return self._pages[key]

    def show_page(self, key: str) -> None:
        """Show a page."""
        page = self.page(key)
        page.resize(
            self._stack.size()
        )  # before it is shown: a 3D view paints at every size it passes through
        self._stack.setCurrentWidget(page)
        if key not in self._laid_out:
            self._laid_out.add(key)
            self._restore_split(page)
        self._tabs.choose(key)
        self._show_next()

    def go_on(self, key: str) -> None:
        """Show a page and, where that moves nothing real, press its button."""
        self.show_page(key)
        if key in STARTED_BY_NEXT and (key not in ARM_PAGES or self.desk.cell.is_simulated):
            self.page(key).press_primary()

    def scan_the_mug(self) -> None:
        """Start with the mug in the simulated cell: what a newcomer sees first."""
        self.desk.cell.choose(None, then=self._scan_the_mug)

    def _scan_the_mug(self) -> None:
        from app.gui.pages.scan.page import ScanPage

        page = self.page("scan")
        if isinstance(page, ScanPage) and self.desk.new_session(MUG):
            self.show_page("scan")
            page.scan(MUG)

    def _imagine_at_once(self) -> None:
        """Imagine what was scanned, whatever page is shown: the answer need not wait for a click."""
        from app.gui.pages.imagination.page import ImaginationPage

        page = self.page("imagination")
        if isinstance(page, ImaginationPage) and self.memory.imagines_after_scan:
            page.imagine()

    def reset_layout(self) -> None:
        """Give window and pages their usual sizes."""
        self.showNormal()
        self.resize(*USUAL_PX)
        for split in self.findChildren(SplitView):
            split.reset()

    def offer_cut_off_session(self) -> None:
        """After an unexpected end, offer the session that was open."""
        last = self.memory.last_session
        if self.memory.was_cut_off and last is not None:
            self.messages.say(
                self.tr(
                    "Poursight ended unexpectedly while the session '{name}' was open; its finished stages "
                    "are kept."
                ).format(name=last.name),
                action=self.tr("Open session"),
                do=partial(self.desk.open_session, last),
            )

    def close_without_asking(self) -> None:
        """End the running job, and the program."""
        self._asks_before_closing = False
        self.close()

    @override
    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not press_by_enter(event):
            super().keyPressEvent(event)

    @override
    def closeEvent(self, event: QCloseEvent) -> None:
        if self._asks_before_closing and not may_close(self, self.desk):
            event.ignore()
            return
        self._store_layout()
        if self._stop_dock is not None:
            self._stop_dock.close()
        self.desk.close()
        self.memory.store_session(None)  # only now: a kill while the work ends is one, too
        self._preload.wait()
        super().closeEvent(event)

    def _lay_out(self) -> None:
        middle = QHBoxLayout()
        middle.setSpacing(0)
        middle.addWidget(self._tabs)
        middle.addWidget(self._stack, 1)
        column = QVBoxLayout()
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.top_bar)
        column.addWidget(self.messages)
        column.addLayout(middle, 1)
        column.addWidget(self.log)
        column.addWidget(self.job_bar)
        whole = QWidget()
        whole.setLayout(column)
        self.setCentralWidget(whole)

    def _connect(self) -> None:
        desk = self.desk
        self._tabs.chosen.connect(self.show_page)
        desk.page_wanted.connect(self.show_page)
        desk.message.connect(self._show_message)
        desk.good_scan_taken.connect(self._imagine_at_once)
        desk.workspace.session_changed.connect(self._on_session)
        desk.workspace.renamed.connect(self._show_title)
        desk.workspace.stages_changed.connect(self._show_states)
        desk.jobs.started.connect(self._on_started)
        desk.jobs.failed.connect(self._on_failed)
        for signal in (desk.jobs.finished, desk.jobs.failed):
            signal.connect(lambda *_: QTimer.singleShot(0, self._focus.give_back))
        self.job_bar.log_wanted.connect(self.log.setVisible)
        self.job_bar.next_wanted.connect(self.go_on)
        self.top_bar.stop.pressed.connect(self.stop)
        desk.arm.stopped.connect(self._on_stopped)
        self.welcome.mug_wanted.connect(self.scan_the_mug)

    def give_stop_a_process(self) -> None:
        """From now on STOP lies over its place as a window of another process, while an arm has a channel."""
        dock = self._stop_dock = StopDock(self, self.top_bar.stop, self.desk.arm)
        dock.pressed.connect(self.stop)
        dock.answered.connect(self._on_answered)

    def stop(self) -> None:
        """STOP: the arm first, over every channel there is; then the job that moved it."""
        self.desk.arm.stop()
        self.log.add(self.tr("STOP was pressed."))
        job = self.desk.jobs.running
        if job is not None and job.host is not self.desk.session_host:
            self.desk.jobs.cancel()

    def _on_stopped(self, done: StopDone) -> None:
        if done.sentence:
            self.messages.say(done.sentence, state="failed")
        ms = round(1000 * done.seconds)
        self.log.add(
            done.sentence or self.tr("The controller confirmed the stop after {ms} ms.").format(ms=ms)
        )

    def _on_answered(self, answered: Answered) -> None:
        ms = round(1000 * answered.seconds)
        said = self.tr("STOP's own channel was answered after {ms} ms.").format(ms=ms)
        self.log.add(answered.problem or said)

    def _show_message(self, sentence: str) -> None:
        self.messages.say(sentence)
        self.log.add(sentence)

    def _on_session(self) -> None:
        self._failed_page = None
        folder = self.desk.workspace.folder
        if folder is not None:
            self.memory.store_session(folder)
            self.desk.background.run("remember", partial(_remember, folder), lambda _: None)
        self._show_title()
        self.messages.hide()
        if folder is None:
            self.show_page(WelcomePage.KEY)
        elif self.shown == WelcomePage.KEY:
            self.show_page("scan")

    def _show_title(self) -> None:
        session = self.desk.workspace.session
        self.setWindowTitle("Poursight" if session is None else f"{session.name} – Poursight")

    def _on_started(self, _job: RunningJob) -> None:
        self._failed_page = None
        self.messages.hide()
        self._show_states()

    def _on_failed(self, job: RunningJob, failed: Failed) -> None:
        if failed.kind is not FailureKind.CANCELLED:  # whoever cancelled knows; the job bar says it
            self._failed_page = job.page
            self.messages.say(
                failed.sentence,
                state="failed",
                details=failed.details,
                action=self.tr("Try again"),
                do=job.start_again,
            )
        self._show_states()

    def _show_states(self) -> None:
        job = self.desk.jobs.running
        self._states = page_states(self.desk.workspace, job.page if job is not None else None)
        for key, state in with_failure(self._states, self._failed_page).items():
            self._tabs.set_state(key, state)
        self._show_next()

    def _show_next(self) -> None:
        """Offer the next step, but not on its own page: there the page's button says it."""
        workspace = self.desk.workspace
        step = next_step(self._states, workspace.is_container, self.shown, workspace.is_undecided)
        is_offered = workspace.session is not None and step is not None and step.page != self.shown
        self.job_bar.show_next(step if is_offered else None)

    def _restore_split(self, page: Page) -> None:
        split = page.findChild(SplitView)
        sizes = self.memory.split(page.KEY)
        if split is not None and sizes is not None:
            # A page gets its size when it is laid out; sizes set before would be scaled from zero.
            QTimer.singleShot(0, split, lambda: split.setSizes(sizes))

    def _store_layout(self) -> None:
        self.memory.geometry = self.saveGeometry()
        for key, page in self._pages.items():
            split = page.findChild(SplitView)
            if split is not None and key in self._laid_out:  # others never had a size of their own
                self.memory.store_split(key, split.sizes())


def _remember(folder: Path) -> None:
    Library((sessions_folder(),)).remember(folder)
