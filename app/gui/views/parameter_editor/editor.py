"""The parameter editor: preset, filter, and the tree of parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from PySide6.QtCore import QEvent, QSignalBlocker, QSize, Qt, Signal
from PySide6.QtWidgets import QCheckBox, QComboBox, QHBoxLayout, QLabel, QLineEdit, QVBoxLayout, QWidget

from app.gui.theme import GRID_PX
from app.gui.views.parameter_editor.model import ParameterFilter, ParameterModel
from app.gui.views.parameter_editor.view import ParameterView
from core.parameters import PRESET_NAMES, Parameters


class ParameterEditor(QWidget):
    """Edits some or all groups of the parameters, told against a preset.

    Undo is the owner's: push what `edited` brings and hand it back through `set_parameters`.

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
        self._model = ParameterModel(groups, self)
        self._model.edited.connect(self._pass_on)
        self._filter = ParameterFilter(self._model)
        self._build()
        self.set_preset_names(preset_names)
        self.set_parameters(Parameters(), "default", Parameters())

    def _build(self) -> None:
        self._presets = QComboBox(self)
        self._presets.setObjectName("parameter_preset")
        self._presets.setAccessibleName(self.tr("Preset"))
        self._presets.setToolTip(self.tr("Take all values from a preset; Undo brings yours back"))
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
        self._only_different.setToolTip(self.tr("Show only what differs from the preset"))
        self._only_different.toggled.connect(self._apply_filter)
        self._none = QLabel(self)
        self._none.setObjectName("parameter_none")
        self._none.setWordWrap(True)
        self._view = ParameterView(self._filter, self)
        # queued: rows may come and go, which they must not while the view handles a click or closes an editor
        entered = self._view.parameter_delegate.value_entered
        entered.connect(self._model.set_value, Qt.ConnectionType.QueuedConnection)
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
        column.addWidget(self._view, 1)

    @property
    def parameters(self) -> Parameters:
        """As they are now, with the groups that are not shown."""
        return self._model.parameters

    @property
    def n_different(self) -> int:
        """How many of the parameters shown differ from the preset."""
        return self._model.n_different()

    def set_preset_names(self, names: Sequence[str], tips: Mapping[str, str] | None = None) -> None:
        """Offer these presets; a name that is a file is shown by its stem, and told of by its tip if any."""
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
        self._model.load(parameters, preset)
        self._refilter()

    def set_value(self, name: str, value: object) -> None:
        """Enter a value as if it were typed: it is set and told, or refused in its row."""
        self._model.set_value(name, value)

    def error(self, name: str) -> str:
        """Return why the value just entered for a parameter was refused, or ""."""
        return self._model.row_facts(name).error

    def reveal(self, name: str) -> None:
        """Scroll to a parameter and make it the current one, whatever was filtered."""
        self._search.clear()
        self._only_different.setChecked(False)
        index = self._filter.index_of(name)
        self._view.setCurrentIndex(index)
        self._view.scrollTo(index)

    def _pass_on(self, parameters: Parameters) -> None:
        self._refilter()
        self.edited.emit(parameters)

    def _choose_preset(self, index: int) -> None:
        self.preset_chosen.emit(str(self._presets.itemData(index)))

    def _apply_filter(self) -> None:
        self._filter.set_filter(self._search.text().strip(), self._only_different.isChecked())
        self._view.expandAll()
        self._tell_count()

    def _refilter(self) -> None:
        """Find anew what differs: the proxy alone misses a group whose first row comes to differ."""
        if self._only_different.isChecked():
            self._apply_filter()
        else:
            self._tell_count()

    def _tell_count(self) -> None:
        n = self._model.n_different()
        text = self.tr("{n} differs from preset") if n == 1 else self.tr("{n} differ from preset")
        self._count.setText(text.format(n=n) if n else self.tr("same as preset"))
        is_empty = self._filter.rowCount() == 0
        self._none.setVisible(is_empty)
        if is_empty and self._search.text().strip():
            self._none.setText(self.tr("No parameter matches the filter."))
        else:
            self._none.setText(self.tr("Nothing differs from the preset."))

    def sizeHint(self) -> QSize:
        """Return a side panel's size."""
        return QSize(360, 480)

    def changeEvent(self, event: QEvent) -> None:
        """Repaint in another theme."""
        super().changeEvent(event)
        if event.type() in (QEvent.Type.PaletteChange, QEvent.Type.EnabledChange):
            self._view.viewport().update()
