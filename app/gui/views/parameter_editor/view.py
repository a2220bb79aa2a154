"""The tree the parameters stand in."""

from __future__ import annotations

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QKeyEvent, QPainter, QResizeEvent
from PySide6.QtWidgets import QHeaderView, QStyleOptionViewItem, QTreeView, QWidget

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import smaller
from app.gui.views.parameter_editor.delegate import ParameterDelegate
from app.gui.views.parameter_editor.model import ROW_ROLE, VALUE_COLUMN, Index, ParameterFilter, RowFacts
from app.gui.views.state_mark import paint_mark

_VALUE_PX = 152
_INDENT_PX = 12


class ParameterView(QTreeView):
    """Rows with their refusals written under them; Enter, F2 or Space edit, Delete resets."""

    def __init__(self, model: ParameterFilter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._parameters = model
        self.setObjectName("parameter_view")
        self.setAccessibleName(self.tr("Parameters"))
        self.parameter_delegate = ParameterDelegate(self)
        self.setItemDelegate(self.parameter_delegate)
        self.setHeaderHidden(True)
        self.setIndentation(_INDENT_PX)
        self.setFrameShape(QTreeView.Shape.NoFrame)
        self.setSelectionMode(QTreeView.SelectionMode.NoSelection)
        self.setEditTriggers(QTreeView.EditTrigger.NoEditTriggers)
        self.setVerticalScrollMode(QTreeView.ScrollMode.ScrollPerPixel)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setExpandsOnDoubleClick(False)
        # queued, and by name: the click is done with, and rows may have gone, when the editor opens
        self.parameter_delegate.edit_wanted.connect(self._edit, Qt.ConnectionType.QueuedConnection)
        self.setModel(model)
        self.expandAll()
        self._fit_columns()

    def _fit_columns(self) -> None:
        """Give the value its width and the name the rest."""
        header = self.header()
        header.setStretchLastSection(False)
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        header.setSectionResizeMode(VALUE_COLUMN, QHeaderView.ResizeMode.Fixed)
        header.resizeSection(VALUE_COLUMN, _VALUE_PX)

    def _edit(self, name: str) -> None:
        index = self._parameters.index_of(name)
        is_shown = index.isValid() and not self.visualRect(index).isEmpty()
        if is_shown and self.state() != QTreeView.State.EditingState:
            self.edit(index)

    def drawRow(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        """Draw a row, its refusal under it, and a bar beside it when keys would act on it."""
        super().drawRow(painter, option, index)
        facts = index.data(ROW_ROLE)
        theme = theme_of(self)
        row = QRectF(option.rect)
        if self.hasFocus() and index.sibling(index.row(), 0) == self.currentIndex().siblingAtColumn(0):
            painter.fillRect(QRectF(row.left(), row.top() + 2, 3, row.height() - 4), theme.color("accent"))
        if isinstance(facts, RowFacts) and facts.error:
            cell = self.visualRect(index.sibling(index.row(), 0))
            width = self.viewport().width() - cell.left() - GRID_PX
            height = self.parameter_delegate.layout_of(facts, cell).error_height(width)
            box = QRectF(cell.left(), row.bottom() - height, width, height)
            painter.save()
            paint_mark(painter, QRectF(box.left(), box.top() + 1, 14, 14), "failed", theme)
            painter.setFont(smaller(self.font()))
            painter.setPen(theme.color("failed"))
            text = box.adjusted(2.5 * GRID_PX, 0, 0, 0)
            painter.drawText(text, int(Qt.TextFlag.TextWordWrap), facts.error)
            painter.restore()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Edit or reset the current row."""
        if self.state() == QTreeView.State.EditingState:
            return  # an editor hands on the Return that closes it
        index = self.currentIndex().siblingAtColumn(VALUE_COLUMN)
        facts = index.data(ROW_ROLE)
        if isinstance(facts, RowFacts):
            if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_F2, Qt.Key.Key_Space):
                self.setCurrentIndex(index)
                self.parameter_delegate.begin(index)
                return
            if event.key() == Qt.Key.Key_Delete and facts.differs:
                self.parameter_delegate.value_entered.emit(facts.name, facts.preset_value)
                return
        super().keyPressEvent(event)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Wrap the refusals anew."""
        super().resizeEvent(event)
        if event.size().width() != event.oldSize().width():
            self.scheduleDelayedItemsLayout()
