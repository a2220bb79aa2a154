"""The parameter editor as pages hold it: undo, presets and saving them go through the workspace."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import QStandardPaths, Qt, Signal
from PySide6.QtWidgets import QFileDialog, QPushButton, QToolButton, QVBoxLayout, QWidget

from app.gui.desk.desk import Desk
from app.gui.desk.workspace import Workspace
from app.gui.pages.saved_presets import preset_names, preset_tips, save_preset
from app.gui.remedies import worded
from app.gui.theme import GRID_PX
from app.gui.views.parameter_editor.editor import ParameterEditor
from core.errors import InputError, SessionError
from core.parameters import Parameters, difference

_FOLDED_EDITOR_PX = 46 * GRID_PX


class ParametersPart(QWidget):
    """The editor of some groups, with "Save as preset"; slow to make: make it when it is to be seen.

    Attributes:
        editor: shows the workspace's parameters.
    """

    def __init__(self, desk: Desk, groups: Sequence[str]) -> None:
        super().__init__()
        self.setObjectName("parameters_part")
        self._workspace = desk.workspace
        self._message = desk.message
        self.editor = ParameterEditor(groups)
        self._offer_presets()
        self.editor.edited.connect(self._edit)
        self.editor.preset_chosen.connect(self.choose_preset)
        self._save = QPushButton(self.tr("Save as preset ..."))
        self._save.setObjectName("save_preset")
        self._save.setProperty("role", "link")
        self._save.setToolTip(
            self.tr("Save all parameters to a file, for other objects and the command line")
        )
        self._save.clicked.connect(self._ask_where)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX // 2)
        column.addWidget(self.editor, 1)
        column.addWidget(self._save)
        desk.workspace.parameters_changed.connect(self._show)
        self._show()

    def choose_preset(self, name_or_file: str) -> None:
        """Start from a preset; if it cannot be used, say so and leave everything as it is."""
        try:
            self._workspace.choose_preset(name_or_file)
        except InputError as error:
            self._message.emit(worded(error))
            self._show()

    def save_as(self, path: Path) -> None:
        """Save the parameters as a preset, and go on from it."""
        try:
            save_preset(path, self._workspace.parameters)
        except SessionError as error:
            self._message.emit(worded(error))
            return
        self._offer_presets()
        self.choose_preset(str(path))

    def _offer_presets(self) -> None:
        names = preset_names()
        self.editor.set_preset_names(names, preset_tips(names))

    def _ask_where(self) -> None:
        folder = QStandardPaths.writableLocation(QStandardPaths.StandardLocation.DocumentsLocation)
        path, _ = QFileDialog.getSaveFileName(
            self,
            self.tr("Save as preset"),
            str(Path(folder) / "my-preset.json"),
            self.tr("Presets (*.json)"),
        )
        if path:
            self.save_as(Path(path).with_suffix(".json"))

    def _edit(self, parameters: Parameters) -> None:
        names = list(difference(parameters, self._workspace.parameters))
        self._workspace.edit(parameters, ", ".join(name.rsplit(".", 1)[-1] for name in names))

    def _show(self) -> None:
        workspace = self._workspace
        self.editor.set_parameters(workspace.parameters, workspace.preset_name, workspace.preset)


class FoldedParameters(QWidget):
    """The same under a header that opens and closes it, and says how many differ.

    Signals: `opened` when there is suddenly more to see.
    """

    opened = Signal()

    def __init__(self, desk: Desk, groups: Sequence[str]) -> None:
        super().__init__()
        self.setObjectName("folded_parameters")
        self._header = QToolButton()
        self._header.setObjectName("parameters_header")
        self._header.setCheckable(True)
        self._header.setAutoRaise(True)
        self._header.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self._header.setToolTip(self.tr("Show or hide the parameters of this page"))
        self._header.setArrowType(Qt.ArrowType.RightArrow)
        self._header.toggled.connect(self._fold)
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(0, 0, 0, 0)
        self._column.setSpacing(GRID_PX // 2)
        self._column.addWidget(self._header)
        self._desk, self._groups = desk, tuple(groups)
        self._part: ParametersPart | None = None
        desk.workspace.parameters_changed.connect(self._count)
        self._count()

    @property
    def part(self) -> ParametersPart:
        """What is folded away; made when it is first wanted."""
        if self._part is None:
            self._part = ParametersPart(self._desk, self._groups)
            self._part.setMinimumHeight(_FOLDED_EDITOR_PX)
            self._part.setVisible(self._header.isChecked())
            self._column.addWidget(self._part, 1)
        return self._part

    def _count(self) -> None:
        n = n_different(self._desk.workspace, self._groups)
        if n == 0:
            text = self.tr("Parameters — as in the preset")
        elif n == 1:
            text = self.tr("Parameters — 1 differs from preset")
        else:
            text = self.tr("Parameters — {n} differ from preset")
        self._header.setText(text.format(n=n))

    def _fold(self, is_open: bool) -> None:
        self._header.setArrowType(Qt.ArrowType.DownArrow if is_open else Qt.ArrowType.RightArrow)
        self.part.setVisible(is_open)
        if is_open:
            self.opened.emit()


def n_different(workspace: Workspace, groups: Sequence[str]) -> int:
    """Return how many parameters of some groups differ from the preset they started from."""
    names = difference(workspace.parameters, workspace.preset)
    return sum(name.split(".")[0] in groups for name in names)
