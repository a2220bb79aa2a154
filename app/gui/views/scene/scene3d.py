"""The 3D view that pages show: layers by name, a camera, a colour scale and a few buttons."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QImage, QPalette, QResizeEvent
from PySide6.QtWidgets import QLabel, QWidget

from app.gui.theme import GRID_PX
from app.gui.views.scene.arm import Arm, ArmLooks
from app.gui.views.scene.candies import Candies
from app.gui.views.scene.canvas import make_canvas
from app.gui.views.scene.ground import Ground
from app.gui.views.scene.layers import (
    CropBox,
    Frustum,
    arrow_layer,
    frusta_layer,
    label_layer,
    line_layer,
    mesh_layer,
    points_layer,
)
from app.gui.views.scene.navigation import Navigator
from app.gui.views.scene.overlay import ScaleLegend, ViewButtons
from app.gui.views.scene.parts import ColorScale, Layer, PreparedMesh, prepare_mesh
from app.gui.views.scene.shapes import Shape
from core.geometry import BoolArray, FloatArray
from core.motion.arm_models import ArmModel, Capsule


class Scene3D(QWidget):
    """Shows layers in 3D: metres, z up, all poses in one world.

    A layer is set by its name; setting it again replaces it but keeps its pose and visibility.
    Moving a layer, an arm's joints or the candies is cheap enough for every frame. Where there is no OpenGL
    (as in offscreen tests) the widget shows a sentence instead, and everything else works.

    Signals:
        picked: a click hit a layer: its name, and the index of the frustum, the candy, the face or the point.
        box_edited: a handle of a box was dropped: the layer's name, lower and upper corner (3,) in metres.
        azimuth_changed: the direction from the centre to the eye in degrees, from +x counter-clockwise seen
            from above; sent when the user or `look_from` turns the view.
    """

    picked = Signal(str, int)
    box_edited = Signal(str, object, object)
    azimuth_changed = Signal(float)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._layers: dict[str, Layer] = {}
        self._arms: dict[str, Arm] = {}
        self._candies: dict[str, Candies] = {}
        self._boxes: dict[str, CropBox] = {}
        self._grounds: dict[str, Ground] = {}
        self._canvas = make_canvas(self)
        self._navigator = Navigator(self._canvas, self._layers, self._boxes)
        self._navigator.picked.connect(self.picked)
        self._navigator.box_edited.connect(self.box_edited)
        self._navigator.azimuth_changed.connect(self.azimuth_changed)
        self._buttons = ViewButtons(self)
        self._buttons.viewpoint_chosen.connect(self.look_from)
        self._buttons.fitted.connect(self.fit)
        self._legend = ScaleLegend(self)
        self._legend.hide()
        self._hint = QLabel(self)
        self._hint.setObjectName("empty_text")
        self._hint.setForegroundRole(QPalette.ColorRole.PlaceholderText)
        self._hint.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._hint.setWordWrap(True)
        self._hint.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setMinimumSize(240, 180)

    # Layers

    def set_mesh(
        self,
        name: str,
        vertices_m: npt.ArrayLike,
        faces: npt.ArrayLike,
        *,
        color: str | None = None,
        values: npt.ArrayLike | None = None,
        scale: ColorScale | None = None,
        opacity: float = 1.0,
        is_wireframe: bool = False,
        T_world: FloatArray | None = None,
    ) -> None:
        """Show a mesh. If it has more than some 50,000 faces, rather use `prepare_mesh` in a thread.

        Args:
            name: of the layer.
            vertices_m: (N, 3).
            faces: (F, 3) of vertex indices, in either order.
            color: a field of `Theme`; `body` if None.
            values: (N,) a number per vertex, coloured by `scale`; NaN has `color`.
            scale: the colours of the values; `show_scale` shows its numbers.
            opacity: below 1 one sees through it.
            is_wireframe: whether only its edges are drawn.
            T_world: (4, 4) pose; as it was if None.
        """
        mesh = prepare_mesh(vertices_m, faces, values=values, scale=scale, is_wireframe=is_wireframe)
        self.set_prepared_mesh(name, mesh, color=color, opacity=opacity, T_world=T_world)

    def set_prepared_mesh(
        self,
        name: str,
        mesh: PreparedMesh,
        *,
        color: str | None = None,
        opacity: float = 1.0,
        T_world: FloatArray | None = None,
    ) -> None:
        """Show a mesh that `prepare_mesh` prepared, perhaps in a thread; else as `set_mesh`."""
        self._put(name, mesh_layer(mesh, color or "body", opacity))
        if T_world is not None:
            self.set_pose(name, T_world)

    def set_pose(self, name: str, T_world: FloatArray) -> None:
        """Move a layer to a pose (4, 4); cheap."""
        self._layers[name].T_world_layer = np.asarray(T_world, dtype=float)
        self._canvas.redraw()

    def set_arm(
        self,
        name: str,
        model: ArmModel,
        joints_rad: npt.ArrayLike,
        *,
        tools: Sequence[Capsule] = (),
        looks: ArmLooks = "solid",
    ) -> None:
        """Show an arm with its tools.

        Args:
            name: of the layer.
            model: which arm.
            joints_rad: (6,).
            tools: capsules on the flange.
            looks: `solid` as it is, `ghost` see-through where it will be or is taken to be, `collision` the
                shape that is kept clear of things.
        """
        arm = Arm(model, tools, looks)
        arm.move(joints_rad)
        self._put(name, arm.layer)
        self._arms[name] = arm

    def set_joints(self, name: str, joints_rad: npt.ArrayLike) -> None:
        """Bend an arm to joint angles (6,); cheap."""
        self._arms[name].move(joints_rad)
        self._canvas.redraw()

    def set_frusta(self, name: str, frusta: Sequence[Frustum]) -> None:
        """Show camera views; `picked` has the index of the one that is clicked."""
        self._put(name, frusta_layer(frusta))

    def set_candies(self, name: str, n: int, shape: Shape, kept: BoolArray | None = None) -> None:
        """Add candies; they appear once `set_candy_poses` has placed them.

        Args:
            name: of the layer.
            n: how many.
            shape: of each, about its centre.
            kept: (n,) which ones stayed; lost ones are grey with a coloured rim. None: all look alike.
        """
        candies = Candies(n, shape, kept)
        self._put(name, candies.layer)
        self._candies[name] = candies

    def set_candy_poses(self, name: str, positions_m: npt.ArrayLike, quaternions: npt.ArrayLike) -> None:
        """Place the candies at positions (n, 3), NaN to hide one, turned by quaternions (n, 4); cheap.

        Quaternions are (x, y, z, w), as in recordings, and need not be of length one.
        """
        candies = self._candies[name]
        candies.move(positions_m, quaternions)
        for ground in self._grounds.values():
            ground.shade_candies(np.asarray(positions_m), candies.radius_m)
        self._canvas.redraw()

    def set_ground(
        self,
        name: str,
        center_m: npt.ArrayLike,
        half_m: npt.ArrayLike,
        casters_m: npt.ArrayLike,
        *,
        grid_m: float = 0.01,
        fades: bool = True,
        color: str | None = None,
    ) -> None:
        """Show a plane with a grid, from above only; it is no part of what `fit` brings into view.

        Args:
            name: of the layer.
            center_m: (3,) a point on it, its middle.
            half_m: (2,) half its sides along x and y.
            casters_m: (N, 3) points of what stands on it, for its soft shadow; dense enough to fill it.
            grid_m: between the lines; 0: none.
            fades: whether it fades towards its rim, or ends there.
            color: a field of `Theme`; `ground` if None.
        """
        casters = np.asarray(casters_m, dtype=float).reshape(-1, 3)
        ground = Ground(center_m, half_m, casters, grid_m=grid_m, fades=fades, color=color or "ground")
        self._put(name, ground.layer)
        self._grounds[name] = ground

    def set_box(
        self, name: str, min_m: npt.ArrayLike, max_m: npt.ArrayLike, *, has_handles: bool = False
    ) -> None:
        """Show the edges of a box between two corners (3,); with handles the user can drag its sides."""
        box = CropBox(min_m, max_m, has_handles)
        self._put(name, box.layer)
        self._boxes[name] = box

    def set_line(
        self, name: str, points_m: npt.ArrayLike, *, color: str | None = None, width_px: float = 2
    ) -> None:
        """Show a line through points (N, 3)."""
        self._put(name, line_layer(points_m, color or "accent", width_px))

    def set_points(
        self, name: str, points_m: npt.ArrayLike, *, color: str | None = None, size_px: float = 8
    ) -> None:
        """Show points (N, 3)."""
        self._put(name, points_layer(points_m, color or "accent", size_px))

    def set_arrow(
        self, name: str, start_m: npt.ArrayLike, end_m: npt.ArrayLike, *, color: str | None = None
    ) -> None:
        """Show an arrow between two points (3,)."""
        self._put(name, arrow_layer(start_m, end_m, color or "accent"))

    def set_label(self, name: str, point_m: npt.ArrayLike, text: str) -> None:
        """Show words beside a point (3,)."""
        self._put(name, label_layer(point_m, text))

    def set_visible(self, name: str, is_visible: bool) -> None:
        """Show or hide a layer."""
        self._layers[name].is_visible = is_visible
        self._canvas.redraw()

    def remove(self, name: str) -> None:
        """Take a layer away; nothing happens if there is none of that name."""
        for things in (self._layers, self._arms, self._candies, self._boxes, self._grounds):
            things.pop(name, None)
        self._canvas.drop(name)
        self._show_hint()
        self._canvas.redraw()

    def clear(self) -> None:
        """Take all layers and the scale away; the next ones are brought into view."""
        for name in self.layers():
            self.remove(name)
        self.show_scale(None)
        self._navigator.fit_whatever_comes()

    def layers(self) -> tuple[str, ...]:
        """Names of all layers, in the order in which they were first set."""
        return tuple(self._layers)

    # The picture

    def show_scale(self, scale: ColorScale | None) -> None:
        """Show a colour scale with its numbers, or none."""
        self._legend.show_scale(scale)
        self._place_overlays()

    def set_empty_text(self, text: str) -> None:
        """Set the text that is shown while there are no layers."""
        self._hint.setText(text)
        self._show_hint()

    @property
    def azimuth_deg(self) -> float:
        """Direction from the centre to the eye, as in `azimuth_changed`."""
        return self._navigator.camera.azimuth_deg

    def look_from(self, direction: str) -> None:
        """Look from `iso`, `top`, `front` or `side`."""
        self._navigator.look_from(direction)

    def fit(self, *names: str) -> None:
        """Bring layers into view, also those still to come; if none is named all that there are.

        They stay in view when the widget changes its size, until the user moves. Without a call all layers
        are brought into view as they come.
        """
        self._navigator.fit(names)

    def ease(self, *names: str) -> None:
        """Bring layers into view as a move that the eye can follow, unless the user has moved the view."""
        self._navigator.ease(names)

    def link(self, other: Scene3D) -> None:
        """Both look from the same place from now on, whichever of them is turned."""
        for one, another in ((self, other), (other, self)):
            one._navigator.moved.connect(another._navigator.follow)

    def grab_image(self) -> QImage:
        """The picture as it is now, without what lies over it."""
        return self._canvas.grab_image()

    # Qt

    def changeEvent(self, event: QEvent) -> None:
        """Follow the theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._canvas.redraw()  # in the theme of its window, as when it is shown

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Move the overlays to their corners, and keep what was fitted in view."""
        super().resizeEvent(event)
        self._canvas.setGeometry(self.rect())
        self._place_overlays()
        self._navigator.refit()

    def _put(self, name: str, layer: Layer) -> None:
        """Show a layer instead of the one of that name."""
        former = self._layers.get(name)
        if former is not None:
            layer.T_world_layer, layer.is_visible = former.T_world_layer, former.is_visible
        for things in (self._arms, self._candies, self._boxes, self._grounds):
            things.pop(name, None)
        self._layers[name] = layer
        self._canvas.put(name, layer)
        self._show_hint()
        if former is None:
            self._navigator.take_notice(name)
        self._canvas.redraw()

    def _show_hint(self) -> None:
        self._hint.setVisible(not self._layers and self._canvas.can_draw)
        self._buttons.setVisible(bool(self._layers) and self._canvas.can_draw)

    def _place_overlays(self) -> None:
        self._buttons.adjustSize()
        self._buttons.move(self.width() - self._buttons.width() - GRID_PX, GRID_PX)
        self._legend.move(
            self.width() - self._legend.width() - GRID_PX, self.height() - self._legend.height() - GRID_PX
        )
        self._hint.setGeometry(self.rect().adjusted(4 * GRID_PX, 0, -4 * GRID_PX, 0))
        for overlay in (self._buttons, self._legend, self._hint):
            overlay.raise_()
