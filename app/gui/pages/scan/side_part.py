"""The right of the Scan page: what is scanned, what the camera sees, and the buttons."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QSize, Signal
from PySide6.QtWidgets import QFileDialog, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.pages.page import SidePanel
from app.gui.pages.scan.object_choice import MESH_ENDINGS, ObjectChoice
from app.gui.theme import GRID_PX
from app.gui.views.depth_image import DepthPanel, ImagePanel


class ScanSide(SidePanel):
    """The controls of the page.

    Attributes:
        choice: of the object.
        start_anew: throws away what an interrupted scan left, and begins.
        take_again: the selected view.
        follow: shows the newest view again.
        import_folder, import_mesh: ask for what is to be imported.
        folder_chosen, mesh_chosen: a path that is to be imported.
    """

    folder_chosen = Signal(str)
    mesh_chosen = Signal(str)

    def __init__(self) -> None:
        super().__init__(self.tr("Scan"))
        self.choice = ObjectChoice()
        self.start_anew = self._button("start_anew", self.tr("Start anew"))
        self.start_anew.setToolTip(self.tr("Throw the kept views away and take all of them"))
        self.start_anew.setMinimumHeight(self.primary.minimumHeight())
        self.add_button(self.start_anew)
        self.take_again = self._button("take_again", self.tr("Take again"))
        self.follow = self._button("follow", self.tr("Show the newest"))
        self.import_folder = self._button("import_folder", self.tr("Import folder …"))
        self.import_folder.setToolTip(
            self.tr("Views that were taken elsewhere: rgbd/frame-*.color.png, .depth.png and .pose.txt")
        )
        self.import_mesh = self._button("import_mesh", self.tr("Import mesh …"))
        self.import_mesh.setToolTip(self.tr("A surface instead of a scan: .obj, .ply or .stl"))
        self._caption = QLabel(self.tr("What the camera sees"))
        self._caption.setObjectName("caption")
        self._caption.setProperty("role", "heading")
        self._image, self._depth = ImagePanel(), DepthPanel()
        self._said = _label("view_said", "")
        self._obstacle = _label("obstacle", "attention")
        self._remark = _label("remark", "muted")
        self._pictures = _Images(self._image, self._depth)
        self._arrange()
        self.import_folder.clicked.connect(self._ask_folder)
        self.import_mesh.clicked.connect(self._ask_mesh)
        self.say("")
        self.remark("", "")

    def show_images(
        self, color: npt.NDArray[np.uint8] | None, depth_m: npt.NDArray[np.float32] | None
    ) -> None:
        """Show a view's colour (H, W, 3) and depth (H, W)."""
        self._image.set_image(color)
        self._depth.set_depth(depth_m)

    def caption(self, text: str) -> None:
        """Say which view is shown."""
        self._caption.setText(text or self.tr("What the camera sees"))

    def say(self, text: str) -> None:
        """Say what there is to know of the view."""
        self._said.setText(text)
        self._said.setVisible(bool(text))

    def remark(self, obstacle: str, remark: str) -> None:
        """Say what keeps a scan from beginning, and what will happen when it does."""
        for label, text in ((self._obstacle, obstacle), (self._remark, remark)):
            label.setText(text)
            label.setVisible(bool(text))

    def show_camera(self, is_shown: bool) -> None:
        """Whether there are views to look at."""
        self._caption.setVisible(is_shown)
        self._pictures.setVisible(is_shown)

    def _arrange(self) -> None:
        self.body.addWidget(self.choice)
        self.body.addWidget(self._obstacle)
        self.body.addWidget(self._remark)
        self.body.addWidget(self._caption)
        self.body.addWidget(self._pictures, 100)
        self.body.addWidget(self._said)
        self.body.addLayout(_row(self.take_again, self.follow))
        self.body.addStretch(1)  # takes what the pictures leave, or all when there are none
        line = QWidget()
        line.setFixedHeight(GRID_PX // 2)
        self.body.addWidget(line)
        self.body.addLayout(_row(self.import_folder, self.import_mesh))

    def _button(self, name: str, text: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setAccessibleName(text)
        return button

    def _ask_folder(self) -> None:
        path = QFileDialog.getExistingDirectory(self, self.tr("Folder of the scan"))
        if path:
            self.folder_chosen.emit(path)

    def _ask_mesh(self) -> None:
        pattern = " ".join(f"*{ending}" for ending in MESH_ENDINGS)
        path, _ = QFileDialog.getOpenFileName(
            self, self.tr("Mesh of the object"), "", self.tr("Meshes") + f" ({pattern})"
        )
        if path:
            self.mesh_chosen.emit(path)


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


def _label(name: str, role: str) -> QLabel:
    label = QLabel()
    label.setObjectName(name)
    label.setProperty("role", role)
    label.setWordWrap(True)
    return label


def _row(*widgets: QWidget) -> QHBoxLayout:
    row = QHBoxLayout()
    row.setSpacing(GRID_PX)
    for widget in widgets:
        row.addWidget(widget)
    row.addStretch(1)
    return row
