"""Which parameters were changed since a result was made, and the note that says so."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtWidgets import QHBoxLayout, QLabel, QWidget

from app.gui.desk.workspace import Workspace
from app.gui.theme import GRID_PX
from app.gui.views.parameter_editor.naming import titles
from app.gui.views.state_mark import StateMark
from core.parameters import describe
from core.pipeline.freshness import Freshness
from core.stages import changed_settings

_MOST_NAMED = 2
"""Parameters that are named; of the others only the number is given."""


def changed_since(workspace: Workspace, stages: Sequence[str]) -> list[str]:
    """Return the dotted names of the parameters that differ from those that stages were made with."""
    names: list[str] = []
    for stage in stages:
        record = workspace.record(stage)
        if record is not None:
            names += changed_settings(stage, record.parameters, workspace.parameters)
    return list(dict.fromkeys(names))


class StaleNote(QWidget):
    """Says that a result is not what the parameters would give now, and what to press."""

    def __init__(self, stages: Sequence[str], parent: QWidget | None = None) -> None:
        """`stages` are those the result comes from, the result's own last."""
        super().__init__(parent)
        self.setObjectName("stale_note")
        self._stages = tuple(stages)
        self._label = QLabel()
        self._label.setObjectName("stale_text")
        self._label.setProperty("role", "attention")
        self._label.setWordWrap(True)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(GRID_PX)
        row.addWidget(StateMark("stale"))
        row.addWidget(self._label, 1)
        self.hide()

    @property
    def text(self) -> str:
        """What it says; empty while nothing is stale."""
        return self._label.text() if not self.isHidden() else ""

    def look(self, workspace: Workspace, button: str) -> None:
        """Show itself if one of the stages is stale; `button` is the text of the one that runs them again."""
        stale = [name for name in self._stages if workspace.stages.get(name) is Freshness.STALE]
        self.setVisible(bool(stale))
        if stale:
            self._label.setText(self._sentence(changed_since(workspace, self._stages), button))

    def _sentence(self, names: list[str], button: str) -> str:
        if not names:
            return self.tr("This is from an earlier scan or model: press {button}.").format(button=button)
        words = titles(describe())
        named = ", ".join(f"“{words.get(name, name)}”" for name in names[:_MOST_NAMED])
        if len(names) > _MOST_NAMED:
            named = self.tr("{named} and {n} more").format(named=named, n=len(names) - _MOST_NAMED)
        return self.tr("This is from before you changed {named}: press {button}.").format(
            named=named, button=button
        )
