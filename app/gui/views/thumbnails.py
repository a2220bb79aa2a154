"""The views of a scan as a grid of small pictures with their states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from PySide6.QtCore import (
    QItemSelection,
    QItemSelectionModel,
    QModelIndex,
    QPersistentModelIndex,
    QPointF,
    QRect,
    QRectF,
    QSignalBlocker,
    QSize,
    Qt,
    Signal,
)
from PySide6.QtGui import (
    QColor,
    QFont,
    QFontMetricsF,
    QImage,
    QPainter,
    QPainterPath,
    QPen,
    QPixmap,
    QPolygonF,
    QResizeEvent,
)
from PySide6.QtWidgets import (
    QListView,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QVBoxLayout,
    QWidget,
)

from app.gui.theme import Theme, theme_of
from app.gui.views.painting import make_bare, tabular
from app.gui.views.picture_loader import PictureModel, PictureRow

ThumbnailState = Literal["pending", "taken", "poor", "failed"]
_PICTURE = QSize(240, 180)
"""Pictures are cached at this size: sharp at any size the grid shows."""
_LEAST_PX = QSize(58, 58)
_MOST_PX = 150
_Index = QModelIndex | QPersistentModelIndex
_COLORS = {"pending": "muted", "taken": "good", "poor": "attention", "failed": "failed"}
_MARK_PX = 9.0
_GAP_PX = 1.5


@dataclass(frozen=True)
class Thumbnail:
    """One view.

    Attributes:
        name: unique and stable, such as "view-07".
        label: shown in its corner, such as "7".
        state: pending, taken, poor or failed.
        picture: its file or the picture itself; None while there is none.
        tooltip: all there is to know of it.
    """

    name: str
    label: str
    state: ThumbnailState
    picture: Path | QImage | None = None
    tooltip: str = ""


class _Delegate(QStyledItemDelegate):
    """Paints picture, label and state, the state as a shape and a word; `size` is set by the grid."""

    def __init__(self, view: QWidget) -> None:
        super().__init__(view)
        self._view = view
        self.size = QSize(64, 64)

    def cell_size(self, width_px: int) -> QSize:
        """Return the size of a cell of a width: a 4:3 picture and a line for the state."""
        return QSize(width_px, round((width_px - 4) * 3 / 4 + self._line_px() + 6))

    def _font(self) -> QFont:
        return tabular(self._view.font(), 8.0)

    def _line_px(self) -> float:
        return QFontMetricsF(self._font()).height()

    def sizeHint(self, _option: QStyleOptionViewItem, _index: _Index) -> QSize:
        """Return the grid's cell."""
        return self.size

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: _Index) -> None:
        """Paint one view."""
        rect: QRect = option.rect
        state: QStyle.StateFlag = option.state
        theme = theme_of(self._view)
        painter.save()
        painter.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.SmoothPixmapTransform)
        box = QRectF(rect).adjusted(2, 2, -2, -2)
        line = self._line_px()
        frame = QRectF(box.left(), box.top(), box.width(), box.height() - line - _GAP_PX)
        self._paint_picture(painter, frame, index.data(Qt.ItemDataRole.DecorationRole))
        painter.setFont(self._font())
        self._paint_label(painter, frame, str(index.data()))
        view_state = str(index.data(Qt.ItemDataRole.UserRole))
        self._paint_state(painter, QRectF(box.left(), box.bottom() - line, box.width(), line), view_state)
        if state & QStyle.StateFlag.State_Selected:
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.setPen(QPen(theme.color("accent"), 3))
            painter.drawRoundedRect(QRectF(rect).adjusted(1.5, 1.5, -1.5, -1.5), 4, 4)
        painter.restore()

    def _paint_picture(self, painter: QPainter, frame: QRectF, pixmap: Any) -> None:
        theme = theme_of(self._view)
        if isinstance(pixmap, QPixmap) and not pixmap.isNull():
            size = pixmap.size().scaled(frame.size().toSize(), Qt.AspectRatioMode.KeepAspectRatioByExpanding)
            shown = QRectF(0, 0, size.width(), size.height())
            shown.moveCenter(frame.center())
            painter.save()
            painter.setClipRect(frame)
            painter.drawPixmap(shown, pixmap, QRectF(pixmap.rect()))
            painter.restore()
        else:
            painter.setPen(QPen(theme.color("line"), 1, Qt.PenStyle.DashLine))
            painter.setBrush(theme.color("surface"))
            painter.drawRoundedRect(frame.adjusted(0.5, 0.5, -0.5, -0.5), 3, 3)

    def _paint_label(self, painter: QPainter, frame: QRectF, label: str) -> None:
        theme = theme_of(self._view)
        metrics = QFontMetricsF(painter.font())
        plate = QRectF(frame.left(), frame.top(), metrics.horizontalAdvance(label) + 6, metrics.height())
        path = QPainterPath()
        path.addRoundedRect(plate, 3, 3)
        back = QColor(theme.color("window"))
        back.setAlphaF(0.8)
        painter.fillPath(path, back)
        painter.setPen(theme.color("text"))
        painter.drawText(plate, Qt.AlignmentFlag.AlignCenter, label)

    def _paint_state(self, painter: QPainter, box: QRectF, state: str) -> None:
        theme = theme_of(self._view)
        words = {
            "pending": self.tr("pending"),
            "taken": self.tr("taken"),
            "poor": self.tr("poor"),
            "failed": self.tr("failed"),
        }
        word = words[state]
        width = _MARK_PX + _GAP_PX + QFontMetricsF(painter.font()).horizontalAdvance(word)
        left = max(box.center().x() - width / 2, box.left())
        mark = QRectF(left, box.center().y() - _MARK_PX / 2, _MARK_PX, _MARK_PX)
        paint_view_mark(painter, mark, state, theme)
        painter.setPen(theme.color("text" if state != "pending" else "muted"))
        beside = QRectF(mark.right() + _GAP_PX, box.top(), box.right() - mark.right() - 2, box.height())
        painter.drawText(beside, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft, word)


def paint_view_mark(painter: QPainter, box: QRectF, state: str, theme: Theme) -> None:
    """Paint a view's state: a hollow ring, a full disc, a triangle, a cross."""
    color = theme.color(_COLORS[state])
    side = min(box.width(), box.height()) * 0.8
    center = box.center()
    half = side / 2
    painter.save()
    painter.setPen(QPen(color, 1.8, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
    if state == "taken":
        painter.setBrush(color)
    if state in ("pending", "taken"):
        painter.drawEllipse(center, half - 0.9, half - 0.9)
    elif state == "poor":
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(color)
        corners = [QPointF(0, -half), QPointF(half * 1.1, half * 0.8), QPointF(-half * 1.1, half * 0.8)]
        painter.drawPolygon(QPolygonF([center + corner for corner in corners]))
    else:
        for sign in (-1, 1):
            reach = QPointF(half * 0.75, sign * half * 0.75)
            painter.drawLine(center - reach, center + reach)
    painter.restore()


def _row(item: Thumbnail) -> PictureRow:
    row = PictureRow(item.label, item.name, item.picture)
    row.setToolTip(item.tooltip or item.label)
    row.setAccessibleText(f"{item.label}, {item.state}")
    row.setData(item.state, Qt.ItemDataRole.UserRole)
    return row


class ThumbnailGrid(QWidget):
    """Views as small pictures, as many in a row as show all of them at once where that is possible.

    Attributes:
        selected: the index the user picked; not sent by `select`.
        activated: the index the user double-clicked or entered.
    """

    selected = Signal(int)
    activated = Signal(int)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("thumbnail_grid")
        self._items: list[Thumbnail] = []
        self._model = PictureModel(_PICTURE, self)
        self._view = QListView(self)
        self._view.setObjectName("thumbnail_view")
        self._view.setAccessibleName(self.tr("Views of the scan"))
        self._view.setViewMode(QListView.ViewMode.IconMode)
        self._view.setMovement(QListView.Movement.Static)
        self._view.setResizeMode(QListView.ResizeMode.Adjust)
        self._view.setUniformItemSizes(True)
        self._view.setEditTriggers(QListView.EditTrigger.NoEditTriggers)
        make_bare(self._view)
        self._view.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._view.setVerticalScrollMode(QListView.ScrollMode.ScrollPerPixel)
        self._view.setModel(self._model)
        self._delegate = _Delegate(self._view)
        self._view.setItemDelegate(self._delegate)
        # not currentChanged: a list that gets the focus calls its first entry the current one
        self._view.selectionModel().selectionChanged.connect(self._emit_selected)
        self._view.activated.connect(lambda index: self.activated.emit(index.row()))
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self._view)

    @property
    def items(self) -> tuple[Thumbnail, ...]:
        """What is shown, in its order."""
        return tuple(self._items)

    @property
    def selection(self) -> int | None:
        """The selected index."""
        index = self._view.currentIndex()
        return index.row() if index.isValid() else None

    def set_items(self, items: Sequence[Thumbnail]) -> None:
        """Show these views; the selection stays with the view of the same name."""
        current = self.selection
        name = self._items[current].name if current is not None else None
        self._items = list(items)
        with QSignalBlocker(self._view.selectionModel()):
            self._model.set_rows([_row(item) for item in items])
        row = next((k for k, item in enumerate(items) if item.name == name), None)
        self.select(row)
        self._arrange()

    def set_item(self, index: int, item: Thumbnail) -> None:
        """Show another state or picture of one view."""
        self._items[index] = item
        self._model.set_row(index, _row(item))

    def select(self, index: int | None) -> None:
        """Select a view or none, without a signal."""
        selection = self._view.selectionModel()
        with QSignalBlocker(selection):
            if index is None:
                selection.clear()
            else:
                selection.setCurrentIndex(
                    self._model.index(index, 0), QItemSelectionModel.SelectionFlag.ClearAndSelect
                )
        self._view.viewport().update()

    def _emit_selected(self, selected: QItemSelection, _deselected: QItemSelection) -> None:
        for index in selected.indexes():
            self.selected.emit(index.row())

    def _arrange(self) -> None:
        """Find the largest cell with which all fit; where none does, scroll with the smallest."""
        bar = self._view.verticalScrollBar().sizeHint().width()
        width, height = self.width(), self.height()
        n = max(len(self._items), 1)
        best = QSize()
        for columns in range(1, n + 1):
            side = min((width - 2) // columns, _MOST_PX)  # the list wraps what fits exactly
            size = self._delegate.cell_size(side)
            rows = -(-n // columns)
            if side >= _LEAST_PX.width() and rows * size.height() <= height and side > best.width():
                best = size
        scrolls = not best.isValid()
        if scrolls:
            columns = max((width - bar) // _LEAST_PX.width(), 1)
            best = self._delegate.cell_size(min((width - bar) // columns, _MOST_PX))
        # with "as needed" the list would leave the bar's width free even where all fit
        on, off = Qt.ScrollBarPolicy.ScrollBarAlwaysOn, Qt.ScrollBarPolicy.ScrollBarAlwaysOff
        self._view.setVerticalScrollBarPolicy(on if scrolls else off)
        self._delegate.size = best
        self._view.setGridSize(best)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Find the cells that fit."""
        super().resizeEvent(event)
        self._arrange()

    def sizeHint(self) -> QSize:
        """Return a good size."""
        return QSize(380, 264)

    def minimumSizeHint(self) -> QSize:
        """Return the least size it can be read at."""
        return QSize(2 * _LEAST_PX.width(), 2 * _LEAST_PX.height())
