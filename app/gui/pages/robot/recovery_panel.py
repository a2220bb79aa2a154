"""After a stop: what happened, and the way out in steps."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QPainter, QPaintEvent
from PySide6.QtWidgets import QHBoxLayout, QPushButton, QSizePolicy, QWidget
from typing_extensions import override

from app.gui.pages.robot.discs import DiscState, paint_disc, state_of
from app.gui.pages.robot.panel import Panel
from app.gui.pages.robot.steps import Step
from app.gui.theme import GRID_PX, theme_of
from app.gui.views.labels import say, text_label

_DISC_PX = 24


class RecoveryPanel(Panel):
    """Four steps, one of which is the next.

    Attributes:
        by_hand: somebody has put the arm right by hand and wants to connect anew.
    """

    by_hand = Signal()

    def __init__(self) -> None:
        super().__init__("recovery_panel", self.tr("The arm was stopped"))
        self._what = text_label("recovery_what", "attention")
        self._failure = text_label("recovery_failure", "failed")
        self.column.addWidget(self._what)
        self._steps = (
            _GuideStep(1, self.tr("Look what stopped it, and put that right.")),
            _GuideStep(2, self.tr("Recover: make the arm ready again. It does not move.")),
            _GuideStep(
                3,
                self.tr(
                    "Let it back off slowly on its checked way: the cup upright to its station, then home."
                ),
            ),
            _GuideStep(4, self.tr("See that the cup stands at its station and is filled; then plan anew.")),
        )
        for step in self._steps:
            self.column.addWidget(step)
        self.column.addWidget(self._failure)
        self._by_hand = QPushButton(self.tr("It was put right by hand: connect anew"))
        self._by_hand.setObjectName("by_hand")
        self._by_hand.setProperty("role", "link")
        self._by_hand.setToolTip(
            self.tr("The way back is forgotten: the cup is out of the hand, and the arm at home")
        )
        self._by_hand.clicked.connect(self.by_hand)
        self.column.addWidget(self._by_hand)

    def show_step(self, step: Step, what: str, must_back_off: bool, failure: str) -> None:
        """Show which step is the next.

        Args:
            step: one of the recovery.
            what: what happened or is in the way, in sentences.
            must_back_off: whether the arm stands on its way.
            failure: why the last try failed; empty if it did not.
        """
        say(self._what, what)
        say(self._failure, failure)
        current = 2 if step is Step.STOPPED else 3
        for guide in self._steps:
            guide.set_current(current)
        self._steps[2].setVisible(must_back_off)
        self._steps[3].renumber(4 if must_back_off else 3)
        self._by_hand.setVisible(bool(failure))


class _GuideStep(QWidget):
    """A numbered sentence; done ones have a tick."""

    def __init__(self, number: int, text: str) -> None:
        super().__init__()
        self.setObjectName(f"guide_{number}")
        self._disc = _Disc(number)
        self._text = text_label(f"guide_text_{number}", "", text)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(GRID_PX)
        row.addWidget(self._disc, 0, Qt.AlignmentFlag.AlignTop)
        row.addWidget(self._text, 1)

    def renumber(self, number: int) -> None:
        """Take another number."""
        self._disc.number = number
        self._disc.update()

    def set_current(self, current: int) -> None:
        """Know which step is the next."""
        number = self._disc.number
        # Looking is done by whoever presses the button of the second step: both are the next one.
        state = "next" if (number, current) == (1, 2) else state_of(number, current)
        self._disc.set_state(state)
        font = self._text.font()
        font.setBold(state == "next")
        self._text.setFont(font)


class _Disc(QWidget):
    def __init__(self, number: int) -> None:
        super().__init__()
        self.number = number
        self._state: DiscState = "to come"
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)

    def set_state(self, state: DiscState) -> None:
        self._state = state
        self.setAccessibleName(self.tr("done") if state == "done" else str(self.number))
        self.update()

    @override
    def sizeHint(self) -> QSize:
        return QSize(_DISC_PX, _DISC_PX)

    @override
    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.update()

    @override
    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        paint_disc(painter, QRectF(self.rect()), self.number, self._state, theme_of(self), self.font())
        painter.end()
