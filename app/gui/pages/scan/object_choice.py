"""What is to be scanned: in a simulated cell one of the built-in objects or a mesh file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QCheckBox, QComboBox, QFileDialog, QLabel, QVBoxLayout, QWidget

from app.gui.pages.scan.words import object_title
from app.gui.theme import GRID_PX

if TYPE_CHECKING:
    from hardware.cell import CellSettings

MESH_ENDINGS = (".obj", ".ply", ".stl")
_DEFAULT = "mug"
_FILE = "\0file"
"""Of the entry that opens a dialog; no object is called so."""


class ObjectChoice(QWidget):
    """Asks for the object, or says where to put it.

    Attributes:
        changed: something else is to be scanned, or the user saw to the arm's surroundings.
    """

    changed = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("object_choice")
        self._heading = QLabel(self.tr("Object on the platform"))
        self._heading.setProperty("role", "heading")
        self._combo = QComboBox()
        self._combo.setObjectName("object")
        self._combo.setAccessibleName(self.tr("Object on the simulated platform"))
        self._combo.setToolTip(self.tr("What stands on the platform of the simulated cell"))
        self._said = QLabel()
        self._said.setObjectName("place_object")
        self._said.setWordWrap(True)
        self._is_clear = QCheckBox(self.tr("The area is clear, STOP is within reach"))
        self._is_clear.setObjectName("area_clear")
        self._is_clear.setToolTip(self.tr("The arm moves as soon as the scan begins"))
        self._source = _DEFAULT
        self._kind = ""
        self._moves = False
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX // 2)
        for widget in (self._heading, self._combo, self._said, self._is_clear):
            column.addWidget(widget)
        self._combo.activated.connect(self._pick)
        self._is_clear.toggled.connect(lambda _: self.changed.emit())
        self.show_cell(None)

    @property
    def source(self) -> str | None:
        """An object's name or a mesh file; none in a cell that is not simulated."""
        return self._source if self._kind == "simulated" else None

    @property
    def is_ready(self) -> bool:
        """Whether a scan may begin, as far as the object and the surroundings go."""
        return bool(self._kind) and (not self._moves or self._is_clear.isChecked())

    def set_names(self, names: tuple[str, ...]) -> None:
        """Offer the built-in objects."""
        with QSignalBlocker(self._combo):
            self._combo.clear()
            for name in names:
                self._combo.addItem(object_title(name), name)
            self._combo.insertSeparator(self._combo.count())
            self._combo.addItem(self.tr("Mesh file …"), _FILE)
        self.choose(self._source)

    def show_cell(self, cell: CellSettings | None) -> None:
        """Ask for what this cell needs."""
        self._kind = _kind(cell)
        self._moves = cell is not None and cell.robot.kind == "ur5"
        texts = {
            "": self.tr("Reading the cell's file …"),
            "simulated": "",
            "real": self.tr("Put the object on the platform, inside the box that is drawn in the view."),
            "replay": self.tr("This cell plays a recorded scan: nothing moves."),
        }
        self._said.setText(texts[self._kind])
        self._said.setVisible(bool(texts[self._kind]))
        self._combo.setVisible(self._kind == "simulated")
        self._is_clear.setVisible(self._moves)

    def choose(self, source: str) -> None:
        """Choose an object by its name, or a mesh by its file."""
        self._source = source
        index = self._combo.findData(source)
        if index < 0:
            index = max(self._combo.count() - 2, 0)  # before the separator
            self._combo.insertItem(index, object_title(source), source)
            self._combo.setItemData(index, source, Qt.ItemDataRole.ToolTipRole)
        with QSignalBlocker(self._combo):
            self._combo.setCurrentIndex(index)
        self.changed.emit()

    def forget_clearance(self) -> None:
        """Each scan of a real cell asks anew whether the area is clear."""
        self._is_clear.setChecked(False)

    def _pick(self, index: int) -> None:
        picked = self._combo.itemData(index)
        if picked != _FILE:
            self.choose(str(picked))
            return
        pattern = " ".join(f"*{ending}" for ending in MESH_ENDINGS)
        path, _ = QFileDialog.getOpenFileName(
            self, self.tr("Mesh of the object"), str(Path.home()), self.tr("Meshes") + f" ({pattern})"
        )
        self.choose(path or self._source)


def _kind(cell: CellSettings | None) -> str:
    if cell is None:
        return ""
    if cell.is_simulated:
        return "simulated"
    return "replay" if cell.camera.kind == "replay" else "real"
