"""The right of the Scan page: what is scanned, what the camera sees, and the buttons."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QSignalBlocker, QSize, Qt, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QFileDialog,
    QPushButton,
    QVBoxLayout,
    QWidget,
)
from typing_extensions import override

from app.gui.pages.layouts import row_of
from app.gui.pages.page import SidePanel
from app.gui.pages.scan.appearance import AppearanceRow
from app.gui.pages.scan.dropping import MESH_ENDINGS
from app.gui.pages.scan.loading import object_title
from app.gui.theme import GRID_PX
from app.gui.views.depth_image import DepthPanel, ImagePanel
from app.gui.views.labels import heading, say, text_label

if TYPE_CHECKING:
    from hardware.cell import CellSettings

_DEFAULT = "mug"
_FILE = "\0file"
"""Of the entry that opens a dialog; no object is called so."""


class ScanSide(SidePanel):
    """The controls of the page.

    Attributes:
        choice: of the object.
        start_over: discards what an interrupted scan left, and begins.
        take_again: the selected view.
        follow: shows the newest view again.
        import_folder, import_mesh: ask for what is to be imported.
        appearance: switches what lies over the colour image.
        file_chosen: the path of a folder or mesh that is to be imported.
    """

    file_chosen = Signal(object)

    def __init__(self) -> None:
        super().__init__(self.tr("Scan"))
        self.choice = ObjectChoice()
        self.start_over = self._button("start_over", self.tr("Start over"))
        self.start_over.setToolTip(self.tr("Discard the stored views and take all of them"))
        self.start_over.setMinimumHeight(self.primary.minimumHeight())
        self.add_button(self.start_over)
        self.take_again = self._button("take_again", self.tr("Take again"))
        self.follow = self._button("follow", self.tr("Show the newest"))
        self.import_folder = self._button("import_folder", self.tr("Import folder …"))
        self.import_folder.setToolTip(
            self.tr("Views taken elsewhere: rgbd/frame-*.color.png, .depth.png and .pose.txt")
        )
        self.import_mesh = self._button("import_mesh", self.tr("Import mesh …"))
        self.import_mesh.setToolTip(self.tr("A surface instead of a scan: .obj, .ply or .stl"))
        self._caption = heading(self.tr("What the camera sees"))
        self._caption.setObjectName("caption")
        self._image, self._depth = ImagePanel(), DepthPanel()
        self._problems = text_label("view_said")
        self._obstacle = text_label("obstacle", "attention")
        self._remark = text_label("remark", "muted")
        self._pictures = _Images(self._image, self._depth)
        self.appearance = AppearanceRow()
        self._arrange()
        self.import_folder.clicked.connect(self._ask_folder)
        self.import_mesh.clicked.connect(self._ask_mesh)
        self.show_problems("")
        self.remark("", "")

    def show_images(
        self, color: npt.NDArray[np.uint8] | None, depth_m: npt.NDArray[np.float32] | None
    ) -> None:
        """Show a view's colour (H, W, 3) and depth (H, W)."""
        self._image.set_image(color)
        self._depth.set_depth(depth_m)

    def show_color(self, color: npt.NDArray[np.uint8] | None) -> None:
        """Show another colour image (H, W, 3) over the same depth."""
        self._image.set_image(color)

    def caption(self, text: str) -> None:
        """Say which view is shown."""
        self._caption.setText(text or self.tr("What the camera sees"))

    def show_problems(self, text: str) -> None:
        """Say what is wrong with the view."""
        say(self._problems, text)

    def remark(self, obstacle: str, remark: str) -> None:
        """Say what keeps a scan from beginning, and what will happen when it does."""
        say(self._obstacle, obstacle)
        say(self._remark, remark)

    def show_camera(self, is_shown: bool) -> None:
        """Whether there are views to look at."""
        self._caption.setVisible(is_shown)
        self._pictures.setVisible(is_shown)
        self.appearance.setVisible(is_shown)

    def _arrange(self) -> None:
        self.body.addWidget(self.choice)
        self.body.addWidget(self._obstacle)
        self.body.addWidget(self._remark)
        self.body.addWidget(self._caption)
        self.body.addWidget(self._pictures, 100)
        self.body.addWidget(self.appearance)
        self.body.addWidget(self._problems)
        self.body.addLayout(row_of(self.take_again, self.follow))
        self.body.addStretch(1)  # takes what the pictures leave, or all when there are none
        line = QWidget()
        line.setFixedHeight(GRID_PX // 2)
        self.body.addWidget(line)
        self.body.addLayout(row_of(self.import_folder, self.import_mesh))

    def _button(self, name: str, text: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setAccessibleName(text)
        return button

    def _ask_folder(self) -> None:
        path = QFileDialog.getExistingDirectory(self, self.tr("Folder of the scan"))
        if path:
            self.file_chosen.emit(Path(path))

    def _ask_mesh(self) -> None:
        path = _ask_for_mesh(self, "")
        if path:
            self.file_chosen.emit(Path(path))


class _Images(QWidget):
    """Colour over depth, as large as there is room; they do not make the panel scroll."""

    def __init__(self, *panels: QWidget) -> None:
        super().__init__()
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX)
        for panel in panels:
            column.addWidget(panel, 1)

    @override
    def sizeHint(self) -> QSize:
        return self.minimumSizeHint()


class ObjectChoice(QWidget):
    """Asks which object is scanned, or says where to put it.

    Attributes:
        changed: something else is to be scanned, or the user has cleared the area.
    """

    changed = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("object_choice")
        self._combo = QComboBox()
        self._combo.setObjectName("object")
        self._combo.setAccessibleName(self.tr("Object on the simulated platform"))
        self._combo.setToolTip(self.tr("What stands on the platform of the simulated cell"))
        self._said = text_label("place_object")
        self._is_clear = QCheckBox(self.tr("The area is clear, and STOP is within reach"))
        self._is_clear.setObjectName("area_clear")
        self._is_clear.setToolTip(self.tr("The arm moves as soon as the scan begins"))
        self._source = _DEFAULT
        self._kind = ""
        self._moves = self._was_stopped = False
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX // 2)
        title = heading(self.tr("Object on the platform"))
        for widget in (title, self._combo, self._said, self._is_clear):
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
        """Whether a scan may begin, as far as the object and the area go."""
        return bool(self._kind) and (not self._asks or self._is_clear.isChecked())

    @property
    def _asks(self) -> bool:
        """A rehearsal asks after a STOP alone."""
        return self._moves or (self._was_stopped and self._kind == "simulated")

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
        self._moves = cell is not None and cell.robot.is_real
        texts = {
            "": self.tr("Reading the cell file …"),
            "simulated": "",
            "real": self.tr("Put the object on the platform, inside the box drawn in the view."),
            "replay": self.tr("This cell plays back a recorded scan; nothing moves."),
        }
        say(self._said, texts[self._kind])
        self._combo.setVisible(self._kind == "simulated")
        self._is_clear.setVisible(self._asks)

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

    def choose_by_words(self, words: str) -> None:
        """Choose the built-in object that some words name, such as `block` in "wood block", if any."""
        said = re.findall(r"[^\W_]+", words.casefold())
        for index in range(self._combo.count()):
            name = self._combo.itemData(index)
            if isinstance(name, str) and name in said:
                self.choose(name)

    def forget_clearance(self) -> None:
        """Before each scan of a real cell, ask again whether the area is clear."""
        self._is_clear.setChecked(False)

    def ask_clearance(self, was_stopped: bool) -> None:
        """After a STOP ask in every cell whether the area is clear, until an arm is connected again."""
        self._was_stopped = was_stopped
        self._is_clear.setVisible(self._asks)

    def _pick(self, index: int) -> None:
        picked = self._combo.itemData(index)
        if picked != _FILE:
            self.choose(str(picked))
            return
        path = _ask_for_mesh(self, str(Path.home()))
        self.choose(path or self._source)


def _kind(cell: CellSettings | None) -> str:
    if cell is None:
        return ""
    if cell.has_simulated_object:
        return "simulated"
    return "replay" if cell.camera.kind == "replay" else "real"


def _ask_for_mesh(parent: QWidget, folder: str) -> str:
    """Return the mesh file that somebody picks; empty if nobody does."""
    title, meshes = parent.tr("Mesh of the object"), parent.tr("Meshes")
    pattern = " ".join(f"*{ending}" for ending in MESH_ENDINGS)
    path, _ = QFileDialog.getOpenFileName(parent, title, folder, f"{meshes} ({pattern})")
    return path
