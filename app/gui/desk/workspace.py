"""The open session and the parameters that the next run will use; every change of them can be undone."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QUndoCommand, QUndoStack

from app.jobs.session_work import SessionTask
from app.remembered import remembered_parameters
from core.errors import InputError
from core.files import read_json
from core.parameters import Parameters, load_preset
from core.pipeline.needs import Freshness, freshness
from core.session import Session


class Workspace(QObject):
    """What is on the table.

    Signals: `session_changed` when another session was opened; `parameters_changed` when the parameters or
    their preset are others; `stages_changed` when a stage may stand differently than before.

    Attributes:
        session: the open one; none at first.
        parameters: for the next run.
        preset_name: the preset they started from.
        preset: its parameters.
        stages: how each stage of the session stands, by its name; empty without a session.
        undo_stack: of parameter edits, among them the crop box.
    """

    session_changed = Signal()
    parameters_changed = Signal()
    stages_changed = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.session: Session | None = None
        self.parameters = Parameters()
        self.preset_name = "default"
        self.preset = Parameters()
        self.stages: dict[str, Freshness] = {}
        self.undo_stack = QUndoStack(self)

    @property
    def folder(self) -> Path | None:
        """Of the open session."""
        return self.session.path if self.session is not None else None

    def open(self, folder: Path) -> None:
        """Open a session, or start one in a new or empty folder, with the parameters it was last used with.

        Raises:
            PoursightError: it cannot be opened; the one that was open stays.
        """
        session = Session.create_or_open(folder)
        remembered = remembered_parameters(session.path) or ("default", Parameters())
        self.session = session
        self.undo_stack.clear()
        self._set(*remembered)
        self.session_changed.emit()
        self.refresh()

    def close(self) -> None:
        """Leave the session."""
        self.session = None
        self.undo_stack.clear()
        self.session_changed.emit()
        self.refresh()

    def task(self) -> SessionTask:
        """Return what a job needs to know; a session must be open."""
        assert self.session is not None, "buttons that start a job are disabled without a session"
        return SessionTask(self.session.path, self.parameters, self.preset_name)

    def refresh(self) -> None:
        """Look again how the stages stand."""
        self.stages = {} if self.session is None else freshness(self.session, self.parameters)
        self.stages_changed.emit()

    def is_fresh(self, stage: str) -> bool:
        """Whether a stage is what the parameters would give."""
        return self.stages.get(stage) is Freshness.FRESH

    def has(self, stage: str) -> bool:
        """Whether a stage was finished, with whatever parameters."""
        return self.stages.get(stage, Freshness.EMPTY) is not Freshness.EMPTY

    @property
    def is_container(self) -> bool | None:
        """The verdict on the object, as far as it is up to date; none if it is not."""
        if self.session is None or not self.is_fresh("containability"):
            return None
        table = read_json(self.session.folder("containability") / "containability.json")
        return bool(table["is_open_container"])

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
    """A preset; one whose file has gone meanwhile leaves the defaults to compare with."""
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
        self._workspace.refresh()
