"""The model in 3D: what its colours say, the crop box, the ruler."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QSlider, QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.pages.mode_row import ModeRow
from app.gui.pages.reconstruction.captions import Captions
from app.gui.pages.reconstruction.crop_bar import CropBar
from app.gui.pages.reconstruction.loading import MM, ShownModel, colored, difference_scale
from app.gui.pages.reconstruction.ruler import Ruler
from app.gui.theme import GRID_PX, theme_of
from app.gui.views.scene import ColorScale, Scene3D
from core.geometry import FloatArray
from core.parameters.reconstruction import Point

_UNSEEN = "attention"
"""Colour of what no view saw."""
_FAINT = 0.35


class ModelView(QWidget):
    """Scene, mode row, and what belongs to the mode.

    Attributes:
        scene: the 3D view.
        modes: shape, height, coverage, collision, difference.
        crop: the crop box in numbers.
        ruler: measures between two clicks.
    """

    box_edited = Signal(object, object)

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("model_view")
        self._model: ShownModel | None = None
        self._difference_m: FloatArray | None = None
        self._box: tuple[Point, Point] | None = None
        self.scene = Scene3D()
        self.scene.setObjectName("model_scene")
        self.modes = ModeRow("model_mode")
        self.crop = CropBar()
        self.ruler = Ruler(self.scene)
        self._captions = Captions(self)
        self._add_modes()
        self._build()
        self.modes.chosen.connect(self._draw)
        self.crop.edited.connect(self.box_edited)
        self.scene.box_edited.connect(self._take_box)
        self.ruler.measured.connect(self._show_caption)
        self.show_model(None)

    def _add_modes(self) -> None:
        self.modes.add("shape", self.tr("Shape"), self.tr("The surface as it is"))
        self.modes.add("height", self.tr("Height"), self.tr("Height above the platform in mm"))
        self.modes.add("coverage", self.tr("Coverage"), "")
        self.modes.add("collision", self.tr("Collision"), "")
        self.modes.add("difference", self.tr("Difference"), "")

    def _build(self) -> None:
        self._crop_button = self._toggle(
            "crop_toggle",
            self.tr("Crop box"),
            self.tr("Show the box that holds the object; drag its handles"),
        )
        self._ruler_button = self._toggle(
            "ruler_toggle", self.tr("Ruler"), self.tr("Measure between two clicks on the object")
        )
        self._crop_button.toggled.connect(self._show_box)
        self._ruler_button.toggled.connect(self.ruler.set_on)
        self._caption = QLabel()
        self._caption.setObjectName("model_caption")
        self._caption.setProperty("role", "muted")
        self._caption.setWordWrap(True)
        self._caption.setMinimumHeight(2 * self.fontMetrics().height())
        self._opacity = QSlider(Qt.Orientation.Horizontal)
        self._opacity.setObjectName("collision_opacity")
        self._opacity.setAccessibleName(self.tr("Opacity of the collision parts"))
        self._opacity.setToolTip(self.tr("Opacity of the collision parts, in per cent"))
        self._opacity.setRange(10, 100)
        self._opacity.setValue(60)
        self._opacity.setFixedWidth(16 * GRID_PX)
        self._opacity.valueChanged.connect(self._draw_collision)
        top, bottom = QHBoxLayout(), QHBoxLayout()
        for row in (top, bottom):
            row.setContentsMargins(GRID_PX, GRID_PX, GRID_PX, GRID_PX)
            row.setSpacing(GRID_PX // 2)
        top.addWidget(self.modes)
        top.addStretch(1)
        top.addWidget(self._crop_button)
        top.addWidget(self._ruler_button)
        bottom.addWidget(self._caption, 1)
        bottom.addWidget(self._opacity)
        crop = QHBoxLayout()
        crop.setContentsMargins(GRID_PX, GRID_PX, GRID_PX, 0)
        crop.addWidget(self.crop)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addLayout(top)
        column.addWidget(self.scene, 1)
        column.addLayout(crop)
        column.addLayout(bottom)
        self.crop.hide()

    def _toggle(self, name: str, text: str, tip: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setCheckable(True)
        button.setToolTip(tip)
        return button

    def show_model(self, model: ShownModel | None, difference_m: FloatArray | None = None) -> None:
        """Show a model and how far it lies off the last one (V,), if that is known; none: nothing."""
        is_first = self._model is None
        self._model, self._difference_m = model, difference_m
        self._offer_modes()
        for layer in ("object", "hidden", "collision"):
            self.scene.remove(layer)
        places = {} if model is None else {"object": model.centers_m}
        if model is not None and model.quality is not None:
            places["hidden"] = model.quality.cavity.frontier_m
        if model is not None and model.collision is not None:
            places["collision"] = model.collision.centers_m
        self.ruler.set_places(places)
        self._ruler_button.setEnabled(model is not None)
        if model is None:
            self._ruler_button.setChecked(False)
        self._draw()
        if is_first:
            self.scene.fit("object")

    def set_empty_text(self, text: str) -> None:
        """What the view says while there is no model."""
        self.scene.set_empty_text(text)

    def set_box(self, low_m: Point | None, high_m: Point | None, is_own: bool) -> None:
        """Show where the crop box is; none if there is nothing to crop."""
        self._box = None if low_m is None or high_m is None else (low_m, high_m)
        self._crop_button.setEnabled(self._box is not None)
        if self._box is None:
            self._crop_button.setChecked(False)
        else:
            self.crop.set_box(*self._box, is_own)
        self._show_box()

    def _show_box(self) -> None:
        is_shown = self._crop_button.isChecked() and self._box is not None
        was_shown = "crop" in self.scene.layers()
        self.crop.setVisible(is_shown)
        if is_shown and self._box is not None:
            self.scene.set_box("crop", *self._box, has_handles=True)
        else:
            self.scene.remove("crop")
        if is_shown != was_shown:
            self.scene.fit(*(("crop", "object") if is_shown else ("object",)))

    def _take_box(self, _layer: str, low_m: FloatArray, high_m: FloatArray) -> None:
        """To whole millimetres, as the numbers show it."""
        low, high = (tuple(float(value) for value in np.round(corner, 3)) for corner in (low_m, high_m))
        self.box_edited.emit(low, high)

    def _offer_modes(self) -> None:
        model, captions = self._model, self._captions
        has_views = model is not None and model.quality is not None
        has_parts = model is not None and model.collision is not None
        self.modes.set_available("coverage", has_views, captions.coverage_tip(model))
        self.modes.set_available("collision", has_parts, captions.collision_tip(model))
        has_difference = self._difference_m is not None
        self.modes.set_available("difference", has_difference, captions.difference_tip(has_difference))
        for mode in ("shape", "height"):
            self.modes.set_enabled(mode, model is not None)

    def _draw(self) -> None:
        """Show the object as the mode wants it."""
        model, mode = self._model, self.modes.mode
        self._opacity.setVisible(mode == "collision")
        scale = None
        if model is not None:
            scale = self._draw_object(model, mode)
            self._draw_hidden(model, mode)
        self._draw_collision()
        self.scene.show_scale(scale)
        self._show_caption()

    def _draw_object(self, model: ShownModel, mode: str) -> ColorScale | None:
        body, scale = model.body, self._scale(model, mode)
        if scale is None:
            is_behind = mode == "collision" and model.collision is not None and model.collision.n_parts > 1
            self.scene.set_prepared_mesh("object", body, opacity=_FAINT if is_behind else 1.0)
            return None
        if mode == "coverage" and model.quality is not None:
            n_views = model.quality.n_views.astype(float)
            values = np.where(n_views > 0, n_views, np.nan)
        elif mode == "difference" and self._difference_m is not None:
            values = self._difference_m * MM
        else:
            values = (model.mesh.vertices_m[:, 2] - _ground_m(model)) * MM
        self.scene.set_prepared_mesh("object", colored(body, values, scale), color=_UNSEEN)
        return scale

    def _scale(self, model: ShownModel, mode: str) -> ColorScale | None:
        if mode == "height":
            top_mm = float(model.mesh.aabb_max_m[2] - _ground_m(model)) * MM
            return ColorScale(self.tr("Height"), "mm", 0.0, top_mm)
        if mode == "coverage" and model.quality is not None:
            most = -4 * (-len(model.quality.views) // 4)  # so that the scale's five numbers are whole
            return ColorScale(self.tr("Seen in views"), "", 0.0, float(most))
        if mode == "difference" and self._difference_m is not None:
            return difference_scale(self._difference_m, self.tr("Moved"))
        return None

    def _draw_hidden(self, model: ShownModel, mode: str) -> None:
        """The inside of openings that no view saw."""
        if mode == "coverage" and model.quality is not None and len(model.quality.cavity.frontier_m):
            self.scene.set_points("hidden", model.quality.cavity.frontier_m, color=_UNSEEN, size_px=5)
        else:
            self.scene.remove("hidden")

    def _draw_collision(self) -> None:
        collision = None if self._model is None else self._model.collision
        if collision is None or self.modes.mode != "collision":
            self.scene.remove("collision")
            return
        opacity = self._opacity.value() / 100
        self.scene.set_prepared_mesh("collision", collision.mesh, color="accent", opacity=opacity)

    def _show_caption(self) -> None:
        said = self.ruler.sentence or self._captions.of(
            self._model, self.modes.mode, self._difference_m, theme_of(self).color(_UNSEEN).name()
        )
        self._caption.setText(said)

    @override
    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._show_caption()


def _ground_m(model: ShownModel) -> float:
    """What heights are counted from: the platform, or the lowest point of an imported mesh."""
    if model.reconstruction is None:
        return float(model.mesh.aabb_min_m[2])
    return model.reconstruction.platform_height_m
