"""A folder or a mesh dropped onto the page."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QCoreApplication, QEvent, QMimeData, QObject, QRectF, Qt, Signal
from PySide6.QtGui import QDropEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget
from typing_extensions import override

from app.gui.pages.scan.object_choice import MESH_ENDINGS
from app.gui.theme import GRID_PX, theme_of


@dataclass(frozen=True)
class Dropped:
    """What was dropped: one of the two, or a sentence that says why it is neither."""

    folder: Path | None = None
    mesh: Path | None = None
    sentence: str = ""


def dropped(data: QMimeData) -> Dropped:
    """Tell what is being dropped."""
    translate = QCoreApplication.translate
    paths = [Path(url.toLocalFile()) for url in data.urls() if url.isLocalFile()]
    if len(paths) != 1:
        return Dropped(sentence=translate("ScanPage", "Drop one folder of views or one mesh file at a time."))
    [path] = paths
    if path.is_dir():
        return Dropped(folder=path)
    if path.suffix.lower() in MESH_ENDINGS:
        return Dropped(mesh=path)
    said = translate(
        "ScanPage", "{name} is neither a folder of views nor a mesh (.obj, .ply, .stl): nothing was imported."
    )
    return Dropped(sentence=said.format(name=path.name))


class DropTarget(QObject):
    """Lets things be dropped onto a page.

    Attributes:
        arrived: `Dropped`.
    """

    arrived = Signal(object)

    def __init__(self, page: QWidget) -> None:
        super().__init__(page)
        self._page = page
        self._hint = _Hint(page)
        page.setAcceptDrops(True)
        page.installEventFilter(self)

    @override
    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if isinstance(event, QDropEvent):  # enters and moves, too
            return self._take(event)
        if event.type() == QEvent.Type.DragLeave:
            self._hint.hide()
        return False

    def _take(self, event: QDropEvent) -> bool:
        if not event.mimeData().hasUrls():
            return False
        event.acceptProposedAction()
        if event.type() == QEvent.Type.DragEnter:
            self._hint.setGeometry(self._page.rect())
            self._hint.raise_()
            self._hint.show()
        elif event.type() == QEvent.Type.Drop:
            self._hint.hide()
            self.arrived.emit(dropped(event.mimeData()))
        return True


class _Hint(QWidget):
    """Lies over the page while something is dragged over it."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("drop_hint")
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.hide()

    @override
    def paintEvent(self, event: QPaintEvent) -> None:
        theme = theme_of(self)
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        veil = theme.color("window")
        veil.setAlphaF(0.8)
        painter.fillRect(self.rect(), veil)
        edge = QRectF(self.rect()).adjusted(GRID_PX, GRID_PX, -GRID_PX, -GRID_PX)
        painter.setPen(QPen(theme.color("accent"), 2, Qt.PenStyle.DashLine))
        painter.drawRoundedRect(edge, GRID_PX, GRID_PX)
        painter.setPen(theme.color("text"))
        font = self.font()
        font.setPointSizeF(1.4 * font.pointSizeF())
        painter.setFont(font)
        said = self.tr("Drop a folder of views or a mesh file to import it")
        painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter, said)
        painter.end()

    @override
    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.update()
