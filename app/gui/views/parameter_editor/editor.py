"""The parameter editor: preset, filter, and the tree of parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from PySide6.QtCore import QSignalBlocker, QSize, Qt, Signal
from PySide6.QtWidgets import QCheckBox, QComboBox, QHBoxLayout, QLabel, QLineEdit, QVBoxLayout, QWidget

from app.gui.theme import GRID_PX
from app.gui.views.parameter_editor.draft import Draft
from app.gui.views.parameter_editor.tree import VALUE, ParameterTree
from core.parameters import PRESET_NAMES, Parameters


class ParameterEditor(QWidget):
    """Edits some or all groups of the parameters, compared with a preset.

    Undo is the owner's: push what `edited` sends and hand it back through `set_parameters`.

    Attributes:
        edited: the new Parameters after the user set a value; not sent by `set_parameters`.
        preset_chosen: the name or file of the preset the user wants.
    """

    edited = Signal(object)
    preset_chosen = Signal(str)

    def __init__(
        self,
        groups: Sequence[str] = (),
        preset_names: Sequence[str] = PRESET_NAMES,
        parent: QWidget | None = None,
    ) -> None:
        """Make one for the groups named, such as ("reconstruction", "collision"); none: for all."""
        super().__init__(parent)
        self.setObjectName("parameter_editor")
        self._draft = Draft(Parameters(), Parameters())
        self._tree = ParameterTree(self._draft, groups, self)
        # queued: rows may be hidden, which they must not while the tree closes an editor
        self._tree.value_entered.connect(self.set_value, Qt.ConnectionType.QueuedConnection)
        self._build()
        self.set_preset_names(preset_names)
        self.set_parameters(Parameters(), "default", Parameters())

    def _build(self) -> None:
        self._presets = QComboBox(self)
        self._presets.setObjectName("parameter_preset")
        self._presets.setAccessibleName(self.tr("Preset"))
        self._presets.setToolTip(self.tr("Take all values from a preset; Undo restores yours"))
        self._presets.activated.connect(self._choose_preset)
        self._count = QLabel(self)
        self._count.setObjectName("parameter_count")
        self._search = QLineEdit(self)
        self._search.setObjectName("parameter_filter")
        self._search.setPlaceholderText(self.tr("Filter by name"))
        self._search.setAccessibleName(self.tr("Filter by name"))
        self._search.setClearButtonEnabled(True)
        self._search.textChanged.connect(self._apply_filter)
        self._only_different = QCheckBox(self.tr("Only different"), self)
        self._only_different.setObjectName("parameter_only_different")
        self._only_different.setToolTip(self.tr("Show only parameters that differ from the preset"))
        self._only_different.toggled.connect(self._apply_filter)
        self._none = QLabel(self)
        self._none.setObjectName("parameter_none")
        self._none.setWordWrap(True)
        self._lay_out()

    def _lay_out(self) -> None:
        label = QLabel(self.tr("Preset"), self)
        label.setBuddy(self._presets)
        first, second = QHBoxLayout(), QHBoxLayout()
        first.addWidget(label)
        first.addWidget(self._presets, 1)
        first.addWidget(self._count)
        second.addWidget(self._search, 1)
        second.addWidget(self._only_different)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID_PX)
        for row in (first, second):
            row.setSpacing(GRID_PX)
            column.addLayout(row)
        column.addWidget(self._none)
        column.addWidget(self._tree, 1)

    @property
    def parameters(self) -> Parameters:
        """As they are now, with the groups that are not shown."""
        return self._draft.parameters

    @property
    def n_different(self) -> int:
        """How many of the parameters shown differ from the preset."""
        return sum(map(self._draft.differs, self._tree.names))

    def set_preset_names(self, names: Sequence[str], tips: Mapping[str, str] | None = None) -> None:
        """Offer these presets; a file is shown by its stem; `tips` may describe it."""
        self._tips = dict(tips or {})
        current = self._presets.currentData()
        with QSignalBlocker(self._presets):
            self._presets.clear()
            for name in names:
                self._add_preset(name)
            self._presets.setCurrentIndex(self._presets.findData(current))

    def _add_preset(self, name: str) -> None:
        is_file = name.endswith(".json")
        self._presets.addItem(Path(name).stem if is_file else name, name)
        self._presets.setItemData(
            self._presets.count() - 1, self._tips.get(name, name), Qt.ItemDataRole.ToolTipRole
        )

    def set_parameters(self, parameters: Parameters, preset_name: str, preset: Parameters) -> None:
        """Show parameters against a preset, without a signal; refused values are forgotten."""
        if self._presets.findData(preset_name) < 0:
            self._add_preset(preset_name)
        with QSignalBlocker(self._presets):
            self._presets.setCurrentIndex(self._presets.findData(preset_name))
        self._draft.load(parameters, preset)
        self._refresh()

    def set_value(self, name: str, value: object) -> None:
        """Enter a value as if it were typed: it is set and `edited` sent, or refused in its row."""
        has_changed = self._draft.set(name, value)
        self._refresh()
        if has_changed:
            self.edited.emit(self._draft.parameters)

    def error(self, name: str) -> str:
        """Return why the value just entered for a parameter was refused, or ""."""
        return self._draft.errors.get(name, "")

    def reveal(self, name: str) -> None:
        """Scroll to a parameter and make it the current one, whatever was filtered."""
        self._search.clear()
        self._only_different.setChecked(False)
        self._tree.setCurrentItem(self._tree.row(name), VALUE)
        self._tree.scrollToItem(self._tree.row(name))

    def _choose_preset(self, index: int) -> None:
        self.preset_chosen.emit(str(self._presets.itemData(index)))

    def _refresh(self) -> None:
        self._tree.refresh()
        self._apply_filter()

    def _apply_filter(self) -> None:
        text = self._search.text().strip()
        n_shown = self._tree.filter_rows(text, self._only_different.isChecked())
        self._none.setVisible(n_shown == 0)
        nothing_differs = self.tr("Nothing differs from the preset.")
        self._none.setText(self.tr("No parameter matches the filter.") if text else nothing_differs)
        n = self.n_different
        count = self.tr("{n} differs from preset") if n == 1 else self.tr("{n} differ from preset")
        self._count.setText(count.format(n=n) if n else self.tr("same as preset"))

    def sizeHint(self) -> QSize:
        """Return a side panel's size."""
        return QSize(360, 480)
