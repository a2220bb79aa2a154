"""The model in 3D, with the crop box and the ruler."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from PySide6.QtCore import QEvent, QObject, QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import (
    QDoubleSpinBox,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSlider,
    QWidget,
)
from typing_extensions import override

from app.gui.pages.layouts import lay_around
from app.gui.pages.mode_row import ModeRow
from app.gui.pages.reconstruction.loading import MM, ShownModel
from app.gui.pages.reconstruction.modes import PHOTO, caption, ground_m, mode_colors, mode_tips
from app.gui.theme import GRID_PX, theme_of
from app.gui.views.labels import text_label
from app.gui.views.painting import tabular
from app.gui.views.scene import ColorScale, Scene3D
from core.geometry import FloatArray
from core.parameters.reconstruction import Point

_MOST_MM = 10_000.0
_AXES = "xyz"
_RULER_LAYERS = ("ruler_points", "ruler_line", "ruler_label")
_UNSEEN = "attention"
"""Colour of what no view saw."""
_FAINT = 0.35
_GROUND_SIZES = 1.6
"""Half the ground's side, as a share of the object's diagonal."""


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
        self._add_modes()
        self._build()
        self.modes.chosen.connect(self._draw)
        self.crop.edited.connect(self.box_edited)
        self.scene.box_edited.connect(self._take_box)
        self.ruler.measured.connect(self._show_caption)
        self.show_model(None)

    def _add_modes(self) -> None:
        self.modes.add("shape", self.tr("Shape"), self.tr("The surface as it is"))
        self.modes.add(PHOTO, self.tr("Photo"), "")
        self.modes.add("height", self.tr("Height"), self.tr("Height above the platform in mm"))
        self.modes.add("coverage", self.tr("Coverage"), "")
        self.modes.add("collision", self.tr("Collision"), "")
        self.modes.add("difference", self.tr("Difference"), "")

    def _build(self) -> None:
        self._crop_button = self._toggle(
            "crop_toggle",
            self.tr("Crop box"),
            self.tr("Show the box that holds the object; drag its handles to change it"),
        )
        self._ruler_button = self._toggle(
            "ruler_toggle", self.tr("Ruler"), self.tr("Measure between two clicks on the object")
        )
        self._crop_button.toggled.connect(self._show_box)
        self._ruler_button.toggled.connect(self.ruler.set_on)
        self._caption = text_label("model_caption", "muted")
        self._caption.setMinimumHeight(2 * self.fontMetrics().height())
        self._opacity = QSlider(Qt.Orientation.Horizontal)
        self._opacity.setObjectName("collision_opacity")
        self._opacity.setAccessibleName(self.tr("Opacity of the collision parts"))
        self._opacity.setToolTip(self.tr("Opacity of the collision parts in percent"))
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
        lay_around(self, top, self.scene, crop, bottom)
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
        was_photographed = self._model is not None and self._model.body.rgb is not None
        self._model, self._difference_m = model, difference_m
        self._offer_modes()
        if model is not None and model.body.rgb is not None and not was_photographed:
            self._prefer_photo()
        for layer in ("object", "hidden", "collision", "ground"):
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
        if model is not None:
            self._draw_ground(model)
        if is_first:
            self.scene.fit("object")

    def _prefer_photo(self) -> None:
        """The colours are known last; a height or a difference that is being looked at stays."""
        if self.modes.mode == "shape":
            self.modes.choose(PHOTO)

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
        for mode, (is_available, tip) in mode_tips(self._model, self._difference_m is not None).items():
            self.modes.set_available(mode, is_available, tip)
        for mode in ("shape", "height"):
            self.modes.set_enabled(mode, self._model is not None)

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
        colors = mode_colors(model, mode, self._difference_m)
        if colors is None:
            body = model.body if mode == PHOTO else replace(model.body, rgb=None)
            is_behind = mode == "collision" and model.collision is not None and model.collision.n_parts > 1
            self.scene.set_prepared_mesh("object", body, opacity=_FAINT if is_behind else 1.0)
            return None
        values, scale = colors
        body = replace(model.body, values=values.astype(np.float32), scale=scale)
        self.scene.set_prepared_mesh("object", body, color=_UNSEEN)
        return scale

    def _draw_ground(self, model: ShownModel) -> None:
        """The platform under it; an imported mesh stands on its lowest point."""
        low, high = model.mesh.aabb_min_m, model.mesh.aabb_max_m
        height_m = min(ground_m(model), float(low[2]))
        half_m = _GROUND_SIZES * float(np.linalg.norm(high - low))
        self.scene.set_ground("ground", [*(low + high)[:2] / 2, height_m], [half_m] * 2, model.centers_m)

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
        unseen = theme_of(self).color(_UNSEEN).name()
        said = caption(self._model, self.modes.mode, self._difference_m, unseen)
        self._caption.setText(self.ruler.sentence or said)

    @override
    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._show_caption()


class Ruler(QObject):
    """Measures in a scene while it is on; a third click starts over.

    Signals: `measured` when there is something else to say.

    Attributes:
        points_m: (3,) each, what was clicked so far.
    """

    measured = Signal()

    def __init__(self, scene: Scene3D) -> None:
        super().__init__(scene)
        self._scene = scene
        self._places: dict[str, FloatArray] = {}
        self._is_on = False
        self.points_m: list[FloatArray] = []
        scene.picked.connect(self._pick)

    def set_places(self, places: Mapping[str, FloatArray]) -> None:
        """Take the places that can be picked: by layer (n, 3), such as the centres of its faces."""
        self._places = dict(places)
        self.clear()

    def set_on(self, is_on: bool) -> None:
        """Begin or end measuring."""
        self._is_on = is_on
        self.clear()

    def clear(self) -> None:
        """Forget what was clicked."""
        self.points_m = []
        self._draw()

    @property
    def distance_m(self) -> float | None:
        """Between the two places; none before the second."""
        if len(self.points_m) < 2:
            return None
        return float(np.linalg.norm(self.points_m[1] - self.points_m[0]))

    def _pick(self, layer: str, index: int) -> None:
        if not self._is_on or layer not in self._places:
            return
        if len(self.points_m) == 2:
            self.points_m = []
        self.points_m.append(self._places[layer][index])
        self._draw()

    def _draw(self) -> None:
        for layer in _RULER_LAYERS:
            self._scene.remove(layer)
        if self.points_m:
            self._scene.set_points("ruler_points", self.points_m, color="attention", size_px=10)
        distance_m = self.distance_m
        if distance_m is not None:
            self._scene.set_line("ruler_line", self.points_m, color="attention", width_px=3)
            middle = (self.points_m[0] + self.points_m[1]) / 2
            text = self.tr("{distance:.1f} mm").format(distance=distance_m * MM)
            self._scene.set_label("ruler_label", middle, text)
        self.measured.emit()

    @property
    def sentence(self) -> str:
        """The distance, or what to click next; empty while it is off."""
        if not self._is_on:
            return ""
        if not self.points_m:
            return self.tr("Ruler: click two places on the object.")
        distance_m = self.distance_m
        if distance_m is None:
            return self.tr("Ruler: click the second place.")
        x, y, z = np.abs(self.points_m[1] - self.points_m[0]) * MM
        return self.tr("Ruler: {distance:.1f} mm (x {x:.1f}, y {y:.1f}, z {z:.1f} mm).").format(
            distance=distance_m * MM, x=x, y=y, z=z
        )


class CropBar(QWidget):
    """Lower and upper corner in millimetres, and a button back to the scan's own box.

    Signals: `edited` with lower and upper corner in metres (tuples of three); `reset_wanted`.
    """

    edited = Signal(object, object)
    reset_wanted = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("crop_bar")
        self._low = [self._number(axis, "min", self.tr("Lower end along {axis}")) for axis in _AXES]
        self._high = [self._number(axis, "max", self.tr("Upper end along {axis}")) for axis in _AXES]
        self._reset = QPushButton(self.tr("Reset"))
        self._reset.setObjectName("crop_reset")
        self._reset.setToolTip(self.tr("Back to the scan's own box"))
        self._reset.clicked.connect(self.reset_wanted)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(GRID_PX // 2)
        for axis, low, high in zip(_AXES, self._low, self._high, strict=True):
            row.addWidget(QLabel(axis))
            row.addWidget(low)
            row.addWidget(QLabel(self.tr("to")))
            row.addWidget(high)
            row.addSpacing(GRID_PX)
        row.addWidget(QLabel(self.tr("mm")))
        row.addStretch(1)
        row.addWidget(self._reset)

    def set_box(self, low_m: Point, high_m: Point, is_own: bool) -> None:
        """Show a box; `is_own` tells that it is the scan's own."""
        for box, value_m in zip([*self._low, *self._high], [*low_m, *high_m], strict=True):
            with QSignalBlocker(box):
                box.setValue(value_m * MM)
        self._reset.setEnabled(not is_own)

    def _number(self, axis: str, end: str, tip: str) -> QDoubleSpinBox:
        box = QDoubleSpinBox()
        box.setObjectName(f"crop_{end}_{axis}")
        box.setAccessibleName(tip.format(axis=axis))
        box.setToolTip(self.tr("{tip}, in mm in the robot's base frame").format(tip=tip.format(axis=axis)))
        box.setRange(-_MOST_MM, _MOST_MM)
        box.setDecimals(0)
        box.setSingleStep(5)
        box.setKeyboardTracking(False)
        box.setButtonSymbols(QDoubleSpinBox.ButtonSymbols.NoButtons)
        box.setAlignment(Qt.AlignmentFlag.AlignRight)
        box.setFont(tabular(self.font()))
        box.setMaximumWidth(8 * GRID_PX)
        box.valueChanged.connect(self._emit)
        return box

    def _emit(self) -> None:
        low, high = (tuple(box.value() / MM for box in boxes) for boxes in (self._low, self._high))
        self.edited.emit(low, high)
