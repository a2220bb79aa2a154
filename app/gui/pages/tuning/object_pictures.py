"""Small pictures of the objects of a board, as the process that draws them sends them."""

from __future__ import annotations

import threading
from contextlib import suppress

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QImage

from app.jobs.object_pictures import draw_objects
from core.child_process import ChildProcess
from core.evaluation.labels import LabelledObject

PICTURE_PX = (56, 42)
_DRAWN_PX = (2 * PICTURE_PX[0], 2 * PICTURE_PX[1])
"""Sharp on a screen of twice the density, too."""


class ObjectPictures(QObject):
    """Has each object drawn; one that cannot be read goes without a picture.

    Signals: `drawn` with an object's name and its picture.
    """

    drawn = Signal(str, QImage)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._objects: tuple[LabelledObject, ...] = ()

    def show(self, objects: tuple[LabelledObject, ...]) -> None:
        """Have these objects drawn from now on, unless it is being done."""
        if objects == self._objects:
            return
        self._objects = objects
        if objects:
            threading.Thread(target=self._listen, args=(objects,), daemon=True).start()

    def _listen(self, objects: tuple[LabelledObject, ...]) -> None:
        """In a thread of its own: the window has no time for the start of a process."""
        child = ChildProcess(draw_objects, objects, _DRAWN_PX, name="poursight object pictures")
        with suppress(EOFError, OSError, RuntimeError):  # all are drawn; or the window is gone
            while objects is self._objects:
                name, (width, height), content = child.connection.recv()
                image = QImage(content, width, height, 4 * width, QImage.Format.Format_RGBA8888)
                self.drawn.emit(name, image.copy())  # the bytes go with the next message
        child.end()
