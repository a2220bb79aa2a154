"""The Tune page: labelled objects, several sets of parameters, and which of them judges best."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

from PySide6.QtGui import QUndoCommand
from PySide6.QtWidgets import QFileDialog, QStackedWidget, QVBoxLayout
from typing_extensions import override

from app.gui.desk.desk import Desk
from app.gui.pages.page import Page, SidePanel, SplitView
from app.gui.pages.saved_presets import remember_preset, save_preset
from app.gui.pages.tuning.board_view import BoardView
from app.gui.pages.tuning.fit import FitPart
from app.gui.pages.tuning.object_pictures import ObjectPictures
from app.gui.pages.tuning.side import TuningSide
from app.gui.remedies import worded
from app.jobs.tuning_work import FitDone, JudgingTask, TuningWork, VerdictReached
from app.library.places import preset_file
from app.operations.tuning_board import (
    Board,
    ParameterSet,
    csv_text,
    last_source,
    load_board,
    read_verdicts,
    save_board,
)
from core.errors import InputError, PoursightError
from core.evaluation.fitting.provenance import write_fitted_preset
from core.evaluation.labels import LabelledObject
from core.parameters import Parameters, load_preset

Draft = tuple[str, Parameters]  # the preset that the next run started from, and its parameters


class TuningPage(Page):
    """Objects and sets at the left, the parameters for the next run at the right."""

    KEY = "tuning"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self._board: Board | None = None
        self._draft: Draft = "default", Parameters()
        self._is_loaded = False
        self._host = desk.jobs.make_host(TuningWork, "tunes")
        self._view = BoardView()
        self._side = TuningSide()
        self._pictures = ObjectPictures(self)
        self._fit: FitPart | None = None
        self._views, self._sides = QStackedWidget(), QStackedWidget()
        self._views.addWidget(self._view)
        self._sides.addWidget(self._side)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(SplitView(self._views, self._sides))
        self._connect()
        self._show(None)

    def _connect(self) -> None:
        side, view, jobs = self._side, self._view, self.desk.jobs
        side.primary.clicked.connect(self._go_on)
        side.run_selected.clicked.connect(self._run_selected)
        side.fit.clicked.connect(lambda: self.show_fit(True))
        side.save_wanted.connect(self._save_preset)
        side.editor.edited.connect(self._edit)
        side.editor.preset_chosen.connect(self._choose_preset)
        view.choose_wanted.connect(self._ask_for_objects)
        view.export_wanted.connect(self._ask_for_export)
        view.remove_wanted.connect(self._remove)
        view.set_selected.connect(self._take_set)
        self._pictures.drawn.connect(view.objects.show_picture)
        view.objects.itemSelectionChanged.connect(self._update_buttons)
        jobs.event_received.connect(self._hear)
        jobs.started.connect(lambda *_: self._update_buttons())
        jobs.finished.connect(lambda job, _result: self._read_again(job.page == self.KEY))
        jobs.failed.connect(lambda job, _failed: self._read_again(job.page == self.KEY))

    # The board

    @override
    def refresh(self) -> None:
        if not self._is_loaded:
            self._is_loaded = True
            self.desk.background.run("tuning", _last_board, self._arrive, self._fail)

    def open(self, source: Path) -> None:
        """Show the objects of a folder, with what was found about them before."""
        self._is_loaded = True
        self.desk.background.run("tuning", partial(load_board, source), self._open, self._fail)

    def _open(self, board: Board) -> None:
        self._save(board)
        self._arrive(board)

    def _arrive(self, board: Board | None) -> None:
        if board is not None and board.sets and self._board is None:
            self._draft = "default", board.sets[-1].parameters
        self._show(board)

    def _fail(self, error: PoursightError) -> None:
        self._show(self._board, worded(error))
        self._report(error)

    def _report(self, error: PoursightError) -> None:
        self.desk.message.emit(worded(error))

    def _show(self, board: Board | None, hint: str = "") -> None:
        self._board = board
        self._view.show_board(
            board,
            hint
            or self.tr(
                "Choose a folder of meshes with a CSV file that says for each id whether it is a container. "
                "Each object then gets a score by every set of parameters: the share of its convex hull that "
                "candies can fill, or Omega, the share of the candies that stay."
            ),
        )
        self._pictures.show(() if board is None else board.objects)
        self._show_draft()

    def _save(self, board: Board) -> None:
        try:
            save_board(board)
        except PoursightError as error:
            self._report(error)

    def _change(self, board: Board) -> None:
        self._save(board)
        self._show(board)

    def _remove(self, index: int) -> None:
        if self._board is not None:
            self._change(self._board.without_set(self._board.sets[index].name))

    # The parameters

    def _edit(self, parameters: Parameters) -> None:
        self._push((self._draft[0], parameters), self.tr("tuning parameter"))

    def _choose_preset(self, name: str) -> None:
        try:
            self._push((name, load_preset(name)), self.tr("preset {name}").format(name=Path(name).stem))
        except InputError as error:
            self._report(error)

    def _take_set(self, index: int) -> None:
        if self._board is not None and index < len(self._board.sets):
            one = self._board.sets[index]
            self._push((self._draft[0], one.parameters), one.name)

    def _push(self, draft: Draft, text: str) -> None:
        if draft != self._draft:
            self.desk.workspace.undo_stack.push(_DraftEdit(self, draft, text))

    def use_draft(self, draft: Draft) -> None:
        """Run with these parameters from now on."""
        self._draft = draft
        self._show_draft()

    def _show_draft(self) -> None:
        name, parameters = self._draft
        try:
            preset = load_preset(name)
        except InputError:  # its file has gone meanwhile
            name, preset = "default", Parameters()
        self._side.editor.set_parameters(parameters, name, preset)
        self._update_buttons()
        if self._fit is not None:
            self._fit.show_board(self._board, self._draft)

    def _save_preset(self, name: str) -> None:
        try:
            path = preset_file(name)
            self._write_preset(path)
        except PoursightError as error:
            self._report(error)
            return
        self._side.preset_saved()
        self.use_draft((str(path), self._draft[1]))
        self.desk.message.emit(self.tr("Saved as the preset '{name}'.").format(name=path.stem))

    def _write_preset(self, path: Path) -> None:
        """Save the draft; what was fitted says where it comes from."""
        parameters, sets = self._draft[1], () if self._board is None else self._board.sets
        fitted = next((one for one in sets if one.parameters == parameters and one.provenance), None)
        if fitted is None or fitted.provenance is None:
            save_preset(path, parameters)
            return
        write_fitted_preset(path, parameters, fitted.named, fitted.provenance)
        remember_preset(path)

    # Fitting

    def show_fit(self, is_wanted: bool) -> None:
        """Show what is needed to fit, or the objects again."""
        if self._fit is None:
            self._fit = FitPart(self.desk, self._host, self.KEY, self)
            self._fit.side.back_wanted.connect(lambda: self.show_fit(False))
            self._fit.found.connect(self._take_fitted)
            self._views.addWidget(self._fit.view)
            self._sides.addWidget(self._fit.side)
            self._fit.show_board(self._board, self._draft)
        for stack in (self._views, self._sides):
            stack.setCurrentIndex(1 if is_wanted else 0)

    @override
    def press_primary(self) -> None:
        shown = self._sides.currentWidget()
        if isinstance(shown, SidePanel) and shown.primary.isEnabled():
            shown.primary.click()

    def _take_fitted(self, parameters: Parameters, done: FitDone | None) -> None:
        """A fit ended: what it found is a set of its own, and the next run's."""
        if self._board is None:
            return
        if done is None:
            board, one = self._board.with_set(parameters)
        else:
            board, one = self._board.with_fitted_set(parameters, done.named, done.provenance)
        self._change(board)
        self._push((self._draft[0], one.parameters), self.tr("fitted parameters"))
        said = self.tr("{name} holds the fitted parameters; 'Run all' judges all objects with them.")
        self.desk.message.emit(said.format(name=one.name))

    # Running

    def _update_buttons(self) -> None:
        board, is_idle = self._board, self.desk.jobs.is_idle
        self._view.update_buttons(is_idle)
        self._side.run_selected.setVisible(board is not None)
        self._side.fit.setVisible(board is not None)
        self._side.run_selected.setEnabled(is_idle and bool(self._view.objects.selected_names()))
        if board is None:
            self._side.column_note.setText("")
            self._side.primary.setText(self.tr("Choose objects"))
            self._side.primary.setEnabled(is_idle)
            return
        known = board.set_of(self._draft[1])
        missing = len(board.objects) if known is None else len(board.undecided(known))
        self._side.column_note.setText(self._note(board, known, missing))
        self._side.primary.setText(self.tr("Run all"))
        self._side.primary.setEnabled(is_idle and missing > 0)

    def _note(self, board: Board, known: ParameterSet | None, missing: int) -> str:
        if known is None:
            name = board.with_set(self._draft[1])[1].name
            return self.tr("New parameters: a run adds {name}.").format(name=name)
        if missing:
            return self.tr("Same as {name}: {n} of {all} objects still to judge.").format(
                name=known.name, n=missing, all=len(board.objects)
            )
        return self.tr("Same as {name}: all objects are judged.").format(name=known.name)

    def _go_on(self) -> None:
        if self._board is None:
            self._ask_for_objects()
            return
        known = self._board.set_of(self._draft[1])
        self._run(self._board.objects if known is None else self._board.undecided(known))

    def _run_selected(self) -> None:
        if self._board is not None:
            wanted = set(self._view.objects.selected_names())
            self._run(tuple(one for one in self._board.objects if one.name in wanted))

    def _run(self, objects: tuple[LabelledObject, ...]) -> None:
        if self._board is None or not objects or not self.desk.jobs.is_idle:
            return
        board, one = self._board.with_set(self._draft[1])
        self._change(board)
        task = JudgingTask(objects, one.parameters, board.verdicts_folder(one))
        title = self.tr("Judge {n} objects with {name}").format(n=len(objects), name=one.name)
        self.desk.jobs.start(title, self.KEY, self._host, TuningWork.judge, task)

    def _hear(self, event: object) -> None:
        """A verdict came."""
        if not isinstance(event, VerdictReached) or self._board is None:
            return
        if event.folder.parent == self._board.folder:
            self._board = self._board.with_verdict(event.folder.name, event.verdict)
            self._view.objects.show_verdict(self._board, event.verdict.name)
            self._view.sets.show_board(self._board)

    def _read_again(self, is_ours: bool) -> None:
        """A job ended: if it judged objects, what is on the disk counts now."""
        self._update_buttons()
        board = self._board
        if is_ours and board is not None:
            self.desk.background.run("tuning", partial(read_verdicts, board), self._take_verdicts)

    def _take_verdicts(self, read: Board) -> None:
        """Show the verdicts that were read; sets may have come meanwhile."""
        board = self._board
        if board is not None and board.source == read.source:
            self._show(replace(board, verdicts={**board.verdicts, **read.verdicts}))

    def _ask_for_objects(self) -> None:
        folder = QFileDialog.getExistingDirectory(self, self.tr("Choose a folder of labelled objects"))
        if folder:
            self.open(Path(folder))

    def _ask_for_export(self) -> None:
        path, _ = QFileDialog.getSaveFileName(self, self.tr("Export the table"), "tuning.csv", "*.csv")
        if path:
            self.export(Path(path))

    def export(self, path: Path) -> None:
        """Write the table as CSV."""
        if self._board is None:
            return
        try:
            path.write_text(csv_text(self._board), encoding="utf-8")
        except OSError as error:
            said = self.tr("{path} cannot be written ({why}); choose another file.")
            self.desk.message.emit(said.format(path=path, why=error.strerror))


class _DraftEdit(QUndoCommand):
    """From one draft to another."""

    def __init__(self, page: TuningPage, after: Draft, text: str) -> None:
        super().__init__(text)
        self._page = page
        self._before, self._after = page._draft, after

    @override
    def redo(self) -> None:
        self._page.use_draft(self._after)

    @override
    def undo(self) -> None:
        self._page.use_draft(self._before)


def _last_board() -> Board | None:
    source = last_source()
    return None if source is None else load_board(source)
