"""Two sessions as pictures: their models, seen from the same place at the same scale, and their pours."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout, QStackedWidget, QVBoxLayout, QWidget

from app.gui.pages.history.compared_models import ComparedModel
from app.gui.pages.mode_row import ModeRow
from app.gui.theme import GRID_PX
from app.gui.views.labels import text_label
from app.gui.views.pour_map import PourMap
from app.gui.views.scene import Scene3D

_GROUND_SIZES = 1.6
"""Half the ground's side, as a share of the larger object's diagonal."""


class ComparisonPictures(QStackedWidget):
    """Models or pours; the left session at the left, the right one at the right.

    Attributes:
        scenes: the two models; turning one turns the other.
        maps: the two wheels of pours.
    """

    def __init__(self) -> None:
        super().__init__()
        self.scenes = Scene3D(self), Scene3D(self)
        self.scenes[0].link(self.scenes[1])
        self.maps = PourMap(self), PourMap(self)
        self._no_pours = tuple(
            text_label("no_pours", "muted", self.tr("No pours were imagined.")) for _ in "ab"
        )
        self._colors = ModeRow("compared_colors")
        self._colors.add(
            "clean", self.tr("Clean pour"), self.tr("How likely a pour spills nothing, at least")
        )
        self._colors.add(
            "inside", self.tr("Candies inside"), self.tr("P: candies that land inside on average")
        )
        self._colors.chosen.connect(self._color_maps)
        models, pours = QHBoxLayout(), QHBoxLayout()
        for row in (models, pours):
            row.setContentsMargins(0, 0, 0, 0)
            row.setSpacing(GRID_PX)
        for index in range(2):
            models.addWidget(self.scenes[index], 1)
            pours.addWidget(_stacked(self.maps[index], self._no_pours[index]), 1)
        below = QWidget()
        column = QVBoxLayout(below)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self._colors, 0, Qt.AlignmentFlag.AlignLeft)
        column.addLayout(pours, 1)
        first = QWidget()
        first.setLayout(models)
        self.addWidget(first)
        self.addWidget(below)

    def clear(self) -> None:
        """Show nothing while the next two are read."""
        for scene, wheel, note in zip(self.scenes, self.maps, self._no_pours, strict=True):
            scene.clear()
            scene.set_empty_text(self.tr("Loading the model ..."))
            wheel.hide()
            note.hide()
        self._colors.hide()

    def show_models(self, models: tuple[ComparedModel, ComparedModel]) -> None:
        """Show two sessions; the larger object decides the scale of both."""
        sizes_m = [float(np.linalg.norm(model.extents_m)) for model in models]
        for scene, model in zip(self.scenes, models, strict=True):
            scene.clear()
            scene.set_empty_text(model.problem or self.tr("There is no model yet."))
            if model.body is not None:
                scene.set_prepared_mesh("object", model.body)
                half_m = _GROUND_SIZES * max(sizes_m)
                scene.set_ground("ground", (0.0, 0.0, 0.0), (half_m, half_m), model.casters_m)
        if any(sizes_m):
            self.scenes[int(np.argmax(sizes_m))].fit("object")
        for wheel, note, model in zip(self.maps, self._no_pours, models, strict=True):
            wheel.set_pours(model.cells, model.chosen)
            wheel.setVisible(bool(model.cells))
            note.setVisible(not model.cells)
        self._colors.setVisible(any(wheel.has_clean for wheel in self.maps))

    def _color_maps(self, mode: str) -> None:
        for wheel in self.maps:
            wheel.show_clean(mode == "clean")


def _stacked(wheel: QWidget, note: QWidget) -> QWidget:
    """Either of them is shown."""
    place = QWidget()
    column = QVBoxLayout(place)
    column.setContentsMargins(0, 0, 0, 0)
    column.addWidget(note, 0, Qt.AlignmentFlag.AlignCenter)
    column.addWidget(wheel, 1)
    return place
