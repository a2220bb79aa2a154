"""The sessions as a list of cards: only those on the screen are painted and have their pictures read."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from PySide6.QtCore import (
    QAbstractListModel,
    QItemSelectionModel,
    QModelIndex,
    QObject,
    QPersistentModelIndex,
    QRectF,
    QSize,
    Qt,
    Signal,
)
from PySide6.QtGui import QImage, QPainter, QPalette, QPixmap, QResizeEvent
from PySide6.QtWidgets import QAbstractItemView, QListView, QStyle, QStyledItemDelegate, QStyleOptionViewItem
from typing_extensions import override

from app.gui.pages.history.card_painter import LEAST_WIDTH_PX, PICTURE_PX, CardPainter, card_height
from app.gui.pages.history.words import spoken
from app.gui.theme import GRID_PX
from app.gui.views.painting import make_bare
from app.gui.views.picture_loader import PictureLoader
from app.library.summary import SessionSummary

SESSION_ROLE = int(Qt.ItemDataRole.UserRole)
_MOST_PICTURES = 200
"""Kept in memory, 50 kB each; others are read again when they are scrolled to."""

Index = QModelIndex | QPersistentModelIndex


class CardModel(QAbstractListModel):
    """Sessions and their pictures.

    Signals: `pictured` when another picture was read.

    Attributes:
        open_folder: of the open session.
        pixel_ratio: of the screen.
    """

    pictured = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.open_folder: Path | None = None
        self.pixel_ratio = 1.0
        self.sessions: tuple[SessionSummary, ...] = ()
        self._made: dict[Path, Path] = {}
        self._pictures: OrderedDict[Path, QPixmap] = OrderedDict()
        self._asked: set[Path] = set()
        self._loader = PictureLoader(self)
        self._loader.loaded.connect(self._keep)

    def set_sessions(self, sessions: Sequence[SessionSummary]) -> bool:
        """Take over what sessions there are; return whether they are others or in another order."""
        before, now = self.sessions, tuple(sessions)
        known = {session.path: session for session in before}
        for session in now:
            if session != known.get(session.path, session):
                self._drop_picture(session.path)
        is_other = [s.path for s in before] != [s.path for s in now]
        if is_other:
            self.beginResetModel()
            self.sessions = now
            self.endResetModel()
        else:
            self.sessions = now
            self.update_all()
        return is_other

    def set_picture(self, folder: Path, picture: Path) -> None:
        """Show a picture that was just made."""
        self._drop_picture(folder)
        self._made[folder] = picture
        self._update(folder)

    def picture(self, session: SessionSummary) -> QPixmap | None:
        """Return a session's picture; if it has yet to be read, the card is painted again when it is."""
        found = self._pictures.get(session.path)
        if found is not None:
            self._pictures.move_to_end(session.path)
            return found
        source = self._made.get(session.path, session.thumbnail)
        if source is not None and session.path not in self._asked:
            self._asked.add(session.path)
            self._loader.request(session.path, source, PICTURE_PX * self.pixel_ratio)
        return None

    def row_of(self, folder: Path) -> int | None:
        """Return where a session stands."""
        rows = (row for row, session in enumerate(self.sessions) if session.path == folder)
        return next(rows, None)

    def update_all(self) -> None:
        """Paint all cards again."""
        if self.sessions:
            self.dataChanged.emit(self.index(0), self.index(len(self.sessions) - 1))

    @override
    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: B008 - as Qt has it
        return 0 if parent.isValid() else len(self.sessions)

    @override
    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        if not 0 <= index.row() < len(self.sessions):
            return None
        session = self.sessions[index.row()]
        if role == SESSION_ROLE:
            return session
        if role == Qt.ItemDataRole.DisplayRole:
            return session.name
        if role in (Qt.ItemDataRole.ToolTipRole, Qt.ItemDataRole.AccessibleTextRole):
            return spoken(session)
        return None

    def _drop_picture(self, folder: Path) -> None:
        self._made.pop(folder, None)
        self._pictures.pop(folder, None)
        self._asked.discard(folder)

    def _keep(self, folder: Path, image: QImage) -> None:
        if image.isNull():
            return
        self._asked.discard(folder)
        self._pictures[folder] = QPixmap.fromImage(image)
        while len(self._pictures) > _MOST_PICTURES:
            self._pictures.popitem(last=False)
        self._update(folder)
        self.pictured.emit()

    def _update(self, folder: Path) -> None:
        row = self.row_of(folder)
        if row is not None:
            self.dataChanged.emit(self.index(row), self.index(row))


class _Delegate(QStyledItemDelegate):
    """Paints a card into its cell, with a gap around it."""

    def __init__(self, view: QListView, model: CardModel) -> None:
        super().__init__(view)
        self._cards = CardPainter(view)
        self._model = model
        self.size = QSize(LEAST_WIDTH_PX, 100)

    @override
    def sizeHint(self, _option: QStyleOptionViewItem, _index: Index) -> QSize:
        return self.size

    @override
    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        session: SessionSummary = index.data(SESSION_ROLE)
        state: QStyle.StateFlag = option.state
        gap = GRID_PX / 2
        self._cards.paint(
            painter,
            QRectF(option.rect).adjusted(gap, gap, -gap, -gap),
            session,
            self._model.picture(session),
            is_selected=bool(state & QStyle.StateFlag.State_Selected),
            is_hovered=bool(state & (QStyle.StateFlag.State_MouseOver | QStyle.StateFlag.State_HasFocus)),
            is_open=session.path == self._model.open_folder,
        )


class CardList(QListView):
    """The cards, in as many columns as there is room for.

    Signals: `chosen` when others are selected; `wanted` with the session that was double-clicked.
    """

    chosen = Signal()
    wanted = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("sessions")
        self.setAccessibleName(self.tr("Sessions, the newest first"))
        self.cards = CardModel(self)
        self._delegate = _Delegate(self, self.cards)
        self.setModel(self.cards)
        self.setItemDelegate(self._delegate)
        self.setViewMode(QListView.ViewMode.IconMode)
        self.setMovement(QListView.Movement.Static)
        self.setResizeMode(QListView.ResizeMode.Adjust)
        self.setUniformItemSizes(True)
        self.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setMouseTracking(True)
        make_bare(self)
        self.viewport().setAutoFillBackground(True)  # what is opaque is moved, not painted, when it scrolls
        self.viewport().setBackgroundRole(QPalette.ColorRole.Window)
        self.selectionModel().selectionChanged.connect(lambda *_: self.chosen.emit())
        self.activated.connect(lambda index: self.wanted.emit(index.data(SESSION_ROLE)))

    @property
    def selected(self) -> list[SessionSummary]:
        """The selected sessions, the oldest first."""
        rows = sorted((index.row() for index in self.selectedIndexes()), reverse=True)
        return [self.cards.sessions[row] for row in rows]

    def show_sessions(self, sessions: Sequence[SessionSummary]) -> None:
        """Show sessions; the selection and the place on the screen stay, as far as they are still there."""
        chosen = [session.path for session in self.selected]
        scrolled_px = self.verticalScrollBar().value()
        self.cards.pixel_ratio = self.devicePixelRatioF()
        if not self.cards.set_sessions(sessions):
            return
        self.doItemsLayout()
        self.select(chosen)
        self.verticalScrollBar().setValue(scrolled_px)

    def select(self, folders: Sequence[Path]) -> None:
        """Select sessions by their folders instead of others, and scroll to the last of them."""
        selection = self.selectionModel()
        selection.clearSelection()
        for folder in folders:
            row = self.cards.row_of(folder)
            if row is not None:
                index = self.cards.index(row)
                selection.select(index, QItemSelectionModel.SelectionFlag.Select)
                selection.setCurrentIndex(index, QItemSelectionModel.SelectionFlag.NoUpdate)
                self.scrollTo(index)

    def set_open(self, folder: Path | None) -> None:
        """Mark the open session."""
        if folder != self.cards.open_folder:
            self.cards.open_folder = folder
            self.cards.update_all()

    @override
    def resizeEvent(self, event: QResizeEvent) -> None:
        # The scroll bar's room is always kept: a grid that depended on it would make it come and go.
        room_px = self.width() - self.verticalScrollBar().sizeHint().width()
        columns = max(room_px // LEAST_WIDTH_PX, 1)
        self._delegate.size = QSize(room_px // columns, card_height(self.font()) + GRID_PX)
        self.setGridSize(self._delegate.size)
        super().resizeEvent(event)
