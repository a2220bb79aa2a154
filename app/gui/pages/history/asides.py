"""The two boxes at the foot of the side panel: the question before deleting, and what an export became."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QUrl, Signal
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QSizePolicy, QVBoxLayout, QWidget

from app.gui.theme import GRID_PX
from app.library.summary import SessionSummary


def open_folder(folder: Path) -> None:
    """Show a folder in the file manager."""
    QDesktopServices.openUrl(QUrl.fromLocalFile(str(folder)))


class TrashBox(QWidget):
    """Asks before a session is deleted.

    Signals: `agreed` with the session.
    """

    agreed = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("trash_box")
        self._session: SessionSummary | None = None
        self._question = QLabel()
        self._question.setObjectName("trash_question")
        self._question.setWordWrap(True)
        self._yes = QPushButton()
        self._yes.setObjectName("trash_yes")
        self._yes.clicked.connect(self._agree)
        no = QPushButton(self.tr("Keep it"))
        no.setObjectName("trash_no")
        no.clicked.connect(self.hide)
        row = QHBoxLayout()
        row.setSpacing(GRID_PX)
        row.addWidget(self._yes)
        row.addWidget(no)
        row.addStretch(1)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX)
        column.addWidget(self._question)
        column.addLayout(row)
        self.hide()

    def ask(self, session: SessionSummary, *, is_open: bool) -> None:
        """Ask whether a session may go; one that is open has to be closed first."""
        self._session = session
        if is_open:
            said = self.tr("'{name}' is the open session. Close it and move it to the trash?")
            self._yes.setText(self.tr("Close and move to trash"))
        else:
            said = self.tr("Move '{name}' to the trash? It can be had back from there.")
            self._yes.setText(self.tr("Move to trash"))
        self._question.setText(said.format(name=session.name))
        self.show()
        self._yes.setFocus()

    def set_can_agree(self, can: bool) -> None:
        """Nothing is deleted while work is under way."""
        self._yes.setEnabled(can)

    def _agree(self) -> None:
        session, self._session = self._session, None
        self.hide()
        if session is not None:
            self.agreed.emit(session)


class Notice(QWidget):
    """One sentence about what was just done, and the folder of the file it is about."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("notice_box")
        self._file: Path | None = None
        self._said = QLabel()
        self._said.setObjectName("notice")
        self._said.setWordWrap(True)
        self._said.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self._show = QPushButton(self.tr("Open its folder"))
        self._show.setObjectName("notice_folder")
        self._show.clicked.connect(self._open)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX // 2)
        column.addWidget(self._said)
        row = QHBoxLayout()
        row.addWidget(self._show)
        row.addStretch(1)
        column.addLayout(row)
        self.hide()

    def say(self, sentence: str, file: Path | None = None) -> None:
        """Say something; with a file, its folder can be opened."""
        self._file = file
        self._said.setText(sentence)
        self._said.setToolTip(sentence)
        self._show.setVisible(file is not None)
        self.show()

    def _open(self) -> None:
        if self._file is not None:
            open_folder(self._file.parent)
