"""Below the view: whether the scan is good enough, why, and what to do."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from app.gui.theme import GRID_PX
from app.gui.views.state_mark import State, StateMark

_HEIGHT_PX = 10 * GRID_PX
"""Kept whatever is said: if it changed, the 3D view would jump, and be drawn anew."""
_TOLD = 3
"""Reasons that are shown; the others are in the tooltip."""


class VerdictPart(QWidget):
    """A sentence with a mark, its reasons, and a button for what to do.

    Attributes:
        action: does what the sentence asks for; shown by the page if there is something to do.
    """

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("scan_verdict")
        self.setMinimumHeight(_HEIGHT_PX)
        self._mark = StateMark("empty")
        self._headline = QLabel()
        self._headline.setObjectName("headline")
        self._headline.setProperty("role", "verdict")
        self._headline.setWordWrap(True)
        self._details = QLabel()
        self._details.setObjectName("details")
        self._details.setWordWrap(True)
        self._details.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.action = QPushButton()
        self.action.setObjectName("verdict_action")
        below = QHBoxLayout()
        below.setSpacing(2 * GRID_PX)
        below.addWidget(self._details, 1)
        below.addWidget(self.action, 0, Qt.AlignmentFlag.AlignTop)
        texts = QVBoxLayout()
        texts.setSpacing(GRID_PX // 2)
        texts.addWidget(self._headline)
        texts.addLayout(below)
        texts.addStretch(1)
        row = QHBoxLayout(self)
        row.setContentsMargins(2 * GRID_PX, GRID_PX, 2 * GRID_PX, GRID_PX)
        row.setSpacing(GRID_PX)
        row.addWidget(self._mark, 0, Qt.AlignmentFlag.AlignTop)
        row.addLayout(texts, 1)
        self.say("empty", "")

    def say(
        self, state: State, headline: str, details: Sequence[str] = (), action: str = "", tooltip: str = ""
    ) -> None:
        """Show a sentence.

        Args:
            state: of the scan, for the mark.
            headline: the sentence.
            details: further ones.
            action: text of the button.
            tooltip: where the headline's numbers come from.
        """
        self._mark.set_state(state)
        self._headline.setText(headline)
        self._headline.setToolTip(tooltip)
        more = len(details) - _TOLD
        shown = list(details[:_TOLD])
        if more > 0:
            shown.append(self.tr("More of this in the tooltip: {n}.").format(n=more))
        self._details.setText("\n".join(shown))
        self._details.setToolTip("\n".join(details) if more > 0 else "")
        self.action.setText(action)
        self.action.setAccessibleName(action)
