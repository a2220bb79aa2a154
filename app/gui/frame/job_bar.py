"""What runs, how far it is, how long it will take, and Cancel; else what to do next."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton

from app.gui.desk.jobs import Jobs, RunningJob
from app.gui.desk.stage_words import stage_words
from app.gui.frame.next_step import NextStep
from app.gui.theme import GRID_PX
from app.gui.views.progress_line import ProgressLine

_HEIGHT_PX = 44


class JobBar(QFrame):
    """The bar below the pages."""

    log_wanted = Signal(bool)
    next_wanted = Signal(str)

    def __init__(self, jobs: Jobs) -> None:
        super().__init__()
        self.setObjectName("job_bar")
        self.setFixedHeight(_HEIGHT_PX)  # a button that comes or goes must not move the page, and its 3D view
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
        self._cancel.setToolTip(self.tr("Stop this work; what was finished before is kept."))
        self._cancel.clicked.connect(jobs.cancel)
        self._log = QPushButton(self.tr("Log"))
        self._log.setObjectName("log_toggle")
        self._log.setCheckable(True)
        self._log.setToolTip(self.tr("Everything that was told since the program was started (Ctrl+L)."))
        self._log.toggled.connect(self.log_wanted)
        self._step: NextStep | None = None
        self._next = QPushButton()
        self._next.setObjectName("next")
        self._next.setProperty("role", "next")
        self._next.clicked.connect(self._go_on)
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
        jobs.finished.connect(lambda job, _: self._rest(self.tr("{title}: done.").format(title=job.title)))
        jobs.failed.connect(lambda job, _: self._rest(self.tr("{title}: ended.").format(title=job.title)))
        self._rest(self.tr("Ready."))

    def toggle_log(self) -> None:
        """Open or close the log."""
        self._log.toggle()

    def show_next(self, step: NextStep | None) -> None:
        """Offer what comes next; it is hidden while something runs."""
        self._step = step
        self._next.setText("" if step is None else step.words)
        self._next.setVisible(step is not None and self._jobs.is_idle)

    def _go_on(self) -> None:
        if self._step is not None:
            self.next_wanted.emit(self._step.page)

    def _show(self, job: RunningJob) -> None:
        doing = stage_words(job.stage) if job.stage else self.tr("starting")
        if job.is_cancelling:
            doing = self.tr("stopping")
        self._text.setText(f"{job.title}: {doing}")
        self._bar.show()
        self._bar.set_fraction(job.fraction if job.stage else None)
        self._left.setText(self._time_left(job))
        self._next.hide()
        self._cancel.setVisible(True)
        self._cancel.setEnabled(not job.is_cancelling)

    def _time_left(self, job: RunningJob) -> str:
        share = self.tr("{percent} %").format(percent=round(100 * job.fraction)) if job.stage else ""
        left_s = job.seconds_left
        if left_s is None or job.is_cancelling:
            return share
        seconds = max(round(left_s), 1)
        return self.tr("{share}, about {seconds} s left").format(share=share, seconds=seconds)

    def _rest(self, text: str) -> None:
        self._text.setText(text)
        self._left.clear()
        self._bar.hide()
        self._cancel.hide()
