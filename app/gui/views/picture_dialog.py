"""A picture shown large, and the way to those before and after it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import QImage, QKeyEvent, QPainter, QPaintEvent, QPixmap
from PySide6.QtWidgets import QDialog, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from app.gui.theme import GRID_PX, theme_of
from app.gui.views.picture_loader import PictureLoader


@dataclass(frozen=True)
class Picture:
    """A picture to show.

    Attributes:
        caption: what it shows.
        path: its file; None while it is still expected.
    """

    caption: str
    path: Path | None = None


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
