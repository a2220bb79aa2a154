"""What the program reports: a message above the page; the job under way, what is next and the log below."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime

from PySide6.QtCore import QCoreApplication, Qt, Signal
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QPlainTextEdit,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
)

from app.gui.desk.job_steps import JobSteps
from app.gui.desk.jobs import Jobs, RunningJob
from app.gui.desk.page_states import PageState
from app.gui.desk.stage_words import stage_words, step_name
from app.gui.pages.registry import WORK
from app.gui.theme import GRID_PX
from app.gui.views.progress_line import ProgressLine
from app.gui.views.state_mark import State, StateMark
from app.jobs.messages import Failed, FailureKind
from core.report.sentences import duration_text

_BAR_PX, _LOG_PX, _DETAILS_PX = 44, 150, 160
_MOST_LINES = 2000
_COUNTED = ("pouring",)
"""Steps whose units people count."""
_STEPS_BEFORE = 3
"""So many steps that are done are still shown; with all of them the line would be too long."""


class JobBar(QFrame):
    """The bar below the pages: what runs, how long it will take, and Cancel; else what to do next."""

    log_wanted = Signal(bool)
    next_wanted = Signal(str)

    def __init__(self, jobs: Jobs) -> None:
        super().__init__()
        self.setObjectName("job_bar")
        self.setFixedHeight(
            _BAR_PX
        )  # a button that appears or disappears must not resize the page and its 3D view
        self._jobs = jobs
        self._text = QLabel()
        self._text.setObjectName("job_text")
        self._left = QLabel()
        self._left.setProperty("role", "muted")
        self._bar = ProgressLine()
        self._bar.setObjectName("job_progress")
        self._bar.setFixedSize(28 * GRID_PX, GRID_PX)
        self._cancel = QPushButton(self.tr("Cancel"))
        self._cancel.setObjectName("cancel")
        self._cancel.setToolTip(self.tr("Stop this job; finished stages are kept."))
        self._cancel.clicked.connect(jobs.cancel)
        self._log = QPushButton(self.tr("Log"))
        self._log.setObjectName("log_toggle")
        self._log.setCheckable(True)
        self._log.setToolTip(self.tr("Everything reported since the program started (Ctrl+L)."))
        self._log.toggled.connect(self.log_wanted)
        self._step: NextStep | None = None
        self._next = QPushButton()
        self._next.setObjectName("next")
        self._next.setProperty("role", "next")
        self._next.setToolTip(self.tr("Ctrl+Enter"))
        self._next.clicked.connect(self.go_on)
        row = QHBoxLayout(self)
        row.setContentsMargins(2 * GRID_PX, GRID_PX // 2, GRID_PX, GRID_PX // 2)
        row.setSpacing(2 * GRID_PX)
        for widget in (self._text, self._bar, self._left):
            row.addWidget(widget)
        row.addStretch(1)
        row.addWidget(self._next)
        row.addWidget(self._cancel)
        row.addWidget(self._log)
        jobs.started.connect(self._show)
        jobs.progressed.connect(self._show)
        jobs.finished.connect(lambda job, _: self._rest(job.done))
        jobs.failed.connect(self._end)
        self._rest(self.tr("Ready."))

    def toggle_log(self) -> None:
        """Open or close the log."""
        self._log.toggle()

    def show_next(self, step: NextStep | None) -> None:
        """Offer what comes next; it is hidden while something runs."""
        self._step = step
        self._next.setText("" if step is None else step.words)
        self._next.setVisible(step is not None and self._jobs.is_idle)

    def go_on(self) -> None:
        """Do what comes next, if it is offered."""
        if self._step is not None and self._jobs.is_idle:
            self.next_wanted.emit(self._step.page)

    def _show(self, job: RunningJob) -> None:
        self._text.setText(f"{job.title}: {self._doing(job)}")
        self._bar.show()
        self._bar.set_fraction(job.fraction if job.stage else None)
        self._left.setText(self._time_left(job))
        self._next.hide()
        self._cancel.setVisible(True)
        self._cancel.setEnabled(not job.is_cancelling)

    def _doing(self, job: RunningJob) -> str:
        if job.is_cancelling:
            return self.tr("stopping")
        if job.is_endless:
            return self.tr("until you cancel it")
        if not job.stage:
            return self.tr("starting")
        if job.steps is None or job.steps.current is None:
            return stage_words(job.stage)
        return steps_text(job.steps, job.stage, job.counted)

    def _time_left(self, job: RunningJob) -> str:
        share = self.tr("{percent} %").format(percent=round(100 * job.fraction)) if job.stage else ""
        if job.is_cancelling:
            return share
        if job.paused_s is not None:
            return ", ".join(filter(None, (share, self.tr("paused"))))
        if job.seconds_left is None:
            is_late = job.steps is not None and job.steps.is_late
            return self.tr("{share}, takes longer than expected").format(share=share) if is_late else share
        return self.tr("{share}, about {time} left").format(share=share, time=duration_text(job.seconds_left))

    def _end(self, job: RunningJob, failed: Failed) -> None:
        said = self.tr("{title}: did not finish.")
        if failed.kind is FailureKind.CANCELLED:
            said = self.tr("{title}: cancelled; what was finished is kept.")
        self._rest(said.format(title=job.title))

    def _rest(self, text: str) -> None:
        self._text.setText(text)
        self._left.clear()
        self._bar.hide()
        self._cancel.hide()


def steps_text(steps: JobSteps, stage: str, counted: tuple[int, int] | None) -> str:
    """Return the job's steps as rich text: the one that runs is bold, and counts; those before are ticked."""
    current = steps.names.index(steps.current) if steps.current is not None else -1
    words = []
    for index, name in enumerate(
        steps.names[max(current - _STEPS_BEFORE, 0) :], max(current - _STEPS_BEFORE, 0)
    ):
        text = step_name(name)
        if index < current:
            text = f"{text}\N{NO-BREAK SPACE}\N{CHECK MARK}"
        elif index == current:
            if name in _COUNTED and stage == name and counted is not None:
                done = QCoreApplication.translate("JobBar", "{done} of {all}")
                text = f"{text} {done.format(done=counted[0], all=counted[1])}"
            text = f"<b>{text}</b>"
        words.append(text)
    return " \N{MIDDLE DOT} ".join(words)


@dataclass(frozen=True)
class NextStep:
    """The page to go to, and the button's text."""

    page: str
    words: str


def next_step(
    states: dict[str, PageState], is_container: bool | None, shown: str, is_undecided: bool = False
) -> NextStep | None:
    """Return the first step of the work that is not up to date; none when all is done.

    Args:
        states: of the pages.
        is_container: the verdict; none before there is one. Only a container is poured into.
        shown: the page that is shown: the arm only pours once the pours have been reviewed.
        is_undecided: whether the verdict depends on what no view saw: then the scan needs more views.
    """
    translate = QCoreApplication.translate
    words = {
        "scan": translate("NextStep", "Next: scan the object"),
        "reconstruction": translate("NextStep", "Next: reconstruct the surface"),
        "imagination": translate("NextStep", "Next: test whether it holds candies"),
        "pours": translate("NextStep", "Next: review the pours"),
        "robot": translate("NextStep", "Next: let the arm pour"),
    }
    for page in WORK:
        if page in ("pours", "robot") and is_undecided:
            return NextStep("scan", translate("NextStep", "Next: look again from further views"))
        if page in ("pours", "robot") and is_container is False:
            return None
        if states[page].word == "fresh":
            continue
        if page == "scan" and states[page].word == "failed":
            return NextStep(page, translate("NextStep", "Next: scan the object again"))
        if page == "robot" and shown not in ("pours", "robot"):
            return NextStep("pours", words["pours"])
        return NextStep(page, words[page])
    return None


class MessageBar(QFrame):
    """One sentence above the page: what went wrong and how to go on; the details are behind a click."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("message_bar")
        self._mark = StateMark()
        self._sentence = QLabel()
        self._sentence.setObjectName("message")
        self._sentence.setWordWrap(True)
        self._sentence.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self._sentence.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self._action = QPushButton()
        self._action.setObjectName("message_action")
        self._more = QPushButton(self.tr("Details"))
        self._more.setObjectName("message_details")
        self._more.setCheckable(True)
        close = QPushButton(self.tr("Close"))
        close.setObjectName("message_close")
        close.clicked.connect(self.hide)
        self._details = QPlainTextEdit()
        self._details.setReadOnly(True)
        self._details.setFixedHeight(_DETAILS_PX)
        self._details.hide()
        self._more.toggled.connect(self._details.setVisible)
        self._do: Callable[[], object] | None = None
        self._action.clicked.connect(self._act)
        row = QHBoxLayout()
        row.setSpacing(GRID_PX)
        row.addWidget(self._mark)
        row.addWidget(self._sentence, 1)
        for button in (self._action, self._more, close):
            row.addWidget(button)
        column = QVBoxLayout(self)
        column.setContentsMargins(2 * GRID_PX, GRID_PX, GRID_PX, GRID_PX)
        column.addLayout(row)
        column.addWidget(self._details)
        self.hide()

    @property
    def sentence(self) -> str:
        """What it says; empty while it is hidden."""
        return "" if self.isHidden() else self._sentence.text()

    def say(
        self,
        sentence: str,
        *,
        state: State = "stale",
        details: str = "",
        action: str = "",
        do: Callable[[], object] | None = None,
    ) -> None:
        """Show a sentence.

        Args:
            sentence: what happened and what to do.
            state: its mark is shown before the sentence.
            details: shown on request.
            action: text of a button that does something about it.
            do: what that button does.
        """
        self._sentence.setText(sentence)
        self._mark.set_state(state)
        self._mark.setToolTip("")  # the sentence says what it is
        self._more.setChecked(False)
        self._more.setVisible(bool(details))
        self._details.setPlainText(details)
        self._do = do
        self._action.setText(action)
        self._action.setVisible(do is not None)
        self.show()

    def _act(self) -> None:
        do, self._do = self._do, None
        self.hide()
        if do is not None:
            do()


class LogDrawer(QFrame):
    """Everything reported since the program started, newest at the bottom; opened from the job bar."""

    def __init__(self, jobs: Jobs) -> None:
        super().__init__()
        self.setObjectName("log_drawer")
        self._text = QPlainTextEdit()
        self._text.setObjectName("log")
        self._text.setReadOnly(True)
        self._text.setMaximumBlockCount(_MOST_LINES)
        self._text.setAccessibleName(self.tr("Log"))
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self._text)
        self.setFixedHeight(_LOG_PX)
        jobs.started.connect(lambda job: self.add(self.tr("{title}: started.").format(title=job.title)))
        jobs.finished.connect(lambda job, _: self.add(job.done))
        jobs.failed.connect(self._failed)
        jobs.warned.connect(self.add)
        self.hide()

    @property
    def text(self) -> str:
        """All lines."""
        return self._text.toPlainText()

    def add(self, sentence: str) -> None:
        """Add a line with the time."""
        self._text.appendPlainText(f"{datetime.now():%H:%M:%S}  {sentence}")

    def _failed(self, job: RunningJob, failed: Failed) -> None:
        self.add(f"{job.title}: {failed.sentence}")
        if failed.details:
            self._text.appendPlainText(failed.details.rstrip())
