"""Which parameters were changed since a result was made, and the note that says so."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from PySide6.QtWidgets import QHBoxLayout, QLabel, QWidget

from app.gui.desk.workspace import Workspace
from app.gui.theme import GRID_PX
from app.gui.views.parameter_editor.naming import titles
from app.gui.views.state_mark import StateMark
from core.parameters import describe
from core.pipeline.needs import Freshness, source_of, stage_needs

_TOLD = 2
"""Parameters that are named; of the others only the number is told."""


def changed_since(workspace: Workspace, stages: Sequence[str]) -> list[str]:
    """Return the dotted names of the parameters that differ from those that stages were made with."""
    session = workspace.session
    if session is None:
        return []
    needs = stage_needs(workspace.parameters, source_of(session))
    names: list[str] = []
    for stage in stages:
        record = session.record(stage)
        if record is not None and stage in needs:
            before, now = dict(_leaves(record.parameters)), dict(_leaves(needs[stage].settings))
            names += [_full_name(stage, key) for key in now if before.get(key) != _plain(now[key])]
    return list(dict.fromkeys(names))


def _leaves(table: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in table.items():
        if isinstance(value, Mapping):
            yield from _leaves(value, f"{prefix}{name}.")
        else:
            yield prefix + name, value


def _plain(value: Any) -> Any:
    """A value as JSON gives it back."""
    return list(value) if isinstance(value, tuple) else value


def _full_name(stage: str, key: str) -> str:
    """The parameter behind a stage's setting: records hold some without the name of their group."""
    known = [fact.name for fact in describe()]
    if key in known:
        return key
    endings = [f"{stage}.{key}", f".{key}"]
    return next((name for end in endings for name in known if name.endswith(end)), key)


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
        """Show itself if one of the stages is stale; `button` is the text of the one that mends it."""
        stale = [name for name in self._stages if workspace.stages.get(name) is Freshness.STALE]
        self.setVisible(bool(stale))
        if stale:
            self._label.setText(self._sentence(changed_since(workspace, self._stages), button))

    def _sentence(self, names: list[str], button: str) -> str:
        if not names:
            return self.tr("This is from an earlier scan or model: press {button}.").format(button=button)
        words = titles(describe())
        told = ", ".join(f"“{words.get(name, name)}”" for name in names[:_TOLD])
        if len(names) > _TOLD:
            told = self.tr("{told} and {n} more").format(told=told, n=len(names) - _TOLD)
        return self.tr("This is from before you changed {told}: press {button}.").format(
            told=told, button=button
        )
