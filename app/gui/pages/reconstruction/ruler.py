"""Two clicks on a surface, and how far apart they are."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from PySide6.QtCore import QObject, Signal

from app.gui.views.scene import Scene3D
from core.geometry import FloatArray

_LAYERS = ("ruler_points", "ruler_line", "ruler_label")
MM = 1000.0


class Ruler(QObject):
    """Measures in a scene while it is on; a third click begins anew.

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
        """Tell where what can be picked lies: by layer (n, 3), such as the centres of its faces."""
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
        for layer in _LAYERS:
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
