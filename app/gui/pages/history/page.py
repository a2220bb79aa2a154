"""The History page: every session there is, found again."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from PySide6.QtCore import QSignalBlocker
from PySide6.QtGui import QHideEvent
from PySide6.QtWidgets import QStackedWidget, QVBoxLayout
from typing_extensions import override

from app.gui.desk.desk import Desk
from app.gui.pages.history import words
from app.gui.pages.history.compared_models import ComparedModel, read_compared
from app.gui.pages.history.comparison_view import ComparisonView
from app.gui.pages.history.library_view import Found, LibraryView, Shelf
from app.gui.pages.history.session_side import (
    ExportKind,
    Notice,
    SessionPart,
    TrashBox,
    ask_archive,
    ask_target,
    documents_folder,
)
from app.gui.pages.page import Page, SidePanel, SplitView
from app.gui.views.labels import say, text_label
from app.gui.views.name_dialog import ask_name
from app.jobs.library_work import LibraryWork
from app.library.compare import Comparison, compare
from app.library.index import send_to_trash
from app.library.session_folder import rename_session
from app.library.summary import SessionSummary


class HistoryPage(Page):
    """Cards or a comparison at the left; the selected session and what can be done with it at the right."""

    KEY = "history"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self._host = desk.jobs.make_host(LibraryWork, "exports and imports")
        self._shelf = Shelf(desk.background, self)
        self._exports_to = documents_folder()
        self._to_select: Path | None = None
        self._list = LibraryView()
        self._comparison = ComparisonView()
        self._left = QStackedWidget()
        self._left.addWidget(self._list)
        self._left.addWidget(self._comparison)
        self._session = SessionPart()
        self._remark = text_label("remark")
        self._trash, self._notice = TrashBox(), Notice()
        self._side = SidePanel(self.tr("Open session"))
        for widget in (self._remark, self._session, self._trash, self._notice):
            self._side.body.addWidget(widget)
        self._side.body.addStretch(1)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(SplitView(self._left, self._side))
        self._connect()
        self._remember()
        self._update()

    def _connect(self) -> None:
        self._shelf.found.connect(self._show_found)
        for cards in (self._list.cards, self._comparison.cards):
            self._shelf.pictured.connect(cards.sessions.set_picture)
        self._list.searched.connect(self._shelf.search)
        self._list.import_wanted.connect(self._ask_archive)
        self._list.start_wanted.connect(self._start)
        self._list.cards.chosen.connect(self._on_chosen)
        self._list.cards.wanted.connect(self.open_session)
        self._comparison.left.connect(self._leave_comparison)
        self._session.export_wanted.connect(self._ask_target)
        self._session.compare_wanted.connect(self._compare_with_open)
        self._session.rename_wanted.connect(self._ask_name)
        self._session.forget_wanted.connect(self._forget)
        self._session.trash_wanted.connect(self._ask_trash)
        self._trash.agreed.connect(self.delete)
        self._side.primary.clicked.connect(self._press_primary)
        self.desk.workspace.session_changed.connect(self._remember)
        for signal in (self.desk.jobs.started, self.desk.jobs.finished, self.desk.jobs.failed):
            signal.connect(lambda *_: self._update())

    # What is shown

    def refresh(self) -> None:
        """Look for sessions again."""
        self._list.cards.set_open(self.desk.workspace.folder)
        self._shelf.refresh()
        self._update()

    @override
    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        self._is_outdated = True  # other programs write sessions, too
        self._shelf.pause()

    @property
    def selected(self) -> list[SessionSummary]:
        """The selected sessions, the oldest first."""
        return self._list.cards.selected

    def select(self, *folders: Path) -> None:
        """Select sessions by their folders."""
        self._list.cards.select(folders)

    def _show_found(self, found: Found) -> None:
        before = self.selected
        with QSignalBlocker(self._list.cards):  # this is nobody's choice
            self._list.show_found(found)
            self._select_something(found)
        self._side.setVisible(bool(found.n_all))
        if [session.path for session in before] != [session.path for session in self.selected]:
            self._trash.hide()
        self._update()

    def _select_something(self, found: Found) -> None:
        """What was imported, else what was selected, else the open session, else the newest."""
        wanted, self._to_select = self._to_select, None
        if wanted is not None:
            self.select(wanted)
        folders = [session.path for session in found.sessions]
        if folders and not self.selected:
            open_folder = self.desk.workspace.folder
            self.select(open_folder if open_folder in folders else folders[0])

    def _on_chosen(self) -> None:
        self._trash.hide()
        self._notice.hide()
        self._update()

    def _remember(self) -> None:
        folder = self.desk.workspace.folder
        if folder is not None:
            self._shelf.remember(folder)

    def _update(self) -> None:
        """Show the selection in the side panel, and enable what can be done with it now."""
        selected, is_idle = self.selected, self.desk.jobs.is_idle
        one = selected[0] if len(selected) == 1 and not self._is_comparing else None
        self._session.setVisible(one is not None)
        if one is not None:
            open_folder = self.desk.workspace.folder
            self._session.show_session(
                one,
                is_elsewhere=one.path.parent != self._shelf.root,
                can_compare=not one.problem and open_folder not in (None, one.path),
                is_idle=is_idle,
            )
        say(self._remark, "" if one is not None else self._remark_words(selected))
        self._trash.set_can_agree(is_idle)
        self._list.set_can_import(is_idle)
        text, is_enabled = self._primary_state(selected, is_idle)
        self._side.primary.setText(text)
        self._side.primary.setEnabled(is_enabled)

    @property
    def _is_comparing(self) -> bool:
        return self._left.currentWidget() is self._comparison

    def _remark_words(self, selected: list[SessionSummary]) -> str:
        if self._is_comparing:
            return self.tr(
                "Both models are seen from the same place, at the same scale: turn one, and the other turns. "
                "Line by line, the last column shows what changes from the left session to the right one."
            )
        if not selected:
            return self.tr("Select a session to see its details.")
        if len(selected) > 2:
            return self.tr(
                "{n} sessions are selected. Select one to see its details, or two to compare them."
            ).format(n=len(selected))
        bad = next((session for session in selected if session.problem), None)
        if bad is not None:
            return self.tr("{name} cannot be read, so it cannot be compared.").format(name=bad.name)
        both = "\n\n".join(words.spoken(session) for session in selected)
        return self.tr("Two sessions are selected:\n\n{both}").format(both=both)

    def _primary_state(self, selected: list[SessionSummary], is_idle: bool) -> tuple[str, bool]:
        """What the primary button does, and whether it can be done now."""
        if self._is_comparing:
            return self.tr("Back to sessions"), True
        if len(selected) == 2:
            return self.tr("Compare"), not any(session.problem for session in selected)
        if len(selected) == 1 and selected[0].path == self.desk.workspace.folder:
            return self.tr("Show results"), True
        can_open = len(selected) == 1 and not selected[0].problem and is_idle
        return self.tr("Open session"), can_open

    def _press_primary(self) -> None:
        selected = self.selected
        if self._is_comparing:
            self._leave_comparison()
        elif len(selected) == 2:
            self.compare(selected[0].path, selected[1].path)
        elif selected:
            self.open_session(selected[0])

    # What can be done

    def open_session(self, session: SessionSummary) -> None:
        """Open a session and show the last page of the workflow that has something to show."""
        is_open = session.path == self.desk.workspace.folder
        if is_open or self.desk.open_session(session.path):
            self.desk.page_wanted.emit(words.results_page(session))

    def compare(self, a: Path, b: Path) -> None:
        """Show two sessions side by side."""
        self.desk.background.run("history compare", partial(compare, a, b), self._show_comparison)

    def export(self, kind: ExportKind, session: Path, target: Path) -> None:
        """Write a session to a file."""
        self._exports_to = target.parent
        self._notice.hide()
        title = self.tr("Export {kind}").format(kind=kind.key.upper())
        self.desk.jobs.start(
            title, self.KEY, self._host, kind.method, session, target, then=self._on_exported
        )

    def import_zip(self, archive: Path) -> None:
        """Import an exported session."""
        self._exports_to = archive.parent
        self.desk.jobs.start(
            self.tr("Import ZIP"),
            self.KEY,
            self._host,
            LibraryWork.import_zip,
            archive,
            self._shelf.root,
            then=self._on_imported,
        )

    def delete(self, session: SessionSummary) -> None:
        """Move a session to the trash; the open one is closed first."""
        if session.path == self.desk.workspace.folder:
            self.desk.workspace.close()
            self.desk.page_wanted.emit(self.KEY)  # without a session the window goes to its first page
        trash = partial(send_to_trash, session.path)
        self.desk.background.run("history trash", trash, partial(self._on_deleted, session))

    def rename(self, folder: Path, name: str) -> None:
        """Call a session something else."""
        if folder == self.desk.workspace.folder:
            self.desk.rename_session(name)
            self._shelf.refresh()
        else:
            rename = partial(rename_session, folder, name)
            self.desk.background.run("history rename", rename, lambda _: self._shelf.refresh())

    def _ask_name(self) -> None:
        session = self.selected[0]
        ask_name(self, session.name, partial(self.rename, session.path))

    def _compare_with_open(self) -> None:
        folder, selected = self.desk.workspace.folder, self.selected
        if folder is not None and len(selected) == 1:
            self.compare(folder, selected[0].path)

    def _show_comparison(self, comparison: Comparison) -> None:
        self._comparison.show_comparison(comparison)
        self._left.setCurrentWidget(self._comparison)
        folders = comparison.a.path, comparison.b.path
        self.desk.background.run("history models", partial(_read_both, folders), self._comparison.show_models)
        self._update()

    def _leave_comparison(self) -> None:
        self._left.setCurrentWidget(self._list)
        self._list.cards.setFocus()
        self._update()

    def _ask_target(self, kind: ExportKind) -> None:
        session = self.selected[0].path
        ask_target(self, kind, session, self._exports_to, partial(self.export, kind, session))

    def _ask_archive(self) -> None:
        ask_archive(self, self._exports_to, self.import_zip)

    def _on_exported(self, target: Path) -> None:
        self._notice.say(self.tr("Exported to {file}").format(file=target), target)

    def _on_imported(self, folder: Path) -> None:
        self._to_select = folder
        self._shelf.refresh()

    def _forget(self) -> None:
        self._shelf.forget(self.selected[0].path)

    def _ask_trash(self) -> None:
        session = self.selected[0]
        self._notice.hide()
        self._trash.ask(session, is_open=session.path == self.desk.workspace.folder)

    def _on_deleted(self, session: SessionSummary, _nothing: None) -> None:
        self._notice.say(self.tr("'{name}' is in the trash.").format(name=session.name))
        self._shelf.refresh()

    def _start(self) -> None:
        self.desk.page_wanted.emit("welcome" if self.desk.workspace.session is None else "scan")


def _read_both(folders: tuple[Path, Path]) -> tuple[ComparedModel, ComparedModel]:
    return read_compared(folders[0]), read_compared(folders[1])
