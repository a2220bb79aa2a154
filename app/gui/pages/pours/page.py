"""The Pours page: which pour will be made, and why."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout, QSplitter, QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.desk.desk import Desk
from app.gui.desk.workspace import IMAGINING
from app.gui.pages.background_page import BackgroundPage
from app.gui.pages.mode_row import ModeRow
from app.gui.pages.page import SidePanel, SplitView
from app.gui.pages.pour_cells import pour_cells
from app.gui.pages.pours.choice import ChoiceBox, SelectedBox
from app.gui.pages.pours.comparison import CompareBox, OtherPours, VariantRun, load_grid
from app.gui.pages.pours.how_much import HowMuchBox
from app.gui.pages.pours.pour_scene import PourScene
from app.gui.pages.pours.results import PoursKey, ShownPours, load_pours
from app.gui.remedies import worded
from app.gui.theme import GRID_PX
from app.gui.views.pour_map import MappedPour, PourMap
from app.jobs.session_work import SessionWork
from app.operations.choosing import choose_pour
from core.errors import PoursightError
from core.imagination.results import PourGrid
from core.parameters import Parameters
from core.session.operator_choice import withdraw_operator_choice

_MAP_PX = 400
_CLEAN, _INSIDE = "clean", "inside"


class PoursPage(BackgroundPage[PoursKey, ShownPours]):
    """Map and 3D of the pours at the left, the choice and what it is compared with at the right."""

    KEY = "pours"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk, load_pours)
        self._before: PourGrid | None = None
        self._can_show_clean = True
        self._map = PourMap()
        self._measure = ModeRow("pour_measure")
        self._measure.add(
            _CLEAN,
            self.tr("Clean pour"),
            self.tr("How likely a pour that spills nothing is, at least (95 %)"),
        )
        self._measure.add(
            _INSIDE, self.tr("Candies inside"), self.tr("P: how many candies land inside, on average")
        )
        self._measure.chosen.connect(lambda: self._map.show_clean(self._measure.mode == _CLEAN))
        self._selected = SelectedBox()
        self._scene = PourScene()
        self._choice = ChoiceBox()
        self._how_much = HowMuchBox()
        self._compare = CompareBox()
        self._variant = VariantRun(desk, self.KEY, self)
        self._side = SidePanel(self.tr("Review motion"))
        self._side.body.addWidget(self._choice)
        self._side.body.addWidget(self._how_much)
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
        row = QHBoxLayout()
        row.setContentsMargins(GRID_PX, GRID_PX, GRID_PX, 0)
        row.addWidget(self._measure)
        row.addStretch(1)
        column.addLayout(row)
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
        self._how_much.asked.connect(self._ask_for)
        self._how_much.fewer_asked.connect(self._pour_fewer)
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
        if self._is_half_done:
            return self.shown_key  # the pours before stay until one of the new ones is chosen
        return PoursKey(folder, self.desk.cell.settings, self.content)

    @property
    def _is_half_done(self) -> bool:
        """Whether pours are just being imagined of which none is chosen yet."""
        view, job = self.desk.workspace.view, self.desk.jobs.running
        is_imagining = job is not None and job.host is self.desk.session_host
        return is_imagining and view is not None and "risk" not in view.records

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
        selection = self._map.selection
        self._map.set_pours([] if pours is None else cells_of(pours), None if pours is None else pours.chosen)
        self._offer_measures()
        if pours is None:
            self._scene.show_nothing(self.tr("The object and its pours appear here."))
        elif not is_same:
            self._scene.show_pours(pours)
        is_other = not is_same or self._map.selection != selection
        if is_other and grid is not None and self._map.selection is not None:
            self._scene.show_pour(*self._map.selection)
        self._compare.show_grid(grid, self._before)
        self._choice.show_pours(pours, self.failure or self._empty_text())
        self.update_actions()

    def _offer_measures(self) -> None:
        """Without tries, and against another grid, only P is known."""
        tip = self.tr("How likely a pour that spills nothing is, at least (95 %)")
        if self._compare.other is not None:
            tip = self.tr("Pours are compared by the candies that land inside")
        elif not self._map.has_clean:
            tip = self.tr("No tries are known of these pours; imagine again")
        can_show = self._map.has_clean and self._compare.other is None
        if can_show != self._can_show_clean:
            self._can_show_clean = can_show
            self._measure.choose(_CLEAN if can_show else _INSIDE)
        self._measure.set_available(_CLEAN, can_show, tip)

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
        self._how_much.setVisible(self.content is not None and self.content.grid is not None)
        risk = self.content.risk if self.content is not None and is_fresh else None
        fewer = None if risk is None else risk.fewer
        self._how_much.show_amount(self.desk.workspace.parameters, fewer, is_idle)
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
        host, workspace = self.desk.session_host, self.desk.workspace
        steps, task = workspace.steps_to(*IMAGINING), workspace.task()
        self.desk.jobs.start(self.tr("Imagine"), self.KEY, host, SessionWork.imagine, task, steps=steps)

    def _ask_for(self, parameters: Parameters) -> None:
        self.desk.workspace.edit(parameters, self.tr("amount"))

    def _pour_fewer(self, parameters: Parameters) -> None:
        self._ask_for(parameters)
        self._imagine()

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
        self._offer_measures()

    def _load_other(self, folder: Path) -> None:
        self.desk.background.run(
            "other pours",
            partial(load_grid, folder),
            partial(self._compare.show_session, folder.name),
            lambda error: self._compare.show_problem(worded(error)),
        )


def cells_of(pours: ShownPours) -> list[MappedPour]:
    """Return a grid's pours as the map takes them."""
    return [] if pours.grid is None else pour_cells(pours.grid, pours.risk, pours.motions)
