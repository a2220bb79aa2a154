"""The Pours page: which pour will be made, and why."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QSplitter, QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.desk.desk import Desk
from app.gui.pages.background_page import BackgroundPage
from app.gui.pages.page import SidePanel, SplitView
from app.gui.pages.pours.choice import ChoiceBox, SelectedBox
from app.gui.pages.pours.comparison import CompareBox, OtherPours, VariantRun, load_grid
from app.gui.pages.pours.results import PoursKey, ShownPours, load_pours
from app.gui.remedies import worded
from app.gui.theme import GRID_PX
from app.gui.views.pour_map import MappedPour, PourMap
from app.gui.views.scene import Scene3D
from app.gui.views.timeline import Section, Timeline
from app.jobs.session_work import SessionWork
from app.operations.choosing import choose_pour
from core.errors import PoursightError
from core.geometry import FloatArray
from core.imagination.recording import Recording
from core.imagination.results import PourGrid
from core.session.operator_choice import withdraw_operator_choice

_MAP_PX = 400
GROUND, BODY, CUP, CANDIES, PIVOTS, PIVOT, ARROW, CENTER, AROUND = (
    "ground",
    "object",
    "cup",
    "candies",
    "pivots",
    "pivot",
    "direction",
    "center",
    "around",
)
_ARROW_M = 0.07
_GROUND_M = 0.4
"""Half its side."""
_SEE_THROUGH = 0.45
"""Of the object, so that the candies in it are seen."""


class PoursPage(BackgroundPage[PoursKey, ShownPours]):
    """Map and 3D of the pours at the left, the choice and what it is compared with at the right."""

    KEY = "pours"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk, load_pours)
        self._before: PourGrid | None = None
        self._map = PourMap()
        self._selected = SelectedBox()
        self._scene = PourScene()
        self._choice = ChoiceBox()
        self._compare = CompareBox()
        self._variant = VariantRun(desk, self.KEY, self)
        self._side = SidePanel(self.tr("Review motion"))
        self._side.body.addWidget(self._choice)
        self._side.body.addWidget(self._compare)
        self._side.body.addStretch(1)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(SplitView(self._build_view(), self._side))
        self._connect()
        self.show_content(None)

    def _build_view(self) -> QWidget:
        self._left = QWidget()
        column = QVBoxLayout(self._left)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self._map, 1)
        column.addWidget(self._selected)
        view = QSplitter(Qt.Orientation.Horizontal)
        view.setChildrenCollapsible(False)
        view.setHandleWidth(1)
        view.addWidget(self._left)
        view.addWidget(self._scene)
        view.setStretchFactor(0, 2)
        view.setStretchFactor(1, 3)
        view.setSizes([_MAP_PX, 3 * _MAP_PX // 2])
        return view

    def _connect(self) -> None:
        self._map.selected.connect(self.select)
        self._scene.picked.connect(self.select)
        self._scene.rotated.connect(self._map.set_rotation)
        self._selected.check_wanted.connect(self._check)
        self._choice.chosen.connect(self._choose)
        self._choice.withdrawn.connect(self._withdraw)
        self._compare.compared.connect(self._compare_with)
        self._compare.variant_wanted.connect(self._variant.start)
        self._variant.imagined.connect(self._compare.show_variant)
        self._compare.session_wanted.connect(self._load_other)
        self._side.primary.clicked.connect(self._go_on)
        self._map.set_rotation(self._scene.rotation_deg)

    # What is shown

    @override
    def content_key(self) -> PoursKey | None:
        folder = self.desk.workspace.folder
        if folder is None or not self.desk.workspace.has("pouring"):
            return None
        return PoursKey(folder, self.desk.cell.settings, self.content)

    @override
    def show_content(self, former: ShownPours | None) -> None:
        pours = self.content
        is_same = pours is not None and pours.is_of_same_run(former)
        if pours is None:
            self._before = None
        elif former is not None and former.grid is not None and not is_same:
            self._before = former.grid
        grid = None if pours is None else pours.grid
        self._left.setVisible(grid is not None)
        self._map.set_pours([] if pours is None else cells_of(pours), None if pours is None else pours.chosen)
        if pours is None:
            self._scene.show_nothing(self.tr("The object and its pours appear here."))
        elif not is_same:
            self._scene.show_pours(pours)
            if grid is not None and self._map.selection is not None:
                self._scene.show_pour(*self._map.selection)
        self._compare.show_grid(grid, self._before)
        self._choice.show_pours(pours, self.failure or self._empty_text())
        self.update_actions()

    def select(self, i: int, j: int) -> None:
        """Show one pour on the map, in 3D and in words."""
        self._map.select(i, j)
        self._scene.show_pour(i, j)
        self.update_actions()

    def _empty_text(self) -> str:
        if self.desk.workspace.session is None:
            return self.tr("Open a session or start a new one; its pours appear here.")
        return self.tr(
            "The pours appear here once the object is imagined: from 8 directions at 3 distances, each with "
            "the share of candies that landed inside."
        )

    # What can be done

    @override
    def update_actions(self) -> None:
        selection, is_idle = self._map.selection, self.desk.jobs.is_idle
        is_fresh = self.desk.workspace.is_fresh("risk")
        has_cell = self.desk.cell.settings is not None
        self._selected.show_pour(self.content, selection, is_idle and is_fresh and has_cell)
        self._choice.set_selection(selection, is_idle and is_fresh)
        self._compare.set_can_imagine(is_idle and is_fresh)
        text, is_enabled, _go = self._next_step()
        self._choice.stale.look(self.desk.workspace, text)
        self._side.primary.setText(text)
        self._side.primary.setEnabled(is_enabled)

    def _next_step(self) -> tuple[str, bool, Callable[[], None]]:
        """What the primary button says, whether it can be pressed now, and what it does."""
        workspace, pours, go_to = self.desk.workspace, self.content, self.desk.page_wanted.emit
        if workspace.session is None or not (workspace.has("scan") or workspace.has("mesh")):
            return self.tr("Scan first"), True, partial(go_to, "scan")
        if not workspace.is_fresh("risk"):
            return self.tr("Imagine"), self.desk.jobs.is_idle, self._imagine
        if pours is not None and pours.grid is None:
            return self.tr("See why"), True, partial(go_to, "imagination")
        return self.tr("Review motion"), pours is not None and pours.is_in_cell, partial(go_to, "robot")

    def _go_on(self) -> None:
        _text, _is_enabled, go = self._next_step()
        go()

    def _imagine(self) -> None:
        host, task = self.desk.session_host, self.desk.workspace.task()
        self.desk.jobs.start(self.tr("Imagine"), self.KEY, host, SessionWork.imagine, task)

    def _check(self) -> None:
        settings = self.desk.cell.settings
        if settings is not None:
            task, host = self.desk.workspace.task(), self.desk.session_host
            title = self.tr("Check the pours with the arm")
            self.desk.jobs.start(title, self.KEY, host, SessionWork.judge_motions, task, settings)

    def _choose(self, reason: str) -> None:
        session, selection = self.desk.workspace.session, self._map.selection
        if session is None or selection is None:
            return
        try:
            choose_pour(session, *selection, reason)
        except PoursightError as error:
            self.report(error)
            return
        self._choice.clear_reason()
        self.desk.workspace.refresh()

    def _withdraw(self) -> None:
        folder = self.desk.workspace.folder
        if folder is None:
            return
        try:
            withdraw_operator_choice(folder)
        except PoursightError as error:
            self.report(error)
            return
        self.desk.workspace.refresh()

    # Comparing

    def _compare_with(self, other: OtherPours | None) -> None:
        grid = None if self.content is None else self.content.grid
        if other is None or grid is None:
            self._map.set_comparison(None)
        else:
            self._map.set_comparison(other.ratios_for(grid), other.label)

    def _load_other(self, folder: Path) -> None:
        self.desk.background.run(
            "other pours",
            partial(load_grid, folder),
            partial(self._compare.show_session, folder.name),
            lambda error: self._compare.show_problem(worded(error)),
        )


def cells_of(pours: ShownPours) -> list[MappedPour]:
    """Return a grid's pours as the map takes them."""
    grid = pours.grid
    if grid is None:
        return []
    p, spread, has_spread = grid.p, grid.p_spread, grid.n_in.shape[2] > 1
    cells = []
    for i, theta_rad in enumerate(grid.theta_rad):
        for j, indent_m in enumerate(grid.indent_m):
            found = pours.feasibility(i, j)
            cells.append(
                MappedPour(
                    i,
                    j,
                    float(theta_rad),
                    float(indent_m),
                    float(p[i, j]),
                    float(spread[i, j]) if has_spread else None,
                    None if found is None else found.is_feasible,
                    "" if found is None else found.reason,
                )
            )
    return cells


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
        for name in (CUP, CANDIES, PIVOTS, PIVOT, ARROW, CENTER):
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
        self.scene.fit(BODY, AROUND)

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
