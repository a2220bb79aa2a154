"""While the arm moves: which move, how far, how long still."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QProgressBar

from app.gui.pages.robot.motion import ShownMotion
from app.gui.pages.robot.panel import Panel
from app.gui.pages.robot.words import MM, move_words, progress_words
from app.gui.views.labels import say, text_label
from app.gui.views.painting import tabular
from app.jobs.arm_news import MoveProgress

_STEPS = 1000


class LivePanel(Panel):
    """Follows the moves."""

    def __init__(self) -> None:
        super().__init__("live_panel", "")
        self._move = text_label("live_move")
        self._move.setAlignment(Qt.AlignmentFlag.AlignTop)
        self._move.setMinimumHeight(2 * self._move.fontMetrics().height())  # nothing below jumps
        self._bar = QProgressBar()
        self._bar.setObjectName("live_bar")
        self._bar.setAccessibleName(self.tr("How much of the motion is done"))
        self._bar.setRange(0, _STEPS)
        self._bar.setTextVisible(False)
        self._left = text_label("live_left", "heading")
        self._left.setFont(tabular(self.font()))
        self._pivot = text_label("live_pivot", "muted")
        self._pivot.setFont(tabular(self.font()))
        kept = self._pivot.sizePolicy()
        kept.setRetainSizeWhenHidden(True)
        self._pivot.setSizePolicy(kept)
        self._pivot.setToolTip(self.tr("By where the controller says the joints are"))
        self._stop = text_label(
            "live_stop",
            "muted",
            self.tr("STOP, or its key F12, stops the arm at once; it then stands where it is."),
        )
        for one in (self._move, self._bar, self._left, self._pivot, self._stop):
            self.column.addWidget(one)

    def begin(self, is_way_back: bool) -> None:
        """Nothing has moved yet."""
        self.heading.setText(self.tr("Backing off") if is_way_back else self.tr("Pouring"))
        say(self._move, self.tr("The whole plan is checked once more before anything moves."))
        self._bar.setValue(0)
        say(self._left, "")
        say(self._pivot, "")

    def follow(self, progress: MoveProgress, motion: ShownMotion) -> None:
        """Show how far it is."""
        say(
            self._move,
            self.tr("{name}: {words}").format(name=progress.name, words=move_words(progress.name)),
        )
        self._bar.setValue(round(_STEPS * progress.done_s / motion.duration_s))
        say(self._left, progress_words(progress, len(motion.moves)))
        off_m = progress.pivot_off_m
        said = (
            "" if off_m is None else self.tr("The pivot is {mm:.2f} mm from its place.").format(mm=off_m * MM)
        )
        say(self._pivot, said)
