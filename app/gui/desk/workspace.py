"""The open session and the parameters of the next run; every change of them can be undone."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QUndoCommand, QUndoStack

from app.library.session_folder import remembered_parameters, rename_session
from app.operations.session import SessionTask
from core.errors import InputError, SessionError
from core.parameters import Parameters, load_preset
from core.pipeline.freshness import Freshness, finished_records, freshness
from core.pipeline.session_view import PoursFacts, SessionView, VerdictFacts
from core.session import Session, StageRecord
from core.session.pour_runs import PourRun, pour_runs
from core.stages import GIVEN, MESH, STAGE_NAMES, stages_before

T = TypeVar("T")

_PROGRESS_OF = {"judgement": ("capacity",), "amount": ()}
"""Stages whose progress goes by other names, or that take no time."""
IMAGINING = ("risk", "retention", "quality", "colors")
"""What imagining brings up to date, with all before it."""
_OF_A_SCAN = ("reconstruction", "quality", "colors")


class Workspace(QObject):
    """The open session.

    Signals: `session_changed` when another session was opened; `renamed` when it is called something else;
    `parameters_changed` when the parameters or their preset are others; `edited` when somebody changed them;
    `stages_changed` when the freshness of a stage may have changed.

    Attributes:
        session: the open one; none at first.
        parameters: for the next run.
        preset_name: the preset they started from.
        preset: its parameters.
        stages: the freshness of each stage by its name; empty without a session.
        view: what the session held when the freshness was computed, read once; none without a session.
        runs: the pours that the arm had made by then, the oldest first.
        undo_stack: of parameter edits, among them the crop box.
    """

    session_changed = Signal()
    renamed = Signal()
    edited = Signal()
    parameters_changed = Signal()
    stages_changed = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.session: Session | None = None
        self.parameters = Parameters()
        self.preset_name = "default"
        self.preset = Parameters()
        self.stages: dict[str, Freshness] = {}
        self.view: SessionView | None = None
        self.runs: tuple[PourRun, ...] = ()
        self.undo_stack = QUndoStack(self)

    @property
    def folder(self) -> Path | None:
        """Of the open session."""
        return self.session.path if self.session is not None else None

    @property
    def session_name(self) -> str:
        """What the open session is called; empty without one."""
        return self.session.name if self.session is not None else ""

    def open(self, folder: Path) -> None:
        """Open a session, or start one in a new or empty folder, with the parameters it was last used with.

        Raises:
            PoursightError: it cannot be opened; the one that was open stays.
        """
        session = Session.create_or_open(folder)
        remembered = remembered_parameters(session.path) or ("default", Parameters())
        self.session, self.view, self.runs = session, None, ()
        self.undo_stack.clear()
        self._set(*remembered)
        self.session_changed.emit()
        self.refresh()

    def close(self) -> None:
        """Leave the session."""
        self.session, self.view, self.runs = None, None, ()
        self.undo_stack.clear()
        self.session_changed.emit()
        self.refresh()

    def rename(self, name: str) -> None:
        """Call the open session something else.

        Raises:
            PoursightError: the name is empty, or the folder cannot be written.
        """
        assert self.session is not None, "the open session"
        rename_session(self.session.path, name)
        self.session = Session.open(self.session.path)
        self.renamed.emit()

    def task(self) -> SessionTask:
        """Return what a job needs; a session must be open."""
        assert self.session is not None, "buttons that start a job are disabled without a session"
        return SessionTask(self.session.path, self.parameters, self.preset_name)

    def refresh(self) -> None:
        """Compute the freshness of the stages again."""
        if self.session is None:
            self.stages, self.view, self.runs = {}, None, ()
        else:
            records = finished_records(self.session.path)
            self.stages = freshness(self.session, self.parameters, records)
            self.view = SessionView(self.session, records)
            self.runs = tuple(pour_runs(self.session.path))
        self.stages_changed.emit()

    def steps_to(self, *ends: str) -> tuple[str, ...]:
        """Return the stale steps up to some stages, in order, as their progress is called."""
        source = MESH if self.has(MESH) else "reconstruction"
        wanted = {name for end in ends for name in stages_before(end, source)}
        if source == MESH:
            wanted -= set(_OF_A_SCAN)
        names = [name for name in STAGE_NAMES if name in wanted and name not in GIVEN]
        return tuple(
            step for name in names if not self.is_fresh(name) for step in _PROGRESS_OF.get(name, (name,))
        )

    def is_fresh(self, stage: str) -> bool:
        """Whether a stage is what the parameters would give."""
        return self.stages.get(stage) is Freshness.FRESH

    def has(self, stage: str) -> bool:
        """Whether a stage was finished, with whatever parameters."""
        return self.stages.get(stage, Freshness.EMPTY) is not Freshness.EMPTY

    def record(self, stage: str) -> StageRecord | None:
        """What a stage was made from, when the freshness was computed; none if it was not finished."""
        return None if self.view is None else self.view.finished.get(stage)

    @property
    def is_container(self) -> bool | None:
        """The verdict on the object; none if there is none that is up to date."""
        verdict = self._verdict if self.is_fresh("judgement") else None
        return None if verdict is None else verdict.is_open_container

    @property
    def is_undecided(self) -> bool:
        """Whether the verdict, if it is up to date, depends on what no view saw."""
        verdict = self._verdict
        return self.is_container is False and verdict is not None and verdict.is_undecided

    @property
    def pours(self) -> PoursFacts | None:
        """The imagined pours in numbers; none without them, or where their files are damaged."""
        return self._read(lambda view: view.pours)

    @property
    def _verdict(self) -> VerdictFacts | None:
        """None also where its files are damaged."""
        return self._read(lambda view: view.verdict)

    def _read(self, read: Callable[[SessionView], T | None]) -> T | None:
        """Return what the session holds; none where its files are damaged: the page that shows it says so."""
        try:
            return None if self.view is None else read(self.view)
        except SessionError:
            return None

    def edit(self, parameters: Parameters, text: str) -> None:
        """Use other parameters from now on; `text` names the change for the undo menu."""
        if parameters != self.parameters:
            self.undo_stack.push(_Edit(self, (self.preset_name, parameters), text))

    def choose_preset(self, name_or_file: str) -> None:
        """Start from a preset.

        Raises:
            InputError: there is no such preset.
        """
        chosen = name_or_file, load_preset(name_or_file)
        self.undo_stack.push(_Edit(self, chosen, self.tr("preset {name}").format(name=name_or_file)))

    def _set(self, preset_name: str, parameters: Parameters) -> None:
        self.parameters = parameters
        if preset_name != self.preset_name:
            self.preset_name, self.preset = _preset(preset_name)
        self.parameters_changed.emit()


def _preset(name: str) -> tuple[str, Parameters]:
    """A preset; where its file has gone, the defaults serve for comparison."""
    try:
        return name, load_preset(name)
    except InputError:
        return "default", Parameters()


class _Edit(QUndoCommand):
    """From one set of parameters to another."""

    def __init__(self, workspace: Workspace, after: tuple[str, Parameters], text: str) -> None:
        super().__init__(text)
        self._workspace = workspace
        self._before = workspace.preset_name, workspace.parameters
        self._after = after

    def redo(self) -> None:
        self._use(self._after)

    def undo(self) -> None:
        self._use(self._before)

    def _use(self, parameters: tuple[str, Parameters]) -> None:
        self._workspace._set(*parameters)
        self._workspace.edited.emit()
        self._workspace.refresh()
