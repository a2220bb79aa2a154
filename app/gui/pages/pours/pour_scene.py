"""One pour in 3D: the object on its ground, the cup over it, and the candies at any time of the pour."""

from __future__ import annotations

from bisect import bisect_right

import numpy as np
from PySide6.QtCore import Signal
from PySide6.QtWidgets import QVBoxLayout, QWidget

from app.gui.pages.pours.results import FillBand, ShownPours
from app.gui.theme import GRID_PX
from app.gui.views.labels import text_label
from app.gui.views.scene import Scene3D
from app.gui.views.timeline import Section, Timeline
from core.geometry import FloatArray
from core.imagination.recording import Recording
from core.imagination.results import PourGrid

GROUND, BODY, CUP, CANDIES, PIVOTS, PIVOT, ARROW, CENTER, AROUND, LEVEL, LEVEL_NAME = (
    "ground",
    "object",
    "cup",
    "candies",
    "pivots",
    "pivot",
    "direction",
    "center",
    "around",
    "level",
    "level's name",
)
_ARROW_M = 0.07
_GROUND_M = 0.4
"""Half its side."""
_SEE_THROUGH = 0.45
"""Of the object, so that the candies in it are seen."""


class PourScene(QWidget):
    """Shows one pour of a grid at a time.

    Attributes:
        scene: the 3D view.
        timeline: of the replay.
        picked: (i, j) of the pour whose pivot was clicked.
        rotated: how far the map has to be rotated to lie as this view does, degrees anticlockwise.
    """

    picked = Signal(int, int)
    rotated = Signal(float)

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("pour_scene")
        self.scene = Scene3D()
        self.scene.setObjectName("pours_3d")
        self.scene.setAccessibleName(self.tr("The selected pour in 3D"))
        self.timeline = Timeline()
        self._pours: ShownPours | None = None
        self._recording: Recording | None = None
        self._times_s: list[float] = []
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.scene, 1)
        self._bar = QWidget()
        bar = QVBoxLayout(self._bar)
        bar.setContentsMargins(GRID_PX, GRID_PX, GRID_PX, GRID_PX)
        # The dot has the colour of those in the view, which could be taken for candies.
        bar.addWidget(
            text_label("pivot_legend", "muted", self.tr("● pivots of the other pours: click to select"))
        )
        bar.addWidget(self.timeline)
        column.addWidget(self._bar)
        self.scene.picked.connect(self._pick)
        self.scene.azimuth_changed.connect(lambda deg: self.rotated.emit(map_rotation_deg(deg)))
        self.timeline.time_changed.connect(self._show_moment)

    @property
    def rotation_deg(self) -> float:
        """How far the map has to be rotated now."""
        return map_rotation_deg(self.scene.azimuth_deg)

    def show_nothing(self, text: str) -> None:
        """Show an empty view that says why."""
        self._pours, self._recording = None, None
        self.scene.clear()
        self.scene.set_empty_text(text)
        self.timeline.set_sections(0.0)
        self._bar.hide()

    def show_pours(self, pours: ShownPours) -> None:
        """Show the object and all pivots of a grid; `show_pour` then shows one of its pours."""
        if self._pours is None or self._pours.folder != pours.folder:
            self.scene.clear()
        self._pours, self._recording = pours, None
        self.scene.set_prepared_mesh(BODY, pours.body, opacity=1.0 if pours.grid is None else _SEE_THROUGH)
        grid, box = pours.grid, pours.containability.aabb_m
        self.scene.set_ground(
            GROUND, [*box.mean(axis=0)[:2], pours.ground_m], [_GROUND_M] * 2, pours.casters_m
        )
        for name in (CUP, CANDIES, PIVOTS, PIVOT, ARROW, CENTER, LEVEL, LEVEL_NAME):
            self.scene.remove(name)
        self._bar.setVisible(grid is not None)
        if grid is None:
            self.timeline.set_sections(0.0)
            self.scene.fit(BODY)
            return
        self.scene.set_prepared_mesh(CUP, pours.cup, color="ghost", opacity=0.35)
        self.scene.set_points(PIVOTS, grid.pivot_m.reshape(-1, 3), color="muted", size_px=7)
        self.scene.set_points(
            AROUND, _corners(clearance_box_m(box, pours.pouring.cup.length_m)), color="scene", size_px=1
        )
        footprint = pours.containability.footprint
        if footprint is not None:
            self.scene.set_label(CENTER, footprint.center_m, self.tr("Pour centre"))
        self._show_level(pours.fill_line)
        self.scene.fit(BODY, AROUND)

    def _show_level(self, level: FillBand | None) -> None:
        if level is not None:
            self.scene.set_prepared_mesh(LEVEL, level.band, color="accent")
            said = self.tr("level of {n} candies").format(n=level.n_candies)
            self.scene.set_label(LEVEL_NAME, level.label_m, said)

    def show_pour(self, i: int, j: int) -> None:
        """Show one pour at its end: what landed inside and what did not."""
        pours = self._pours
        if pours is None or pours.grid is None:
            return
        grid = pours.grid
        recording = pours.replay(i, j)
        self._recording = None  # the time line reports its time while it is set
        self._times_s = recording.time_s.astype(float).tolist()
        n = recording.positions_m.shape[1]
        self.scene.set_candies(CANDIES, n, pours.candy, pours.landed(i, j))
        self.scene.set_points(PIVOT, grid.pivot_m[i, j], color="accent", size_px=13)
        self.scene.set_arrow(ARROW, *_arrow(pours, grid, i), color="accent")
        duration_s = self._times_s[-1] if self._times_s else 0.0
        self.timeline.set_sections(duration_s, self._sections(pours, duration_s))
        self._recording = recording
        self.timeline.set_time(duration_s)
        self._show_moment(duration_s)

    def _sections(self, pours: ShownPours, duration_s: float) -> list[Section]:
        begin_s, end_s = pours.pouring.settle_s, pours.pouring.settle_s + pours.pouring.turn_s
        return [
            Section(self.tr("settle"), 0.0, begin_s),
            Section(self.tr("pour"), begin_s, end_s),
            Section(self.tr("wait"), end_s, max(duration_s, end_s)),
        ]

    def _show_moment(self, time_s: float) -> None:
        recording = self._recording
        if recording is None or not self._times_s:
            return
        k = max(bisect_right(self._times_s, time_s + 1e-6) - 1, 0)
        self.scene.set_pose(CUP, recording.T_world_body[k].astype(float))
        self.scene.set_candy_poses(CANDIES, recording.positions_m[k], recording.quaternions[k])

    def _pick(self, name: str, index: int) -> None:
        if name == PIVOTS and self._pours is not None and self._pours.grid is not None:
            i, j = divmod(index, len(self._pours.grid.indent_m))
            self.picked.emit(i, j)


def map_rotation_deg(azimuth_deg: float) -> float:
    """How far a map with x to the right has to be rotated to lie as seen by an eye at an azimuth."""
    return (-90.0 - azimuth_deg + 180.0) % 360.0 - 180.0


def clearance_box_m(box_m: FloatArray, reach_m: float) -> FloatArray:
    """(2, 3) the object's box with clearance around it for the cup."""
    around = 0.8 * np.array([reach_m, reach_m, 0.0])
    return np.array([box_m[0] - around, box_m[1] + around + [0.0, 0.0, reach_m / 2]])


def _corners(box_m: FloatArray) -> FloatArray:
    choose = np.indices((2, 2, 2)).reshape(3, -1).T
    return np.stack([box_m[choose[:, axis], axis] for axis in range(3)], axis=1)


def _arrow(pours: ShownPours, grid: PourGrid, i: int) -> tuple[FloatArray, FloatArray]:
    """The direction of the pour: on the ground, beside the object, from where the cup comes."""
    theta = float(grid.theta_rad[i])
    ray = np.array([np.cos(theta), np.sin(theta), 0.0])
    box = pours.containability.aabb_m
    foot = np.array([*grid.pivot_m.mean(axis=(0, 1))[:2], box[0, 2]])
    half = (box[1] - box[0])[:2] / 2
    beside_m = float(np.min(half / np.maximum(np.abs(ray[:2]), 1e-9))) + 0.02
    end: FloatArray = foot + beside_m * ray
    start: FloatArray = end + _ARROW_M * ray
    return start, end
