"""The parameters as a tree: groups, a row for each parameter, and why a value was refused under its row."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import (
    QAbstractItemModel,
    QEvent,
    QModelIndex,
    QPersistentModelIndex,
    QRectF,
    QSize,
    Qt,
    Signal,
)
from PySide6.QtGui import QBrush, QKeyEvent, QPainter, QResizeEvent
from PySide6.QtWidgets import (
    QHeaderView,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QTreeWidget,
    QTreeWidgetItem,
    QWidget,
)

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import tabular
from app.gui.views.parameter_editor.draft import Draft
from app.gui.views.parameter_editor.inputs import ChoiceInput, NumberInput, PointInput
from app.gui.views.parameter_editor.naming import group_title, titles

NAME, VALUE, RESET = range(3)
_VALUE_PX, _RESET_PX, _INDENT_PX = 144, 24, 12
_DOTTED_NAME = Qt.ItemDataRole.UserRole
_EDIT_KEYS = (Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_F2, Qt.Key.Key_Space)
_Index = QModelIndex | QPersistentModelIndex


class ParameterTree(QTreeWidget):
    """A click, Enter, F2 or Space edits the current row, Delete resets it.

    Attributes:
        value_entered: (dotted name, value) to set.
    """

    value_entered = Signal(str, object)

    def __init__(self, draft: Draft, groups: Sequence[str], parent: QWidget) -> None:
        super().__init__(parent)
        self._draft = draft
        self._titles = titles(list(draft.facts.values()))
        self._rows: dict[str, QTreeWidgetItem] = {}
        self._groups: dict[str, QTreeWidgetItem] = {}
        self.setObjectName("parameter_view")
        self.setAccessibleName(self.tr("Parameters"))
        self.setColumnCount(3)
        self.setHeaderHidden(True)
        self.setIndentation(_INDENT_PX)
        self.setFont(tabular(self.font()))
        self.setFrameShape(QTreeWidget.Shape.NoFrame)
        self.setWordWrap(True)
        self.setSelectionMode(QTreeWidget.SelectionMode.NoSelection)
        self.setEditTriggers(QTreeWidget.EditTrigger.NoEditTriggers)
        self.setVerticalScrollMode(QTreeWidget.ScrollMode.ScrollPerPixel)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setExpandsOnDoubleClick(False)
        self.setItemDelegate(_Delegate(draft, self))
        header = self.header()
        header.setStretchLastSection(False)
        header.setMinimumSectionSize(_RESET_PX)
        for column, width in ((VALUE, _VALUE_PX), (RESET, _RESET_PX)):
            header.setSectionResizeMode(column, QHeaderView.ResizeMode.Fixed)
            header.resizeSection(column, width)
        header.setSectionResizeMode(NAME, QHeaderView.ResizeMode.Stretch)
        self._add_rows([name for name in draft.facts if not groups or name.split(".")[0] in groups])
        self.expandAll()
        # queued: rows may come and go, which they must not while a click is handled
        self.itemClicked.connect(self._click, Qt.ConnectionType.QueuedConnection)

    @property
    def names(self) -> tuple[str, ...]:
        """The dotted names of the parameters, also of those that are filtered out."""
        return tuple(self._rows)

    def row(self, name: str) -> QTreeWidgetItem:
        """Return the row of a parameter."""
        return self._rows[name]

    def title(self, name: str) -> str:
        """Return what a parameter is called."""
        return self._titles[name]

    def refresh(self) -> None:
        """Show the draft as it is now."""
        for name, row in self._rows.items():
            self._fill(row, name)

    def filter_rows(self, text: str, only_different: bool) -> int:
        """Show the parameters whose names or descriptions hold a text, or that differ; return how many."""
        for name, row in self._rows.items():
            row.setHidden(not self._matches(name, text.casefold(), only_different))
        for group in reversed(self._groups.values()):
            children = [group.child(k) for k in range(group.childCount())]
            group.setHidden(all(child is None or child.isHidden() for child in children))
        return sum(not row.isHidden() for row in self._rows.values())

    def _add_rows(self, names: Sequence[str]) -> None:
        """Fill the rows before the tree has them: it would measure a row again after each setting."""
        root = QTreeWidgetItem()
        for name in names:
            row = self._make_row(name)
            self._group(name.rpartition(".")[0], root).addChild(row)
            self._fill(row, name)
        self.addTopLevelItems(root.takeChildren())

    def _make_row(self, name: str) -> QTreeWidgetItem:
        row = QTreeWidgetItem([self._titles[name]])
        for column in (NAME, VALUE, RESET):
            row.setData(column, _DOTTED_NAME, name)
        row.setFlags(row.flags() | Qt.ItemFlag.ItemIsEditable)
        tip = self._draft.displays[name].tooltip()
        if self._draft.kinds[name][1]:
            tip += self.tr("<br>Automatic while it is empty.")
        row.setToolTip(NAME, tip)
        row.setToolTip(VALUE, tip)
        self._rows[name] = row
        return row

    def _group(self, name: str, root: QTreeWidgetItem) -> QTreeWidgetItem:
        """The item of a group, made if need be."""
        if not name:
            return root
        if name not in self._groups:
            above, _, leaf = name.rpartition(".")
            group = QTreeWidgetItem(self._group(above, root), [group_title(leaf)])
            group.setFont(NAME, tabular(self.font(), bold=True))
            self._groups[name] = group
        return self._groups[name]

    def _fill(self, row: QTreeWidgetItem, name: str) -> None:
        draft, theme = self._draft, theme_of(self)
        value, preset, write = draft.value(name), draft.preset_value(name), draft.displays[name].text
        differs = draft.differs(name)
        second_line = self.tr("preset: {value}").format(value=write(preset))
        row.setText(NAME, f"{self._titles[name]}\n{second_line}" if differs else self._titles[name])
        row.setText(VALUE, write(value))
        row.setFont(VALUE, tabular(self.font(), bold=differs))
        row.setForeground(VALUE, theme.color("muted") if value is None else QBrush())
        if isinstance(value, bool):
            row.setCheckState(VALUE, Qt.CheckState.Checked if value else Qt.CheckState.Unchecked)
        if not isinstance(value, (bool, str)):
            row.setTextAlignment(VALUE, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        row.setText(RESET, "↺" if differs else "")
        row.setForeground(RESET, theme.color("accent"))
        row.setToolTip(RESET, self.tr("Reset to {value}").format(value=write(preset)) if differs else "")
        row.takeChildren()
        if name in draft.errors:
            refusal = QTreeWidgetItem(row, [draft.errors[name]])
            refusal.setFirstColumnSpanned(True)
            refusal.setForeground(NAME, theme.color("failed"))
            row.setExpanded(True)

    def _matches(self, name: str, text: str, only_different: bool) -> bool:
        draft = self._draft
        if only_different and not draft.differs(name) and name not in draft.errors:
            return False
        words = f"{self._titles[name]} {name} {name.replace('_', ' ')} {draft.facts[name].doc}"
        return text in words.casefold()

    def _click(self, row: QTreeWidgetItem, column: int) -> None:
        if column == VALUE:
            self._begin(row)
        elif column == RESET:
            self._reset(row)

    def _begin(self, row: QTreeWidgetItem) -> None:
        """Toggle yes or no, open an editor for all other values."""
        name = row.data(NAME, _DOTTED_NAME)
        if name is None or self.state() == QTreeWidget.State.EditingState:
            return
        if self._draft.kinds[name][0] == "yes_no":
            self.value_entered.emit(name, not self._draft.value(name))
        else:
            self.editItem(row, VALUE)

    def _reset(self, row: QTreeWidgetItem) -> None:
        name = row.data(NAME, _DOTTED_NAME)
        if name is not None and self._draft.differs(name):
            self.value_entered.emit(name, self._draft.preset_value(name))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Edit or reset the current row."""
        if self.state() == QTreeWidget.State.EditingState:
            return  # an editor passes on the Return that closes it
        row = self.currentItem()
        if row is not None and event.key() in _EDIT_KEYS:
            self._begin(row)
        elif row is not None and event.key() == Qt.Key.Key_Delete:
            self._reset(row)
        else:
            super().keyPressEvent(event)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Wrap the refusals to the new width."""
        super().resizeEvent(event)
        if event.size().width() != event.oldSize().width():
            self.scheduleDelayedItemsLayout()

    def changeEvent(self, event: QEvent) -> None:
        """Follow the theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.refresh()


class _Delegate(QStyledItemDelegate):
    """Frames the values, and opens the editor that fits each."""

    def __init__(self, draft: Draft, view: ParameterTree) -> None:
        super().__init__(view)
        self._draft = draft
        self._view = view

    def sizeHint(self, option: QStyleOptionViewItem, index: _Index) -> QSize:
        """Return a comfortable height; a refusal's with its lines."""
        refused = index.parent().data(_DOTTED_NAME)
        if not refused:
            return super().sizeHint(option, index) + QSize(0, GRID_PX)
        indent = (refused.count(".") + 2) * self._view.indentation()
        width = self._view.viewport().width() - indent - GRID_PX
        box = option.fontMetrics.boundingRect(0, 0, width, 0, Qt.TextFlag.TextWordWrap, str(index.data()))
        return QSize(width, box.height() + GRID_PX // 2)

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: _Index) -> None:
        """Paint a value in a frame, anything else as Qt does."""
        if index.column() == VALUE and index.data(_DOTTED_NAME):
            theme = theme_of(self._view)
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            is_current = self._view.hasFocus() and index == self._view.currentIndex().siblingAtColumn(VALUE)
            painter.setPen(theme.color("accent" if is_current else "line"))
            painter.setBrush(theme.color("window"))
            painter.drawRoundedRect(QRectF(option.rect).adjusted(0.5, 2.5, -0.5, -2.5), 3, 3)
        super().paint(painter, option, index)

    def createEditor(self, parent: QWidget, _option: QStyleOptionViewItem, index: _Index) -> QWidget:
        """Return the editor that fits the value."""
        name = index.data(_DOTTED_NAME)
        editor = self._make_editor(name, parent)
        editor.setAccessibleName(self._view.title(name))
        if isinstance(editor, ChoiceInput):
            editor.activated.connect(lambda: self._finish(editor))
        return editor

    def _make_editor(self, name: str, parent: QWidget) -> ChoiceInput | NumberInput | PointInput:
        (kind, is_optional), value = self._draft.kinds[name], self._draft.value(name)
        display = self._draft.displays[name]
        if kind == "choice":
            return ChoiceInput(display, value, parent)
        if kind == "point":
            return PointInput(display, value, parent)
        return NumberInput(display, value, parent, is_integer=kind == "integer", is_optional=is_optional)

    def _finish(self, editor: QWidget) -> None:
        self.commitData.emit(editor)
        self.closeEditor.emit(editor)

    def setEditorData(self, _editor: QWidget, _index: _Index) -> None:
        """The editors are made with their values; a change from outside does not touch what is typed."""

    def setModelData(self, editor: QWidget, _model: QAbstractItemModel, index: _Index) -> None:
        """Hand on what was entered, if anything."""
        name = index.data(_DOTTED_NAME)
        assert isinstance(editor, (ChoiceInput, NumberInput, PointInput))
        has_changed, value = editor.data()
        if has_changed:
            self._view.value_entered.emit(name, value)

    def updateEditorGeometry(self, editor: QWidget, option: QStyleOptionViewItem, _index: _Index) -> None:
        """Cover the value."""
        editor.setGeometry(option.rect)
