"""A strip of captioned pictures that fills as they arrive."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from PySide6.QtCore import (
    QAbstractListModel,
    QEvent,
    QModelIndex,
    QObject,
    QPersistentModelIndex,
    QRect,
    QRectF,
    QSize,
    Qt,
    Signal,
)
from PySide6.QtGui import QFontMetricsF, QImage, QPainter, QPen, QPixmap
from PySide6.QtWidgets import (
    QListView,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QVBoxLayout,
    QWidget,
)

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import draw_elided, make_bare, smaller
from app.gui.views.picture_dialog import Picture, PictureDialog
from app.gui.views.picture_loader import PictureLoader

__all__ = ["FilmStrip", "Picture", "PictureDialog"]

_Index = QModelIndex | QPersistentModelIndex


class _Pictures(QAbstractListModel):
    """The pictures and what is loaded of them, at twice the shown size for sharp screens."""

    def __init__(self, height_px: int, parent: QObject) -> None:
        super().__init__(parent)
        self.pictures: tuple[Picture, ...] = ()
        self._height_px = height_px
        self._pixmaps: dict[object, QPixmap] = {}
        self._loader = PictureLoader(self)
        self._loader.loaded.connect(self._arrive)

    def reset(self, pictures: Sequence[Picture]) -> None:
        """Show other pictures; what is loaded already stays."""
        self.beginResetModel()
        self.pictures = tuple(pictures)
        paths = {picture.path for picture in pictures}
        self._pixmaps = {path: pixmap for path, pixmap in self._pixmaps.items() if path in paths}
        self.endResetModel()
        for picture in pictures:
            if picture.path is not None and picture.path not in self._pixmaps:
                side = 2 * self._height_px
                self._loader.request(picture.path, picture.path, QSize(2 * side, side))

    def _arrive(self, path: object, image: QImage) -> None:
        self._pixmaps[path] = QPixmap.fromImage(image)
        for row, picture in enumerate(self.pictures):
            if picture.path == path:
                self.dataChanged.emit(self.index(row), self.index(row))

    def rowCount(self, parent: _Index | None = None) -> int:
        return 0 if parent is not None and parent.isValid() else len(self.pictures)

    def data(self, index: _Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        picture = self.pictures[index.row()]
        if role in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.ToolTipRole):
            return picture.caption
        if role == Qt.ItemDataRole.DecorationRole:
            return self._pixmaps.get(picture.path)
        if role == Qt.ItemDataRole.UserRole:
            return picture
        return None


class _Delegate(QStyledItemDelegate):
    """A picture with its caption under it, or a box that says what is awaited."""

    def __init__(self, height_px: int, parent: QWidget) -> None:
        super().__init__(parent)
        self._height_px = height_px
        self._view = parent

    def sizeHint(self, _option: QStyleOptionViewItem, _index: _Index) -> QSize:
        return cell_size(self._view, self._height_px)

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: _Index) -> None:
        rect: QRect = option.rect
        state: QStyle.StateFlag = option.state
        theme = theme_of(self._view)
        painter.save()
        painter.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.SmoothPixmapTransform)
        box = QRectF(rect).adjusted(3, 3, -3, -3)
        frame = QRectF(box.left(), box.top(), box.width(), self._height_px)
        pixmap = index.data(Qt.ItemDataRole.DecorationRole)
        if isinstance(pixmap, QPixmap) and not pixmap.isNull():
            painter.fillRect(frame, theme.color("scene"))
            size = pixmap.size().scaled(frame.size().toSize(), Qt.AspectRatioMode.KeepAspectRatio)
            shown = QRectF(0, 0, size.width(), size.height())
            shown.moveCenter(frame.center())
            painter.drawPixmap(shown, pixmap, QRectF(pixmap.rect()))
        else:
            self._paint_placeholder(painter, frame, index.data(Qt.ItemDataRole.UserRole), pixmap)
        if state & QStyle.StateFlag.State_Selected:
            painter.setPen(QPen(theme.color("accent"), 3))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(frame)
        painter.setFont(smaller(self._view.font()))
        painter.setPen(theme.color("text" if pixmap is not None else "muted"))
        caption = QRectF(box.left(), frame.bottom() + 3, box.width(), box.bottom() - frame.bottom())
        draw_elided(painter, caption, str(index.data()), Qt.AlignmentFlag.AlignHCenter)
        painter.restore()

    def _paint_placeholder(self, painter: QPainter, frame: QRectF, picture: Picture, pixmap: Any) -> None:
        theme = theme_of(self._view)
        painter.setPen(QPen(theme.color("line"), 1.5, Qt.PenStyle.DashLine))
        painter.setBrush(theme.color("surface"))
        painter.drawRoundedRect(frame.adjusted(1, 1, -1, -1), 4, 4)
        if pixmap is not None:
            text = self.tr("cannot be read")
        elif picture.path is None:
            text = self.tr("awaited")
        else:
            text = self.tr("loading")
        painter.setFont(smaller(self._view.font()))
        painter.setPen(theme.color("muted"))
        painter.drawText(frame, Qt.AlignmentFlag.AlignCenter, text)


def cell_size(view: QWidget, height_px: int) -> QSize:
    """Return the size of a picture of 4:3 with a line of caption and its margins."""
    line = QFontMetricsF(smaller(view.font())).height()
    return QSize(round(height_px * 4 / 3) + 6, round(height_px + line) + 10)


class FilmStrip(QWidget):
    """A horizontal strip of pictures; a click or Enter opens one large.

    Attributes:
        activated: the index of the picture that was opened.
    """

    activated = Signal(int)

    def __init__(self, height_px: int = 96, parent: QWidget | None = None) -> None:
        """Make one whose pictures are `height_px` high, captions below."""
        super().__init__(parent)
        self.setObjectName("film_strip")
        self._height_px = height_px
        self._model = _Pictures(height_px, self)
        self._view = QListView(self)
        self._view.setObjectName("film_strip_view")
        self._view.setAccessibleName(self.tr("Pictures"))
        self._view.setFlow(QListView.Flow.LeftToRight)
        self._view.setWrapping(False)
        self._view.setUniformItemSizes(True)
        self._view.setSpacing(2)
        make_bare(self._view)
        self._view.setEditTriggers(QListView.EditTrigger.NoEditTriggers)
        self._view.setHorizontalScrollMode(QListView.ScrollMode.ScrollPerPixel)
        self._view.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._view.setModel(self._model)
        self._view.setItemDelegate(_Delegate(height_px, self._view))
        self._view.clicked.connect(self._open)
        self._view.activated.connect(self._open)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self._view)
        self._fit_height()
        self._dialog: PictureDialog | None = None

    def _fit_height(self) -> None:
        bar = self._view.style().pixelMetric(QStyle.PixelMetric.PM_ScrollBarExtent)
        self.setFixedHeight(cell_size(self._view, self._height_px).height() + bar + GRID_PX)

    @property
    def pictures(self) -> tuple[Picture, ...]:
        """What is shown, in its order."""
        return self._model.pictures

    def set_pictures(self, pictures: Sequence[Picture], expected: Sequence[str] = ()) -> None:
        """Show pictures, and a box for each caption in `expected` that has none yet.

        The captions in `expected` also give the order; pictures with other captions come after them.
        """
        by_caption = {picture.caption: picture for picture in pictures}
        awaited = [by_caption.get(caption, Picture(caption)) for caption in expected]
        known = set(expected)
        shown = (*awaited, *(picture for picture in pictures if picture.caption not in known))
        if shown == self._model.pictures:
            return
        place = self._view.horizontalScrollBar().value()
        current = self._view.currentIndex().row()
        self._model.reset(shown)
        self._view.setCurrentIndex(self._model.index(current))
        self._view.horizontalScrollBar().setValue(place)

    def _open(self, index: QModelIndex) -> None:
        picture = self._model.pictures[index.row()]
        if picture.path is None or (self._dialog is not None and self._dialog.isVisible()):
            return
        self.activated.emit(index.row())
        self._dialog = PictureDialog(self._model.pictures, index.row(), self)
        self._dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._dialog.destroyed.connect(self._forget_dialog)
        self._dialog.index_changed.connect(self._select)
        self._dialog.open()

    def _forget_dialog(self) -> None:
        self._dialog = None

    def _select(self, row: int) -> None:
        self._view.setCurrentIndex(self._model.index(row))

    def changeEvent(self, event: QEvent) -> None:
        """Repaint in another theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._view.viewport().update()
