"""The ways out of the program for a session, and the file dialogs before them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from PySide6.QtCore import QCoreApplication, QStandardPaths
from PySide6.QtWidgets import QFileDialog, QWidget

from app.jobs.library_work import LibraryWork


@dataclass(frozen=True)
class ExportKind:
    """One of the files that a session can become.

    Attributes:
        key: names it in the program.
        suffix: of the file, without the dot.
        method: of `LibraryWork`, that writes it.
        needs_report: whether it is the report, so that there must be a verdict to tell of.
    """

    key: str
    suffix: str
    method: Callable[..., Any]
    needs_report: bool

    @property
    def filter(self) -> str:
        """What the file dialog lists."""
        translate = QCoreApplication.translate
        filters = {
            "html": translate("History", "Report for a browser (*.html)"),
            "pdf": translate("History", "Report for paper (*.pdf)"),
            "zip": translate("History", "Whole session (*.zip)"),
        }
        return filters[self.key]


KINDS = (
    ExportKind("html", "html", LibraryWork.export_html, True),
    ExportKind("pdf", "pdf", LibraryWork.export_pdf, True),
    ExportKind("zip", "zip", LibraryWork.export_zip, False),
)


def documents_folder() -> Path:
    """Return where files go unless somebody chose another folder."""
    place = QStandardPaths.writableLocation(QStandardPaths.StandardLocation.DocumentsLocation)
    folder = Path(place or Path.home())
    return folder if folder.is_dir() else Path.home()


def ask_target(
    parent: QWidget, kind: ExportKind, session: Path, folder: Path, then: Callable[[Path], None]
) -> None:
    """Ask what file a session is to become; nothing happens if nobody answers."""
    title = QCoreApplication.translate("History", "Export {name}").format(name=session.name)
    dialog = QFileDialog(parent, title, str(folder), kind.filter)
    dialog.setObjectName("export_dialog")
    dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
    dialog.setDefaultSuffix(kind.suffix)
    dialog.selectFile(f"{session.name}.{kind.suffix}")
    _open(dialog, then)


def ask_archive(parent: QWidget, folder: Path, then: Callable[[Path], None]) -> None:
    """Ask which exported session to take in."""
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
