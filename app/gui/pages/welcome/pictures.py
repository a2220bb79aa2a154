"""What will happen, in four pictures: taken of the program itself by `make screenshots`."""

from __future__ import annotations

from PySide6.QtCore import QEvent, Qt
from PySide6.QtGui import QPixmap
from PySide6.QtWidgets import QHBoxLayout, QLabel, QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.labels import text_label
from core.resources import RESOURCES

FOLDER = RESOURCES / "pictures"
STEPS = ("scan", "reconstruction", "imagination", "pours")
"""The pages that the pictures are of; the files are called `STEP-THEME.png`."""
SIZE_PX = 160, 120
PIXEL_RATIO = 2
"""Of the files: sharp on a screen of twice the usual density."""


class StepPictures(QWidget):
    """The pictures in a row, each with its words below, in the window's theme."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("step_pictures")
        self._pictures: dict[str, QLabel] = {}
        words = (
            self.tr("The arm scans the object"),
            self.tr("Its views become a model"),
            self.tr("Dropped candies stay, or not"),
            self.tr("The surest pour is chosen"),
        )
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(2 * GRID_PX)
        for number, (step, said) in enumerate(zip(STEPS, words, strict=True), 1):
            picture = self._pictures[step] = QLabel()
            picture.setFixedSize(*SIZE_PX)
            picture.setAccessibleName(said)
            caption = text_label("", "muted", f"{number}  {said}")
            caption.setFixedWidth(SIZE_PX[0])
            column = QVBoxLayout()
            column.setSpacing(GRID_PX // 2)
            column.addWidget(picture)
            column.addWidget(caption, 1, Qt.AlignmentFlag.AlignTop)
            row.addLayout(column)
        row.addStretch(1)
        self._show_theme()

    @override
    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._show_theme()

    def _show_theme(self) -> None:
        for step, label in self._pictures.items():
            picture = QPixmap(str(FOLDER / f"{step}-{theme_of(self).name}.png"))
            picture.setDevicePixelRatio(PIXEL_RATIO)
            label.setPixmap(picture)
