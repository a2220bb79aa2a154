"""A strip of captioned pictures that fills as they arrive, and shows all of them at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from PySide6.QtCore import (
    QModelIndex,
    QPersistentModelIndex,
    QRect,
    QRectF,
    QSize,
    Qt,
    Signal,
)
from PySide6.QtGui import (
    QFontMetricsF,
    QPainter,
    QPen,
    QPixmap,
    QResizeEvent,
)
from PySide6.QtWidgets import (
    QListView,
    QSizePolicy,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QWidget,
)

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import draw_elided, make_bare, smaller
from app.gui.views.picture_dialog import Picture, PictureDialog
from app.gui.views.picture_loader import PictureModel, PictureRow

_Index = QModelIndex | QPersistentModelIndex
_MOST_ROWS = 2
_LEAST_CELL_PX = 48
"""Narrower, a caption of two digits and its picture are no longer made out."""


class _Delegate(QStyledItemDelegate):
    """A picture, `height_px` high, with its caption under it, or a box with its state."""

    def __init__(self, height_px: int, parent: QWidget) -> None:
        super().__init__(parent)
        self.height_px = height_px
        self._view = parent

    def sizeHint(self, _option: QStyleOptionViewItem, _index: _Index) -> QSize:
        return cell_size(self._view, self.height_px)

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: _Index) -> None:
        rect: QRect = option.rect
        state: QStyle.StateFlag = option.state
        theme = theme_of(self._view)
        painter.save()
        painter.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.SmoothPixmapTransform)
        box = QRectF(rect).adjusted(3, 3, -3, -3)
        frame = QRectF(box.left(), box.top(), box.width(), self.height_px)
        pixmap = index.data(Qt.ItemDataRole.DecorationRole)
        if isinstance(pixmap, QPixmap) and not pixmap.isNull():
            painter.fillRect(frame, theme.color("scene"))
            size = pixmap.size().scaled(frame.size().toSize(), Qt.AspectRatioMode.KeepAspectRatio)
            shown = QRectF(0, 0, size.width(), size.height())
            shown.moveCenter(frame.center())
            painter.drawPixmap(shown, pixmap, QRectF(pixmap.rect()))
        else:
            self._paint_placeholder(painter, frame, bool(index.data(Qt.ItemDataRole.UserRole)), pixmap)
        if state & QStyle.StateFlag.State_Selected:
            painter.setPen(QPen(theme.color("accent"), 3))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(frame)
        painter.setFont(smaller(self._view.font()))
        painter.setPen(theme.color("text" if pixmap is not None else "muted"))
        caption = QRectF(box.left(), frame.bottom() + 3, box.width(), box.bottom() - frame.bottom())
        draw_elided(painter, caption, str(index.data()), Qt.AlignmentFlag.AlignHCenter)
        painter.restore()

    def _paint_placeholder(self, painter: QPainter, frame: QRectF, is_pending: bool, pixmap: Any) -> None:
        theme = theme_of(self._view)
        painter.setPen(QPen(theme.color("line"), 1.5, Qt.PenStyle.DashLine))
        painter.setBrush(theme.color("surface"))
        painter.drawRoundedRect(frame.adjusted(1, 1, -1, -1), 4, 4)
        if pixmap is not None:
            text = self.tr("cannot be read")
        elif is_pending:
            text = self.tr("pending")
        else:
            text = self.tr("loading")
        painter.setFont(smaller(self._view.font()))
        painter.setPen(theme.color("muted"))
        painter.drawText(frame, Qt.AlignmentFlag.AlignCenter, text)


def _row(picture: Picture) -> PictureRow:
    row = PictureRow(picture.caption, picture.path or picture.caption, picture.path)
    row.setToolTip(picture.caption)
    row.setData(picture.path is None, Qt.ItemDataRole.UserRole)
    return row


def cell_size(view: QWidget, height_px: int) -> QSize:
    """Return the size of a picture of 4:3 with a line of caption and its margins."""
    line = QFontMetricsF(smaller(view.font())).height()
    return QSize(round(height_px * 4 / 3) + 6, round(height_px + line) + 10)


def fitting_rows(view: QWidget, n: int, room: QSize, most_px: int) -> tuple[int, int] | None:
    """Return in how many rows, and how high, `n` pictures are largest in a room; none: they do not fit."""
    around, best = cell_size(view, 0), (0, 0)
    for rows in range(1, _MOST_ROWS + 1):
        columns = -(-n // rows)
        wide_px = (room.width() // columns - around.width()) * 3 // 4
        height_px = min(wide_px, room.height() // rows - around.height(), most_px)
        if height_px > best[1] and cell_size(view, height_px).width() >= _LEAST_CELL_PX:
            best = rows, height_px
    return best if best[0] else None


class FilmStrip(QWidget):
    """A strip of pictures; a click or Enter opens one large.

    Many lie in smaller cells or two rows; where even that does not show all, it scrolls.

    Attributes:
        activated: the index of the picture that was opened.
    """

    activated = Signal(int)

    def __init__(self, height_px: int = 96, parent: QWidget | None = None) -> None:
        """Make one whose pictures are `height_px` high, captions below."""
        super().__init__(parent)
        self.setObjectName("film_strip")
        self._height_px = height_px
        self._pictures: tuple[Picture, ...] = ()
        # at twice the shown size, for sharp screens
        self._model = PictureModel(QSize(4 * height_px, 2 * height_px), self)
        self._view = QListView(self)
        self._view.setObjectName("film_strip_view")
        self._view.setAccessibleName(self.tr("Pictures"))
        self._view.setFlow(QListView.Flow.LeftToRight)
        self._view.setResizeMode(QListView.ResizeMode.Adjust)
        self._view.setUniformItemSizes(True)
        make_bare(self._view)
        self._view.setEditTriggers(QListView.EditTrigger.NoEditTriggers)
        self._view.setHorizontalScrollMode(QListView.ScrollMode.ScrollPerPixel)
        self._view.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._view.setModel(self._model)
        self._delegate = _Delegate(height_px, self._view)
        self._view.setItemDelegate(self._delegate)
        self._view.clicked.connect(self._open)
        self._view.activated.connect(self._open)
        policy = QSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        policy.setHeightForWidth(True)
        self.setSizePolicy(policy)
        self._dialog: PictureDialog | None = None

    def _fitting(self, width_px: int) -> tuple[int, int] | None:
        # one pixel less: the list wraps what fits exactly
        room = QSize(width_px - 1, cell_size(self, self._height_px).height())
        return fitting_rows(self, max(len(self._pictures), 1), room, self._height_px)

    def heightForWidth(self, width: int) -> int:
        """Return the height of the rows that show all pictures in a width, or of one with its scroll bar."""
        rows, height_px = self._fitting(width) or (1, self._height_px + self._bar_px())
        return rows * cell_size(self, height_px).height() + GRID_PX

    def sizeHint(self) -> QSize:
        """Return the size of one row of pictures as large as they are meant to be."""
        cell = cell_size(self, self._height_px)
        return QSize(max(len(self._pictures), 1) * cell.width() + 1, cell.height() + GRID_PX)

    def _bar_px(self) -> int:
        return self._view.style().pixelMetric(QStyle.PixelMetric.PM_ScrollBarExtent)

    def _arrange(self) -> None:
        """Find the largest cells with which all are seen; where none are, scroll along one row."""
        found = self._fitting(self.width())
        self._delegate.height_px = self._height_px if found is None else found[1]
        # with "as needed" the list would leave the bar's height free even where all fit
        on, off = Qt.ScrollBarPolicy.ScrollBarAlwaysOn, Qt.ScrollBarPolicy.ScrollBarAlwaysOff
        self._view.setHorizontalScrollBarPolicy(on if found is None else off)
        self._view.setWrapping(found is not None)
        self._view.setGridSize(cell_size(self, self._delegate.height_px))

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Find the cells that fit."""
        super().resizeEvent(event)
        self._view.setGeometry(self.rect())  # no layout: Qt would ask that for the height
        self._arrange()

    @property
    def pictures(self) -> tuple[Picture, ...]:
        """What is shown, in its order."""
        return self._pictures

    def set_pictures(self, pictures: Sequence[Picture], expected: Sequence[str] = ()) -> None:
        """Show pictures, and a box for each caption in `expected` that has none yet.

        The captions in `expected` also give the order; pictures with other captions come after them.
        """
        by_caption = {picture.caption: picture for picture in pictures}
        awaited = [by_caption.get(caption, Picture(caption)) for caption in expected]
        known = set(expected)
        shown = (*awaited, *(picture for picture in pictures if picture.caption not in known))
        if shown == self._pictures:
            return
        place = self._view.horizontalScrollBar().value()
        current = self._view.currentIndex().row()
        self._pictures = shown
        self._model.set_rows([_row(picture) for picture in shown])
        self.updateGeometry()
        self._arrange()
        self._view.setCurrentIndex(self._model.index(current, 0))
        self._view.horizontalScrollBar().setValue(place)

    def _open(self, index: QModelIndex) -> None:
        picture = self._pictures[index.row()]
        if picture.path is None or (self._dialog is not None and self._dialog.isVisible()):
            return
        self.activated.emit(index.row())
        self._dialog = PictureDialog(self._pictures, index.row(), self)
        self._dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._dialog.destroyed.connect(self._forget_dialog)
        self._dialog.index_changed.connect(self._select)
        self._dialog.open()

    def _forget_dialog(self) -> None:
        self._dialog = None

    def _select(self, row: int) -> None:
        self._view.setCurrentIndex(self._model.index(row, 0))
