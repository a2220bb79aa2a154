"""The Pours page: which pour will be made, and why."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QSplitter, QVBoxLayout, QWidget

from app.choosing import keep_choice
from app.gui.desk.desk import Desk
from app.gui.pages.page import Page, SidePanel, SplitView
from app.gui.pages.pours.choice_box import ChoiceBox
from app.gui.pages.pours.compare_box import CompareBox
from app.gui.pages.pours.comparison import OtherPours, load_grid
from app.gui.pages.pours.results import ShownPours, load_pours
from app.gui.pages.pours.scene import PourScene
from app.gui.pages.pours.selected_box import SelectedBox
from app.gui.pages.pours.variant import VariantRun
from app.gui.views.pour_map import PourCell, PourMap
from app.jobs.session_work import SessionWork
from core.errors import PoursightError
from core.imagination.results import PourGrid
from core.session.operator_choice import withdraw_operator_choice

_MAP_PX = 400


class PoursPage(Page):
    """Map and 3D of the pours at the left, the choice and what it is compared with at the right."""

    KEY = "pours"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self._pours: ShownPours | None = None
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
        self._show(None)

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
        self._scene.turned.connect(self._map.set_rotation)
        self._selected.check_wanted.connect(self._check)
        self._choice.chosen.connect(self._choose)
        self._choice.withdrawn.connect(self._withdraw)
        self._compare.compared.connect(self._hold_against)
        self._compare.variant_wanted.connect(self._variant.start)
        self._variant.imagined.connect(self._compare.show_variant)
        self._compare.session_wanted.connect(self._load_other)
        self._side.primary.clicked.connect(self._go_on)
        for signal in (self.desk.jobs.started, self.desk.jobs.finished, self.desk.jobs.failed):
            signal.connect(lambda *_: self._update_buttons())
        self._map.set_rotation(self._scene.rotation_deg)

    # What is shown

    def refresh(self) -> None:
        """Show the session's pours, or what has to be done first."""
        workspace = self.desk.workspace
        folder = workspace.folder
        if folder is None or not workspace.has("pouring"):
            self._before = None
            self._show(None)
            return
        if self._pours is not None and self._pours.folder != folder:
            self._before = None
            self._show(None)
        load = partial(load_pours, folder, self.desk.cell.settings, self._pours)
        self.desk.background.run("pours", load, self._arrive, self._fail)

    def select(self, i: int, j: int) -> None:
        """Show one pour on the map, in 3D and in words."""
        self._map.select(i, j)
        self._scene.show_pour(i, j)
        self._update_buttons()

    def _arrive(self, pours: ShownPours) -> None:
        if pours.folder != self.desk.workspace.folder:
            return
        shown = self._pours
        is_same = shown is not None and (shown.folder, shown.digest) == (pours.folder, pours.digest)
        if shown is not None and not is_same and shown.grid is not None:
            self._before = shown.grid
        self._pours = pours
        self._show(pours, is_same_pours=is_same)

    def _fail(self, error: PoursightError) -> None:
        self._show(None, str(error))

    def _show(self, pours: ShownPours | None, problem: str = "", *, is_same_pours: bool = False) -> None:
        self._pours = pours
        grid = None if pours is None else pours.grid
        self._left.setVisible(grid is not None)
        self._map.set_pours([] if pours is None else cells_of(pours), None if pours is None else pours.chosen)
        if pours is None:
            self._scene.show_nothing(self.tr("The object and its pours appear here."))
        elif not is_same_pours:
            self._scene.show_pours(pours)
            if grid is not None and self._map.selection is not None:
                self._scene.show_pour(*self._map.selection)
        self._compare.show_grid(grid, self._before)
        self._choice.show_pours(pours, problem or self._empty_text())
        self._update_buttons()

    def _empty_text(self) -> str:
        if self.desk.workspace.session is None:
            return self.tr("Open a session or start a new one; its pours appear here.")
        return self.tr(
            "The pours appear here once the object is imagined: from 8 directions at 3 distances, each with "
            "the share of candies that landed inside."
        )

    # What can be done

    def _update_buttons(self) -> None:
        selection, is_idle = self._map.selection, self.desk.jobs.is_idle
        is_fresh = self.desk.workspace.is_fresh("pouring")
        has_cell = self.desk.cell.settings is not None
        self._selected.show_pour(self._pours, selection, is_idle and is_fresh and has_cell)
        self._choice.set_selection(selection, is_idle and is_fresh)
        self._compare.set_can_imagine(is_idle and is_fresh)
        text, is_enabled = self._next_step()
        self._choice.stale.look(self.desk.workspace, text)
        self._side.primary.setText(text)
        self._side.primary.setEnabled(is_enabled)

    def _next_step(self) -> tuple[str, bool]:
        """What the primary button does, and whether it can be done now."""
        workspace, is_idle = self.desk.workspace, self.desk.jobs.is_idle
        if workspace.session is None or not (workspace.has("scan") or workspace.has("mesh")):
            return self.tr("Scan first"), True
        if not workspace.is_fresh("pouring"):
            return self.tr("Imagine"), is_idle
        if self._pours is not None and self._pours.grid is None:
            return self.tr("See why"), True
        return self.tr("Review motion"), self._pours is not None and self._pours.stands_in_cell

    def _go_on(self) -> None:
        workspace = self.desk.workspace
        if workspace.session is None or not (workspace.has("scan") or workspace.has("mesh")):
            self.desk.page_wanted.emit("scan")
        elif not workspace.is_fresh("pouring"):
            host = self.desk.session_host
            self.desk.jobs.start(self.tr("Imagine"), self.KEY, host, SessionWork.imagine, workspace.task())
        elif self._pours is not None and self._pours.grid is None:
            self.desk.page_wanted.emit("imagination")
        else:
            self.desk.page_wanted.emit("robot")

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
            keep_choice(session, *selection, reason)
        except PoursightError as error:
            self.desk.told.emit(str(error))
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
            self.desk.told.emit(str(error))
            return
        self.desk.workspace.refresh()

    # Comparing

    def _hold_against(self, other: OtherPours | None) -> None:
        grid = None if self._pours is None else self._pours.grid
        if other is None or grid is None:
            self._map.set_comparison(None)
        else:
            self._map.set_comparison(other.ratios_for(grid), other.label)

    def _load_other(self, folder: Path) -> None:
        def take(grid: PourGrid) -> None:
            self._compare.show_session(folder.name, grid)

        def refuse(error: PoursightError) -> None:
            self._compare.show_problem(str(error))

        self.desk.background.run("other pours", partial(load_grid, folder), take, refuse)


def cells_of(pours: ShownPours) -> list[PourCell]:
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
                PourCell(
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
