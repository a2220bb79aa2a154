"""The parameter editor as pages hold it: undo, presets and saving them go through the workspace."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import QCoreApplication, QStandardPaths, Qt, Signal
from PySide6.QtWidgets import QFileDialog, QPushButton, QToolButton, QVBoxLayout, QWidget

from app.gui.desk.desk import Desk
from app.gui.pages.saved_presets import preset_names, save_preset
from app.gui.theme import GRID_PX
from app.gui.views.parameter_editor import ParameterEditor
from core.errors import InputError, SessionError
from core.parameters import Parameters, difference

_FOLDED_EDITOR_PX = 46 * GRID_PX


class ParametersPart(QWidget):
    """The editor of some groups, with "Save as preset".

    Signals: `counted` with how many of its parameters differ from the preset.

    Attributes:
        editor: shows the workspace's parameters.
    """

    counted = Signal(int)

    def __init__(self, desk: Desk, groups: Sequence[str]) -> None:
        super().__init__()
        self.setObjectName("parameters_part")
        self._workspace = desk.workspace
        self._told = desk.told
        self.editor = ParameterEditor(groups, preset_names())
        self.editor.edited.connect(self._edit)
        self.editor.preset_chosen.connect(self.choose_preset)
        self._save = QPushButton(self.tr("Save as preset ..."))
        self._save.setObjectName("save_preset")
        self._save.setProperty("role", "link")
        self._save.setToolTip(
            self.tr("Keep all parameters in a file, for other objects and the command line")
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
        """Start from a preset; one that cannot be used is told of, and everything stays."""
        try:
            self._workspace.choose_preset(name_or_file)
        except InputError as error:
            self._told.emit(str(error))
            self._show()

    def save_as(self, path: Path) -> None:
        """Keep the parameters as a preset, and go on from it."""
        try:
            save_preset(path, self._workspace.parameters)
        except SessionError as error:
            self._told.emit(str(error))
            return
        self.editor.set_preset_names(preset_names())
        self.choose_preset(str(path))

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
        self.counted.emit(self.editor.n_different)


class FoldedParameters(QWidget):
    """The same under a header that opens and closes it, and tells how much differs.

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
        self.part = ParametersPart(desk, groups)
        self.part.setMinimumHeight(_FOLDED_EDITOR_PX)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX // 2)
        column.addWidget(self._header)
        column.addWidget(self.part, 1)
        self.part.counted.connect(self._count)
        self._header.toggled.connect(self._fold)
        self._count(self.part.editor.n_different)
        self._fold(False)

    def _count(self, n: int) -> None:
        self._header.setText(different_text(n))

    def _fold(self, is_open: bool) -> None:
        self._header.setArrowType(Qt.ArrowType.DownArrow if is_open else Qt.ArrowType.RightArrow)
        self.part.setVisible(is_open)
        if is_open:
            self.opened.emit()


def different_text(n: int) -> str:
    """Return the heading of parameters of which `n` differ from their preset."""
    tr = QCoreApplication.translate
    if n == 0:
        return tr("ParametersPart", "Parameters — as the preset")
    if n == 1:
        return tr("ParametersPart", "Parameters — 1 differs from preset")
    return tr("ParametersPart", "Parameters — {n} differ from preset").format(n=n)
