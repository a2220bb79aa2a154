"""The pours of the session, the newest first."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime

from PySide6.QtCore import Qt, Signal

from app.gui.pages.robot.panel import Panel
from app.gui.theme import GRID_PX
from app.gui.views.health_table import Column, FactTable, Row
from core.session.pour_runs import PourRun

_MOST_SHOWN = 6


class RunsPart(Panel):
    """A table of runs; a click asks for a pour's outcome.

    Attributes:
        chosen: the folder of the run that was clicked.
    """

    chosen = Signal(object)

    def __init__(self) -> None:
        super().__init__("runs_part", self.tr("Pours of this session"))
        self.heading.setProperty("role", "heading")
        self._runs: tuple[PourRun, ...] = ()
        self.table = FactTable(
            (
                Column(self.tr("When"), tooltip=self.tr("When the run was confirmed"), align="left"),
                Column(self.tr("Spilled"), tooltip=self.tr("Candies beside the object")),
                Column(self.tr("How it ended"), align="left"),
            )
        )
        self.table.setObjectName("runs_table")
        self.table.setAccessibleName(self.tr("Pours of this session"))
        self.table.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.table.row_selected.connect(self._choose)
        self.column.addWidget(self.table)

    def show_runs(self, runs: Sequence[PourRun]) -> None:
        """Show other runs; nothing, if there are none."""
        self._runs = tuple(reversed(runs))
        self.setVisible(bool(runs))
        self.table.set_rows([self._row(run) for run in self._runs])
        rows = min(len(self._runs), _MOST_SHOWN)
        line = self.table.verticalHeader().defaultSectionSize()
        self.table.setFixedHeight(
            self.table.horizontalHeader().sizeHint().height() + rows * line + GRID_PX // 2
        )

    def select(self, run: object) -> None:
        """Mark the run whose outcome is asked for; none: none of them."""
        found = [k for k, one in enumerate(self._runs) if one.folder == run]
        self.table.select_row(found[0] if found else None)

    def _row(self, run: PourRun) -> Row:
        return Row(
            (_clock(run.begun), self._spilled(run), self._ending(run)),
            tooltip="\n".join(filter(None, (run.sentence, run.note, self._outcome(run)))),
            needs_attention=run.is_done and not run.is_back_off and run.outcome is None,
        )

    def _spilled(self, run: PourRun) -> str | None:
        if run.outcome is None or run.outcome.n_spilled is None:
            return None
        said = str(run.outcome.n_spilled)
        return self.tr("{n} (sim.)").format(n=said) if run.outcome.is_simulated else said

    def _ending(self, run: PourRun) -> str:
        if run.is_done:
            return self.tr("backed off") if run.is_back_off else self.tr("poured")
        return self.tr("stopped on the way back") if run.is_back_off else self.tr("stopped")

    def _outcome(self, run: PourRun) -> str:
        if run.is_back_off or not run.is_done:
            return ""
        return run.outcome.sentence if run.outcome else self.tr("Its outcome was not entered yet: click.")

    def _choose(self, index: int) -> None:
        run = self._runs[index]
        if run.is_done and not run.is_back_off:
            self.chosen.emit(run.folder)


def _clock(time: str) -> str:
    return datetime.fromisoformat(time).astimezone().strftime("%d %b %H:%M") if time else "--"
