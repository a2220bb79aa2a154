"""A folder of views or a mesh that is dropped onto the page."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QCoreApplication, QEvent, QMimeData, QObject, Qt, Signal
from PySide6.QtGui import QColor, QDropEvent
from PySide6.QtWidgets import QLabel, QWidget
from typing_extensions import override

from app.gui.theme import GRID_PX, theme_of
from core.errors import InputError

MESH_ENDINGS = (".obj", ".ply", ".stl")


def dropped_path(data: QMimeData) -> Path:
    """Return the folder of views or the mesh that is being dropped.

    Raises:
        InputError: it is neither, or several things at once.
    """
    translate = QCoreApplication.translate
    paths = [Path(url.toLocalFile()) for url in data.urls() if url.isLocalFile()]
    if len(paths) != 1:
        raise InputError(translate("ScanPage", "Drop one folder of views or one mesh file at a time."))
    [path] = paths
    if not path.is_dir() and path.suffix.lower() not in MESH_ENDINGS:
        said = translate(
            "ScanPage",
            "{name} is neither a folder of views nor a mesh (.obj, .ply, .stl); nothing was imported.",
        )
        raise InputError(said.format(name=path.name))
    return path


class DropTarget(QObject):
    """Lets things be dropped onto a page.

    Signals: `arrived` with the path of a folder or mesh; `refused` with the `InputError` of anything else.
    """

    arrived = Signal(object)
    refused = Signal(object)

    def __init__(self, page: QWidget) -> None:
        super().__init__(page)
        self._page = page
        self._hint = QLabel(self.tr("Drop a folder of views or a mesh file to import it"), page)
        self._hint.setObjectName("drop_hint")
        self._hint.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._hint.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self._hint.hide()
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
            self._show_hint()
        elif event.type() == QEvent.Type.Drop:
            self._hint.hide()
            try:
                path = dropped_path(event.mimeData())
            except InputError as error:
                self.refused.emit(error)
            else:
                self.arrived.emit(path)
        return True

    def _show_hint(self) -> None:
        """Lay the hint over the page while something is dragged over it."""
        theme = theme_of(self._page)
        veil = theme.color("window")
        veil.setAlphaF(0.8)
        self._hint.setStyleSheet(
            f"background: {veil.name(QColor.NameFormat.HexArgb)}; color: {theme.color('text').name()};"
            f"border: 2px dashed {theme.color('accent').name()}; border-radius: {GRID_PX}px; font-size: 14pt;"
        )
        self._hint.setGeometry(self._page.rect().adjusted(GRID_PX, GRID_PX, -GRID_PX, -GRID_PX))
        self._hint.raise_()
        self._hint.show()
