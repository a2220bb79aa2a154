"""A strip of captioned pictures that fills as they arrive."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
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
from PySide6.QtGui import QFontMetricsF, QImage, QKeyEvent, QPainter, QPaintEvent, QPen, QPixmap
from PySide6.QtWidgets import (
    QDialog,
    QHBoxLayout,
    QLabel,
    QListView,
    QPushButton,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QVBoxLayout,
    QWidget,
)

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import draw_elided, make_bare, smaller
from app.gui.views.picture_loader import PictureLoader, PictureModel, PictureRow

_Index = QModelIndex | QPersistentModelIndex


@dataclass(frozen=True)
class Picture:
    """A picture to show.

    Attributes:
        caption: what it shows.
        path: its file; None while it is still expected.
    """

    caption: str
    path: Path | None = None


class _Delegate(QStyledItemDelegate):
    """A picture with its caption under it, or a box with its state."""

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
        self._pictures: tuple[Picture, ...] = ()
        # at twice the shown size, for sharp screens
        self._model = PictureModel(QSize(4 * height_px, 2 * height_px), self)
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


class PictureDialog(QDialog):
    """A large preview with previous and next (arrow keys) through the pictures that are there.

    Attributes:
        index_changed: which picture is shown now.
    """

    index_changed = Signal(int)

    def __init__(self, pictures: Sequence[Picture], index: int, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("picture_dialog")
        self._pictures = tuple(pictures)
        self._index = -1
        self._loader = PictureLoader(self)
        self._loader.loaded.connect(self._show_image)
        self._build()
        self.show_picture(index)

    @property
    def index(self) -> int:
        """Which picture is shown."""
        return self._index

    def _build(self) -> None:
        self._canvas = _Canvas(self)
        self._caption = QLabel(self)
        self._caption.setObjectName("picture_caption")
        self._caption.setWordWrap(True)
        self._previous = self._button(self.tr("Previous"), "picture_previous", -1)
        self._next = self._button(self.tr("Next"), "picture_next", 1)
        close = QPushButton(self.tr("Close"), self)
        close.setObjectName("picture_close")
        close.setAutoDefault(False)
        close.clicked.connect(self.accept)
        row = QHBoxLayout()
        row.setSpacing(GRID_PX)
        row.addWidget(self._caption, 1)
        for button in (self._previous, self._next, close):
            row.addWidget(button)
        column = QVBoxLayout(self)
        column.setContentsMargins(GRID_PX, GRID_PX, GRID_PX, GRID_PX)
        column.setSpacing(GRID_PX)
        column.addWidget(self._canvas, 1)
        column.addLayout(row)
        self.resize(880, 680)

    def _button(self, text: str, name: str, step: int) -> QPushButton:
        button = QPushButton(text, self)
        button.setObjectName(name)
        button.setAutoDefault(False)
        button.clicked.connect(lambda: self._step(step))
        return button

    def show_picture(self, index: int) -> None:
        """Show one picture."""
        self._index = index
        picture = self._pictures[index]
        place = self.tr("{k} of {n}").format(k=index + 1, n=len(self._pictures))
        self._caption.setText(f"{picture.caption}   ({place})")
        self.setWindowTitle(picture.caption)
        self._previous.setEnabled(self._neighbour(-1) is not None)
        self._next.setEnabled(self._neighbour(1) is not None)
        if picture.path is None:
            self._canvas.show_text(self.tr("This picture does not exist yet."))
        else:
            self._loader.request("large", picture.path)
        self.index_changed.emit(index)

    def _neighbour(self, step: int) -> int | None:
        """The nearest picture in that direction that exists."""
        index = self._index + step
        while 0 <= index < len(self._pictures):
            if self._pictures[index].path is not None:
                return index
            index += step
        return None

    def _step(self, step: int) -> None:
        found = self._neighbour(step)
        if found is not None:
            self.show_picture(found)

    def _show_image(self, _key: object, image: QImage) -> None:
        if image.isNull():
            path = self._pictures[self._index].path
            self._canvas.show_text(self.tr("The picture cannot be read: {path}").format(path=path))
        else:
            self._canvas.show_image(image)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Previous and next by arrow keys."""
        if event.key() == Qt.Key.Key_Left:
            self._step(-1)
        elif event.key() == Qt.Key.Key_Right:
            self._step(1)
        else:
            super().keyPressEvent(event)


class _Canvas(QWidget):
    """A picture as large as the widget allows, or a sentence instead."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("picture_canvas")
        self._pixmap = QPixmap()
        self._text = ""

    def show_image(self, image: QImage) -> None:
        self._pixmap = QPixmap.fromImage(image)
        self.update()

    def show_text(self, text: str) -> None:
        self._pixmap = QPixmap()
        self._text = text
        self.update()

    def sizeHint(self) -> QSize:
        return QSize(800, 600)

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        theme = theme_of(self)
        painter.fillRect(self.rect(), theme.color("scene"))
        if self._pixmap.isNull():
            painter.setPen(theme.color("muted"))
            painter.drawText(self.rect(), int(Qt.AlignmentFlag.AlignCenter), self._text)
        else:
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
            size = self._pixmap.size().scaled(self.size(), Qt.AspectRatioMode.KeepAspectRatio)
            box = QRectF(0, 0, size.width(), size.height())
            box.moveCenter(QRectF(self.rect()).center())
            painter.drawPixmap(box, self._pixmap, QRectF(self._pixmap.rect()))
        painter.end()
