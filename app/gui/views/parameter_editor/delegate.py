"""How a parameter's row is painted, clicked and edited."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QAbstractItemModel, QEvent, QPointF, QRect, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QFontMetricsF, QMouseEvent, QPainter, QPen
from PySide6.QtWidgets import QStyledItemDelegate, QStyleOptionViewItem, QTreeView, QWidget

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import draw_elided, smaller, tabular
from app.gui.views.parameter_editor.inputs import ChoiceInput, NumberInput, PointInput
from app.gui.views.parameter_editor.model import NAME_COLUMN, ROW_ROLE, Index, RowFacts
from app.gui.views.parameter_editor.row_layout import RowLayout

_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter


class ParameterDelegate(QStyledItemDelegate):
    """Paints names and values, opens editors, and takes the clicks on what it paints.

    Attributes:
        value_entered: (dotted name, value) to set.
        edit_wanted: the dotted name whose value was clicked.
    """

    value_entered = Signal(str, object)
    edit_wanted = Signal(str)

    def __init__(self, view: QTreeView) -> None:
        super().__init__(view)
        self._view = view

    def layout_of(self, facts: RowFacts, cell: QRect) -> RowLayout:
        """Return where the parts of a row lie in one of its cells."""
        return RowLayout(facts, QRectF(cell), self._view.font(), self.tr("Reset"))

    def _preset_text(self, facts: RowFacts) -> str:
        return self.tr("preset: {value}").format(value=facts.display.text(facts.preset_value))

    def sizeHint(self, option: QStyleOptionViewItem, index: Index) -> QSize:
        """Return a line, with a second one where there is more to say, and lines for a refusal."""
        facts = index.data(ROW_ROLE)
        if not isinstance(facts, RowFacts):
            return QSize(0, round(QFontMetricsF(self._view.font()).height()) + GRID_PX)
        rect: QRect = option.rect
        height = self.layout_of(facts, rect).height(self._error_width(index))
        return QSize(0, round(height))

    def _error_width(self, index: Index) -> float:
        depth = 1
        above = index.parent()
        while above.isValid():
            depth += 1
            above = above.parent()
        return self._view.viewport().width() - depth * self._view.indentation() - GRID_PX

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        """Paint one cell."""
        facts = index.data(ROW_ROLE)
        rect: QRect = option.rect
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if isinstance(facts, RowFacts):
            layout = self.layout_of(facts, rect)
            if index.column() == NAME_COLUMN:
                self._paint_name(painter, layout, facts)
            else:
                self._paint_value(painter, layout, facts)
        else:
            painter.setFont(tabular(self._view.font(), bold=True))
            painter.setPen(theme_of(self._view).color("muted"))
            draw_elided(painter, QRectF(rect), str(index.data() or ""), _LEFT)
        painter.restore()

    def _ink(self) -> str:
        return "text" if self._view.isEnabled() else "muted"

    def _paint_name(self, painter: QPainter, layout: RowLayout, facts: RowFacts) -> None:
        theme = theme_of(self._view)
        painter.setFont(tabular(self._view.font(), bold=facts.differs))
        painter.setPen(theme.color(self._ink()))
        draw_elided(painter, layout.first_line, facts.title, _LEFT)
        if facts.differs:
            painter.setFont(smaller(self._view.font()))
            painter.setPen(theme.color("muted"))
            draw_elided(painter, layout.preset, self._preset_text(facts), _LEFT)

    def _paint_value(self, painter: QPainter, layout: RowLayout, facts: RowFacts) -> None:
        theme = theme_of(self._view)
        painter.setPen(QPen(theme.color("line"), 1))
        painter.setBrush(theme.color("window"))
        painter.drawRoundedRect(layout.value, 3, 3)
        inside = layout.value.adjusted(6, 0, -6, 0)
        if facts.kind == "yes_no":
            self._paint_check(painter, layout.check_in(layout.value), bool(facts.value))
            inside.setLeft(layout.check_in(layout.value).right() + 6)
        if facts.kind == "choice":
            painter.setPen(QPen(theme.color("muted"), 1.6))
            tip = QPointF(inside.right() - 4, inside.center().y() + 2)
            painter.drawPolyline([tip + QPointF(-4, -4), tip, tip + QPointF(4, -4)])
            inside.setRight(inside.right() - 14)
        painter.setFont(tabular(self._view.font(), bold=facts.differs))
        painter.setPen(theme.color("muted" if facts.value is None else self._ink()))
        is_word = facts.kind in ("yes_no", "choice")
        draw_elided(painter, inside, facts.display.text(facts.value), _LEFT if is_word else _RIGHT)
        if facts.differs:
            painter.setFont(smaller(self._view.font()))
            painter.setPen(theme.color("accent" if self._view.isEnabled() else "muted"))
            painter.drawText(layout.reset, int(_RIGHT), self.tr("Reset"))
        if facts.is_optional:
            self._paint_check(painter, layout.check_in(layout.automatic), facts.value is None)
            painter.setFont(smaller(self._view.font()))
            painter.setPen(theme.color("muted"))
            beside = layout.automatic.adjusted(layout.automatic.height() + 4, 0, 0, 0)
            draw_elided(painter, beside, self.tr("automatic"), _LEFT)

    def _paint_check(self, painter: QPainter, box: QRectF, is_on: bool) -> None:
        theme = theme_of(self._view)
        name = "accent" if self._view.isEnabled() else "muted"
        painter.setPen(QPen(theme.color(name if is_on else "muted"), 1.4))
        painter.setBrush(theme.color(name if is_on else "surface"))
        painter.drawRoundedRect(box, 2, 2)
        if is_on:
            painter.setPen(QPen(theme.color("on_accent"), 1.8))
            w, h = box.width(), box.height()
            ticks = [QPointF(0.22 * w, 0.52 * h), QPointF(0.43 * w, 0.73 * h), QPointF(0.78 * w, 0.28 * h)]
            painter.drawPolyline([box.topLeft() + point for point in ticks])

    def editorEvent(
        self, event: QEvent, _model: QAbstractItemModel, option: QStyleOptionViewItem, index: Index
    ) -> bool:
        """Take a click on Reset, a tick or a value."""
        facts = index.data(ROW_ROLE)
        if not isinstance(event, QMouseEvent) or not isinstance(facts, RowFacts):
            return False
        if event.type() != QEvent.Type.MouseButtonRelease or event.button() != Qt.MouseButton.LeftButton:
            return False
        rect: QRect = option.rect
        layout = self.layout_of(facts, rect)
        at = event.position()
        if index.column() == NAME_COLUMN:
            return False
        if facts.differs and layout.reset.contains(at):
            self.value_entered.emit(facts.name, facts.preset_value)
        elif facts.is_optional and layout.automatic.contains(at) and facts.value is not None:
            self.value_entered.emit(facts.name, None)
        else:
            self.begin(index)
        return True

    def begin(self, index: Index) -> None:
        """Change a value by click or key: toggle yes or no, open an editor for all others."""
        facts = index.data(ROW_ROLE)
        assert isinstance(facts, RowFacts)
        if facts.kind == "yes_no":
            self.value_entered.emit(facts.name, not facts.value)
        else:
            self.edit_wanted.emit(facts.name)

    def createEditor(self, parent: QWidget, _option: QStyleOptionViewItem, index: Index) -> QWidget:
        """Return the editor that fits the value."""
        facts = index.data(ROW_ROLE)
        assert isinstance(facts, RowFacts)
        if facts.kind == "choice":
            choice = ChoiceInput(facts, parent)
            choice.activated.connect(lambda: self._finish(choice))
            return choice
        return PointInput(facts, parent) if facts.kind == "point" else NumberInput(facts, parent)

    def _finish(self, editor: QWidget) -> None:
        self.commitData.emit(editor)
        self.closeEditor.emit(editor)

    def setEditorData(self, _editor: QWidget, _index: Index) -> None:
        """The editors are made with their values; a change from outside does not touch what is typed."""

    def setModelData(self, editor: QWidget, _model: QAbstractItemModel, index: Index) -> None:
        """Hand on what was entered, if anything."""
        facts = index.data(ROW_ROLE)
        if not isinstance(facts, RowFacts):
            return
        has_changed, value = self._entered(editor)
        if has_changed and (value is not None or facts.is_optional):
            self.value_entered.emit(facts.name, value)

    def _entered(self, editor: QWidget) -> tuple[bool, Any]:
        if isinstance(editor, ChoiceInput):
            return True, editor.currentData()
        if isinstance(editor, (NumberInput, PointInput)):
            return editor.data()
        return False, None

    def updateEditorGeometry(self, editor: QWidget, option: QStyleOptionViewItem, index: Index) -> None:
        """Cover the painted value."""
        facts = index.data(ROW_ROLE)
        rect: QRect = option.rect
        if isinstance(facts, RowFacts):
            editor.setGeometry(self.layout_of(facts, rect).value.toAlignedRect())
