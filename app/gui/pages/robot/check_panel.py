"""The plan in words, and what somebody has to see to before the arm moves."""

from __future__ import annotations

import time

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QCheckBox

from app.gui.pages.fact_grid import FactGrid
from app.gui.pages.robot.panel import Panel
from app.gui.pages.robot.words import checks, minutes_words, plan_facts
from app.gui.theme import GRID_PX
from app.gui.views.labels import say, text_label
from app.jobs.arm_news import PlannedPour
from core.session.cups import Cup

_NO_CUP = Cup(1, 1, 0, None)


class CheckPanel(Panel):
    """Ticks are gone with every new plan.

    Attributes:
        ticked: something was ticked or not any more.
    """

    ticked = Signal()

    def __init__(self) -> None:
        super().__init__("check_panel", self.tr("Check, then hold to pour"))
        self._number = 0
        self._note = text_label("plan_note", "muted")
        self._facts = FactGrid("plan_facts")
        self._checks: tuple[QCheckBox, ...] = ()
        self._rehearsal = text_label("rehearsal", "muted")
        self._expiry = text_label("plan_expiry", "muted")
        self._reason = text_label("hold_reason", "attention")
        for one in (self._facts, self._note):
            self.column.addWidget(one)
        self.column.addWidget(text_label("checks_heading", "heading", self.tr("I have seen to it:")))
        self._checks = tuple(self._check(name) for name, *_ in checks(_NO_CUP))
        for one in (self._rehearsal, self._expiry, self._reason):
            self.column.addWidget(one)

    def show_plan(self, planned: PlannedPour, cup: Cup, *, is_rehearsal: bool) -> None:
        """Show a plan; of another one nothing is ticked yet, unless it is a rehearsal."""
        say(self._note, planned.note)
        self._facts.set_facts(plan_facts(planned.plan))
        for check, (_, words, tip) in zip(self._checks, checks(cup), strict=True):
            check.setText(words)
            check.setAccessibleName(words)
            check.setToolTip(tip)
            if planned.number != self._number:
                check.setChecked(is_rehearsal)
        say(self._rehearsal, self._rehearsal_words() if is_rehearsal else "")
        self._number = planned.number
        self.look(planned)

    def look(self, planned: PlannedPour) -> None:
        """Say how long the plan still holds."""
        left_s = planned.expires_s - time.monotonic()
        said = self.tr("The plan holds for another {time}.").format(time=minutes_words(left_s))
        say(self._expiry, said if left_s > 0 else "")
        say(self._reason, self.reason(planned))

    def reason(self, planned: PlannedPour) -> str:
        """Why the arm must not move yet; empty if it may."""
        if time.monotonic() >= planned.expires_s:
            return self.tr("The plan has expired: plan again.")
        left = sum(not check.isChecked() for check in self._checks)
        if left == len(self._checks):
            return self.tr("Tick each point when you have seen to it.")
        if left:
            return self.tr("{n} more to tick.").format(n=left)
        return ""

    def _rehearsal_words(self) -> str:
        return self.tr("SIMULATED: ticked already. With a real arm each point is yours to tick.")

    def _check(self, name: str) -> QCheckBox:
        check = QCheckBox()
        check.setObjectName(f"check_{name}")
        check.setMinimumHeight(3 * GRID_PX)
        check.toggled.connect(lambda _: self.ticked.emit())
        self.column.addWidget(check)
        return check
