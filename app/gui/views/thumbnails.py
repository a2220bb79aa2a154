"""The views of a scan as a grid of small pictures with their states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from PySide6.QtCore import (
    QAbstractListModel,
    QEvent,
    QItemSelectionModel,
    QModelIndex,
    QObject,
    QPersistentModelIndex,
    QSignalBlocker,
    QSize,
    Qt,
    Signal,
)
from PySide6.QtGui import QImage, QPixmap, QResizeEvent
from PySide6.QtWidgets import QListView, QVBoxLayout, QWidget

from app.gui.views.painting import make_bare
from app.gui.views.picture_loader import PictureLoader
from app.gui.views.thumbnail_delegate import ThumbnailDelegate

ThumbnailState = Literal["pending", "taken", "poor", "failed"]
_PICTURE = QSize(240, 180)
"""Pictures are kept this large: sharp at any size the grid shows them in."""
_LEAST_PX = QSize(58, 58)
_MOST_PX = 150
_Index = QModelIndex | QPersistentModelIndex


@dataclass(frozen=True)
class Thumbnail:
    """One view.

    Attributes:
        name: unique and stable, such as "view-07".
        label: what stands in its corner, such as "7".
        state: pending, taken, poor or failed.
        picture: its file or the picture itself; None while there is none.
        tooltip: all there is to know of it.
    """

    name: str
    label: str
    state: ThumbnailState
    picture: Path | QImage | None = None
    tooltip: str = ""


class _Thumbnails(QAbstractListModel):
    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.items: list[Thumbnail] = []
        self._pixmaps: dict[str, QPixmap] = {}
        self._loader = PictureLoader(self)
        self._loader.loaded.connect(self._arrive)

    def reset(self, items: Sequence[Thumbnail]) -> None:
        """Show other views; a picture that is the same is not read again."""
        before = {item.name: item.picture for item in self.items}
        self.beginResetModel()
        self.items = list(items)
        kept = {item.name for item in items if item.picture is not None}
        self._pixmaps = {name: pixmap for name, pixmap in self._pixmaps.items() if name in kept}
        self.endResetModel()
        for item in items:
            if item.name not in self._pixmaps or item.picture != before.get(item.name):
                self._request(item)

    def replace(self, row: int, item: Thumbnail) -> None:
        """Show another state or picture of one view; its file is read again, it may have been retaken."""
        before = self.items[row]
        self.items[row] = item
        if item.picture is None or item.name != before.name:
            self._pixmaps.pop(item.name, None)
        self._request(item)
        self.dataChanged.emit(self.index(row), self.index(row))

    def _request(self, item: Thumbnail) -> None:
        if item.picture is not None:
            self._loader.request(item.name, item.picture, _PICTURE)

    def _arrive(self, name: object, image: QImage) -> None:
        for row, item in enumerate(self.items):
            if item.name == name and item.picture is not None:
                self._pixmaps[item.name] = QPixmap.fromImage(image)
                self.dataChanged.emit(self.index(row), self.index(row))

    def rowCount(self, parent: _Index | None = None) -> int:
        return 0 if parent is not None and parent.isValid() else len(self.items)

    def data(self, index: _Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        item = self.items[index.row()]
        if role == Qt.ItemDataRole.DisplayRole:
            return item.label
        if role == Qt.ItemDataRole.ToolTipRole:
            return item.tooltip or item.label
        if role == Qt.ItemDataRole.AccessibleTextRole:
            return f"{item.label}, {item.state}"
        if role == Qt.ItemDataRole.DecorationRole:
            return self._pixmaps.get(item.name)
        if role == Qt.ItemDataRole.UserRole:
            return item.state
        return None


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
        self._model = _Thumbnails(self)
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
        self._delegate = ThumbnailDelegate(self._view)
        self._view.setItemDelegate(self._delegate)
        self._view.selectionModel().currentChanged.connect(self._tell)
        self._view.activated.connect(lambda index: self.activated.emit(index.row()))
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self._view)

    @property
    def items(self) -> tuple[Thumbnail, ...]:
        """What is shown, in its order."""
        return tuple(self._model.items)

    @property
    def selection(self) -> int | None:
        """The selected index."""
        index = self._view.currentIndex()
        return index.row() if index.isValid() else None

    def set_items(self, items: Sequence[Thumbnail]) -> None:
        """Show these views; the selection stays with the view of the same name."""
        current = self.selection
        name = self._model.items[current].name if current is not None else None
        self._model.reset(items)
        row = next((k for k, item in enumerate(items) if item.name == name), None)
        self.select(row)
        self._arrange()

    def set_item(self, index: int, item: Thumbnail) -> None:
        """Show another state or picture of one view."""
        self._model.replace(index, item)

    def select(self, index: int | None) -> None:
        """Select a view or none, without a signal."""
        selection = self._view.selectionModel()
        with QSignalBlocker(selection):
            if index is None:
                selection.clear()
            else:
                selection.setCurrentIndex(
                    self._model.index(index), QItemSelectionModel.SelectionFlag.ClearAndSelect
                )
        self._view.viewport().update()

    def _tell(self, current: QModelIndex, _previous: QModelIndex) -> None:
        if current.isValid():
            self.selected.emit(current.row())

    def _arrange(self) -> None:
        """Find the largest cell with which all fit; where none does, scroll with the smallest."""
        bar = self._view.verticalScrollBar().sizeHint().width()
        width, height = self.width(), self.height()
        n = max(len(self._model.items), 1)
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
        # as needed, the list would leave the bar's room free even where all fit
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

    def changeEvent(self, event: QEvent) -> None:
        """Repaint in another theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._view.viewport().update()
