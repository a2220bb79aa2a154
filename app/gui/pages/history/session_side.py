"""The selected session in the side panel: what is known of it, and what can be done with it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from PySide6.QtCore import QCoreApplication, QStandardPaths, Qt, QUrl, Signal
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import (
    QFileDialog,
    QFormLayout,
    QLabel,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from app.gui.pages.history import words
from app.gui.pages.layouts import row_of
from app.gui.theme import GRID_PX
from app.gui.views.labels import heading, say, text_label
from app.gui.views.painting import tabular
from app.jobs.library_work import LibraryWork
from app.library.summary import SessionSummary


@dataclass(frozen=True)
class ExportKind:
    """One of the files that a session can become.

    Attributes:
        key: names it in the program; also the file's suffix.
        method: of `LibraryWork`, that writes it.
        needs: the stage without which there is nothing to write; empty: none.
    """

    key: str
    method: Callable[..., Any]
    needs: str


KINDS = (
    ExportKind("html", LibraryWork.export_html, "containability"),
    ExportKind("pdf", LibraryWork.export_pdf, "containability"),
    ExportKind("zip", LibraryWork.export_zip, ""),
    ExportKind("ply", LibraryWork.export_model, "colors"),
    ExportKind("glb", LibraryWork.export_model, "colors"),
)


def documents_folder() -> Path:
    """Return where files go unless somebody chose another folder."""
    place = QStandardPaths.writableLocation(QStandardPaths.StandardLocation.DocumentsLocation)
    folder = Path(place or Path.home())
    return folder if folder.is_dir() else Path.home()


def ask_target(
    parent: QWidget, kind: ExportKind, session: Path, folder: Path, then: Callable[[Path], None]
) -> None:
    """Ask which file to export a session to; nothing happens if the dialog is cancelled."""
    translate = QCoreApplication.translate
    filters = {
        "html": translate("History", "Report for a browser (*.html)"),
        "pdf": translate("History", "Report for paper (*.pdf)"),
        "zip": translate("History", "Whole session (*.zip)"),
        "ply": translate("History", "Coloured model to measure (*.ply)"),
        "glb": translate("History", "Coloured model to show (*.glb)"),
    }
    title = translate("History", "Export {name}").format(name=session.name)
    dialog = QFileDialog(parent, title, str(folder), filters[kind.key])
    dialog.setObjectName("export_dialog")
    dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
    dialog.setDefaultSuffix(kind.key)
    dialog.selectFile(f"{session.name}.{kind.key}")
    _open(dialog, then)


def ask_archive(parent: QWidget, folder: Path, then: Callable[[Path], None]) -> None:
    """Ask which exported session to import."""
    title = QCoreApplication.translate("History", "Import a session")
    filters = QCoreApplication.translate("History", "Exported sessions (*.zip)")
    dialog = QFileDialog(parent, title, str(folder), filters)
    dialog.setObjectName("import_dialog")
    dialog.setFileMode(QFileDialog.FileMode.ExistingFile)
    _open(dialog, then)


def _open(dialog: QFileDialog, then: Callable[[Path], None]) -> None:
    dialog.fileSelected.connect(lambda file: then(Path(file)))
    dialog.finished.connect(dialog.deleteLater)
    dialog.open()


def open_folder(folder: Path) -> None:
    """Show a folder in the file manager."""
    QDesktopServices.openUrl(QUrl.fromLocalFile(str(folder)))


class SessionPart(QWidget):
    """Facts and buttons of one session.

    Signals: `export_wanted` with an `ExportKind`; `compare_wanted`, `rename_wanted`, `forget_wanted` and
    `trash_wanted` when their buttons are pressed.
    """

    export_wanted = Signal(object)
    compare_wanted = Signal()
    rename_wanted = Signal()
    forget_wanted = Signal()
    trash_wanted = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._folder = Path()
        self._name = _breaking("session_name", "title")
        self._verdict = text_label("session_verdict", "verdict")
        self._problem = _breaking("session_problem")
        self._facts: dict[str, QLabel] = {}
        self._exports: dict[ExportKind, QPushButton] = {}
        self._compare = _button("compare_with_open", self.tr("Compare with the open session"))
        self._compare.clicked.connect(self.compare_wanted)
        hint = self.tr("Hold Ctrl and click a second card to compare two sessions.")
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX)
        for label in (self._name, self._verdict, self._problem):
            column.addWidget(label)
        column.addLayout(self._build_facts())
        column.addWidget(heading(self.tr("Compare")))
        column.addLayout(row_of(self._compare))
        column.addWidget(text_label("compare_hint", "muted", hint))
        column.addWidget(heading(self.tr("Export")))
        column.addLayout(self._build_exports())
        column.addWidget(heading(self.tr("Keep or delete")))
        column.addLayout(self._build_keeping())

    def _build_facts(self) -> QFormLayout:
        self._form = QFormLayout()
        self._form.setHorizontalSpacing(2 * GRID_PX)
        self._form.setVerticalSpacing(GRID_PX // 2)
        self._form.setLabelAlignment(Qt.AlignmentFlag.AlignLeft)
        inside = self.tr("Share of the poured candies that land inside, as imagined")
        for key, title, tip in (
            ("made", self.tr("Made"), self.tr("When the session was started, by this computer's clock")),
            ("from", self.tr("From"), self.tr("Where the object's surface comes from")),
            ("views", self.tr("Views"), self.tr("Images of the scan")),
            ("best", self.tr("Best pour"), inside),
            ("chosen", self.tr("Chosen pour"), inside),
            ("outcome", self.tr("Outcome"), self.tr("How the latest pour by an arm ended")),
            ("size", self.tr("Size"), self.tr("Space on the disk")),
        ):
            name, value = text_label("", "muted", title), _breaking(f"fact_{key}")
            value.setFont(tabular(self.font()))
            for label in (name, value):
                label.setToolTip(tip)
            self._form.addRow(name, value)
            self._facts[key] = value
        return self._form

    def _build_exports(self) -> QVBoxLayout:
        texts = {
            "html": (self.tr("HTML…"), self.tr("The report as one file for a browser")),
            "pdf": (self.tr("PDF…"), self.tr("The report for paper, A4")),
            "zip": (self.tr("ZIP…"), self.tr("The whole session; another Poursight can import it")),
            "ply": (self.tr("PLY…"), self.tr("The model in its photographed colours, to measure")),
            "glb": (
                self.tr("GLB…"),
                self.tr("The model in its photographed colours, for slides and viewers"),
            ),
        }
        for kind in KINDS:
            button = _button(f"export_{kind.key}", *texts[kind.key])
            button.clicked.connect(lambda _=False, wanted=kind: self.export_wanted.emit(wanted))
            self._exports[kind] = button
        rows = QVBoxLayout()
        rows.setSpacing(GRID_PX)
        for are_models in (False, True):
            kinds = [kind for kind in KINDS if (kind.method is LibraryWork.export_model) == are_models]
            rows.addLayout(row_of(*(self._exports[kind] for kind in kinds)))
        return rows

    def _build_keeping(self) -> QVBoxLayout:
        show = _button("show_folder", self.tr("Show folder"))
        show.clicked.connect(lambda: open_folder(self._folder))
        self._forget = _button(
            "forget",
            self.tr("Remove from list"),
            self.tr("The session is in another folder and stays there"),
        )
        self._forget.clicked.connect(self.forget_wanted)
        self._trash = _button("trash", self.tr("Delete…"), self.tr("Move the session to the trash"))
        self._trash.clicked.connect(self.trash_wanted)
        self._rename = _button("rename", self.tr("Rename…"), self.tr("Its folder keeps its name"))
        self._rename.clicked.connect(self.rename_wanted)
        rows = QVBoxLayout()
        rows.setSpacing(GRID_PX)
        for widgets in ((show, self._rename, self._trash), (self._forget,)):
            rows.addLayout(row_of(*widgets))
        return rows

    def show_session(
        self, session: SessionSummary, *, is_elsewhere: bool, can_compare: bool, is_idle: bool
    ) -> None:
        """Show a session, and what can be done with it.

        Args:
            session: to show.
            is_elsewhere: whether its folder is not in the library's.
            can_compare: whether another session is open to compare with.
            is_idle: whether no job is running.
        """
        self._folder = session.path
        self._name.setText(session.name)
        self._verdict.setText(f"{words.verdict_mark(session)[0]} {words.verdict_sentence(session)}")
        say(self._problem, session.problem)
        facts = {
            "made": words.date_words(session),
            "from": session.source,
            "views": str(session.n_views or ""),
            "best": words.best_words(session),
            "chosen": words.chosen_words(session),
            "outcome": session.outcome or words.outcome_words(session),
            "size": "" if session.problem else f"{session.size_bytes / 1e6:.1f} MB",
        }
        for key, text in facts.items():
            self._facts[key].setText(text)
            self._form.setRowVisible(self._facts[key], bool(text))
        self._rename.setEnabled(is_idle and not session.problem)
        for kind, button in self._exports.items():
            is_there = not kind.needs or kind.needs in session.stages
            button.setEnabled(is_idle and is_there and not session.problem)
        self._compare.setVisible(can_compare)
        self._forget.setVisible(is_elsewhere)
        self._trash.setEnabled(is_idle)


class TrashBox(QWidget):
    """Asks before a session is deleted.

    Signals: `agreed` with the session.
    """

    agreed = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self._session: SessionSummary | None = None
        self._question = text_label("trash_question")
        self._yes, no = _button("trash_yes", ""), _button("trash_no", self.tr("Keep it"))
        self._yes.clicked.connect(self._agree)
        no.clicked.connect(self.hide)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX)
        column.addWidget(self._question)
        column.addLayout(row_of(self._yes, no))
        self.hide()

    def ask(self, session: SessionSummary, *, is_open: bool) -> None:
        """Ask whether a session may go; one that is open has to be closed first."""
        self._session = session
        if is_open:
            question = self.tr("'{name}' is the open session. Close it and move it to the trash?")
            self._yes.setText(self.tr("Close and move to trash"))
        else:
            question = self.tr("Move '{name}' to the trash? It can be restored from there.")
            self._yes.setText(self.tr("Move to trash"))
        self._question.setText(question.format(name=session.name))
        self.show()
        self._yes.setFocus()

    def set_can_agree(self, can: bool) -> None:
        """Say whether it may be deleted now: not while a job is running."""
        self._yes.setEnabled(can)

    def _agree(self) -> None:
        self.hide()
        self.agreed.emit(self._session)


class Notice(QWidget):
    """One sentence about what was just done, and the folder of the file it is about."""

    def __init__(self) -> None:
        super().__init__()
        self._file = Path()
        self._sentence = _breaking("notice")
        self._show = _button("notice_folder", self.tr("Open its folder"))
        self._show.clicked.connect(lambda: open_folder(self._file.parent))
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX // 2)
        column.addWidget(self._sentence)
        column.addLayout(row_of(self._show))
        self.hide()

    def say(self, sentence: str, file: Path | None = None) -> None:
        """Say something; with a file, its folder can be opened."""
        self._file = file or Path()
        self._sentence.setText(sentence)
        self._sentence.setToolTip(sentence)
        self._show.setVisible(file is not None)
        self.show()


def _breaking(name: str, role: str = "") -> QLabel:
    """A label that a long word does not make wider than its panel."""
    label = text_label(name, role)
    label.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
    return label


def _button(name: str, text: str, tip: str = "") -> QPushButton:
    button = QPushButton(text)
    button.setObjectName(name)
    button.setToolTip(tip)
    return button
