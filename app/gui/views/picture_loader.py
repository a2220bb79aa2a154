"""Pictures read and scaled off the window's thread, alone or as the rows of a list."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

from PySide6.QtCore import QObject, QSize, Qt, Signal, Slot
from PySide6.QtGui import QImage, QImageReader, QPixmap, QStandardItem, QStandardItemModel


class _Messenger(QObject):
    """Carries pictures to their loaders. There is one, for ever: a thread must never destroy a QObject."""

    read = Signal(object, object, object, QImage)


@cache
def _messenger() -> _Messenger:
    return _Messenger()


@cache
def _threads() -> ThreadPoolExecutor:
    """Python's own: a `QRunnable` may be destroyed in one thread while Qt is still inside it in another."""
    return ThreadPoolExecutor(2)


def _read(loader: object, key: object, source: Path | QImage, size: QSize) -> None:
    """Read and scale a picture, in a thread."""
    if isinstance(source, QImage):
        image = source
    else:
        reader = QImageReader(str(source))
        reader.setAutoTransform(True)
        image = reader.read()
    if not image.isNull() and size.isValid():
        image = image.scaled(
            size, Qt.AspectRatioMode.KeepAspectRatio, Qt.TransformationMode.SmoothTransformation
        )
    _messenger().read.emit(loader, key, source, image)


class PictureLoader(QObject):
    """Reads pictures in threads and hands them back in the window's.

    Attributes:
        loaded: (key, QImage) as `request` was given; the image is null when the file cannot be read.
    """

    loaded = Signal(object, QImage)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._me = object()
        self._wanted: dict[object, Path | QImage] = {}
        _messenger().read.connect(self._pass_on, Qt.ConnectionType.QueuedConnection)

    def request(self, key: object, source: Path | QImage, size: QSize | None = None) -> None:
        """Read `source`, scaled to fit into `size` px; a later request with the same key replaces it."""
        self._wanted[key] = source
        _threads().submit(_read, self._me, key, source, QSize() if size is None else size)

    def forget(self) -> None:
        """Ignore what is still being read."""
        self._wanted.clear()

    @Slot(object, object, object, QImage)
    def _pass_on(self, loader: object, key: object, source: object, image: QImage) -> None:
        if loader is self._me and self._wanted.get(key) is source:
            del self._wanted[key]
            self.loaded.emit(key, image)


class PictureRow(QStandardItem):
    """A row of a `PictureModel`: its text, and where its picture comes from.

    Attributes:
        key: unique among the rows.
        source: the picture's file or the picture itself; none while there is none.
    """

    def __init__(self, text: str, key: object, source: Path | QImage | None) -> None:
        super().__init__(text)
        self.key = key
        self.source = source
        self.setEditable(False)


class PictureModel(QStandardItemModel):
    """Rows whose pictures arrive as `DecorationRole`: a pixmap, null where the file cannot be read."""

    def __init__(self, size: QSize, parent: QObject) -> None:
        """`size`: the pictures are scaled to fit into it."""
        super().__init__(parent)
        self._size = size
        self._rows: list[PictureRow] = []
        self._loader = PictureLoader(self)
        self._loader.loaded.connect(self._arrive)

    def set_rows(self, rows: Sequence[PictureRow]) -> None:
        """Show other rows; a picture that is unchanged is not read again."""
        known = {row.key: row for row in self._rows}
        pixmaps = {key: row.data(Qt.ItemDataRole.DecorationRole) for key, row in known.items()}
        self._rows = list(rows)
        for row in rows:
            row.setData(
                pixmaps.get(row.key) if row.source is not None else None, Qt.ItemDataRole.DecorationRole
            )
            if pixmaps.get(row.key) is None or row.source != known[row.key].source:
                self._request(row)
        self.clear()
        self.appendColumn(rows)

    def set_row(self, index: int, row: PictureRow) -> None:
        """Replace a row; its picture is read again, for the file may have been rewritten."""
        if row.source is not None and row.key == self._rows[index].key:
            row.setData(
                self._rows[index].data(Qt.ItemDataRole.DecorationRole), Qt.ItemDataRole.DecorationRole
            )
        self._rows[index] = row
        self.setItem(index, row)
        self._request(row)

    def _request(self, row: PictureRow) -> None:
        if row.source is not None:
            self._loader.request(row.key, row.source, self._size)

    def _arrive(self, key: object, image: QImage) -> None:
        for row in self._rows:
            if row.key == key and row.source is not None:
                row.setData(QPixmap.fromImage(image), Qt.ItemDataRole.DecorationRole)
