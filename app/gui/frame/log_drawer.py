"""Everything that was told since the program was started, newest at the bottom."""

from __future__ import annotations

from datetime import datetime

from PySide6.QtWidgets import QFrame, QPlainTextEdit, QVBoxLayout

from app.gui.desk.jobs import Jobs, RunningJob
from app.jobs.messages import Failed

_HEIGHT_PX = 150
_MOST_LINES = 2000


class LogDrawer(QFrame):
    """Opened from the job bar."""

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
        self.setFixedHeight(_HEIGHT_PX)
        jobs.started.connect(lambda job: self.add(self.tr("{title}: begun.").format(title=job.title)))
        jobs.finished.connect(lambda job, _: self.add(self.tr("{title}: done.").format(title=job.title)))
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
