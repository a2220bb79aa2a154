"""Pictures read and scaled off the window's thread."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QObject, QRunnable, QSize, Qt, QThreadPool, Signal, Slot
from PySide6.QtGui import QImage, QImageReader


class _Messenger(QObject):
    """Carries pictures to the loader; without a parent, so that it outlives a closed window's tasks."""

    read = Signal(object, object, QImage)


class _Task(QRunnable):
    def __init__(self, key: object, source: Path | QImage, size: QSize, messenger: _Messenger) -> None:
        super().__init__()
        self._key = key
        self._source = source
        self._size = size
        self._messenger = messenger

    def run(self) -> None:
        if isinstance(self._source, QImage):
            image = self._source
        else:
            reader = QImageReader(str(self._source))
            reader.setAutoTransform(True)
            image = reader.read()
        if not image.isNull() and self._size.isValid():
            image = image.scaled(
                self._size, Qt.AspectRatioMode.KeepAspectRatio, Qt.TransformationMode.SmoothTransformation
            )
        self._messenger.read.emit(self._key, self._source, image)


class PictureLoader(QObject):
    """Reads pictures in the thread pool and hands them back in the window's thread.

    Attributes:
        loaded: (key, QImage) as `request` was given; the image is null when the file cannot be read.
    """

    loaded = Signal(object, QImage)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._messenger = _Messenger()
        self._messenger.read.connect(self._pass_on, Qt.ConnectionType.QueuedConnection)
        self._wanted: dict[object, Path | QImage] = {}

    def request(self, key: object, source: Path | QImage, size: QSize | None = None) -> None:
        """Read `source`, scaled to fit into `size` px; a later request with the same key replaces it."""
        self._wanted[key] = source
        task = _Task(key, source, QSize() if size is None else size, self._messenger)
        QThreadPool.globalInstance().start(task)

    def forget(self) -> None:
        """Let whatever is still being read come to nothing."""
        self._wanted.clear()

    @Slot(object, object, QImage)
    def _pass_on(self, key: object, source: object, image: QImage) -> None:
        if self._wanted.get(key) is source:
            del self._wanted[key]
            self.loaded.emit(key, image)
