"""Sessions as cards in a list: only those on the screen are painted and have their pictures read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
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
from PySide6.QtGui import (
    QGuiApplication,
    QImage,
    QPainter,
    QPalette,
    QPen,
    QPixmap,
    QPixmapCache,
    QResizeEvent,
)
from PySide6.QtWidgets import (
    QAbstractItemView,
    QListView,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
)
from typing_extensions import override

from app.gui.pages.history import words
from app.gui.theme import GRID_PX, theme_of
from app.gui.views.painting import draw_elided, make_bare, tabular
from app.gui.views.picture_loader import PictureLoader
from app.library.summary import SessionSummary

_PICTURE_PX = QSize(120, 90)
_CARD_PX = 312
"""A card's least width."""
_LINES = 6

Index = QModelIndex | QPersistentModelIndex


class SessionModel(QAbstractListModel):
    """Sessions and their pictures, which are read when they are first painted.

    Attributes:
        sessions: the newest first.
        open_folder: of the open session.
    """

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.sessions: tuple[SessionSummary, ...] = ()
        self.open_folder: Path | None = None
        self._requested: set[Path] = set()
        self._loader = PictureLoader(self)
        self._loader.loaded.connect(self._keep)

    def set_sessions(self, sessions: Sequence[SessionSummary]) -> None:
        """Show other sessions."""
        for changed in set(sessions) - set(self.sessions):
            self._drop_picture(changed)
        self.beginResetModel()
        self.sessions = tuple(sessions)
        self.endResetModel()

    def set_picture(self, folder: Path, picture: Path) -> None:
        """Show a picture that was just made."""
        row = self.row_of(folder)
        if row is not None:
            session = replace(self.sessions[row], thumbnail=picture)
            self._drop_picture(session)
            self.sessions = (*self.sessions[:row], session, *self.sessions[row + 1 :])
            self.dataChanged.emit(self.index(row), self.index(row))

    def row_of(self, folder: Path) -> int | None:
        """Return the row of a session."""
        rows = (row for row, session in enumerate(self.sessions) if session.path == folder)
        return next(rows, None)

    @override
    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: B008 - as Qt has it
        return 0 if parent.isValid() else len(self.sessions)

    @override
    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        session = self.sessions[index.row()]
        if role == Qt.ItemDataRole.UserRole:
            return session
        if role == Qt.ItemDataRole.DisplayRole:
            return session.name
        if role == Qt.ItemDataRole.DecorationRole:
            return self._picture(session)
        if role in (Qt.ItemDataRole.ToolTipRole, Qt.ItemDataRole.AccessibleTextRole):
            return words.spoken(session)
        return None

    def _picture(self, session: SessionSummary) -> QPixmap | None:
        """What is loaded; otherwise it is requested, and the card is painted again when it comes."""
        if session.thumbnail is None:
            return None
        picture = QPixmap()
        if QPixmapCache.find(str(session.thumbnail), picture):
            return picture
        if session.path not in self._requested:
            self._requested.add(session.path)
            size = _PICTURE_PX * QGuiApplication.primaryScreen().devicePixelRatio()
            self._loader.request(session.path, session.thumbnail, size)
        return None

    def _drop_picture(self, session: SessionSummary) -> None:
        self._requested.discard(session.path)
        if session.thumbnail is not None:
            QPixmapCache.remove(str(session.thumbnail))

    def _keep(self, folder: Path, image: QImage) -> None:
        row = self.row_of(folder)
        if row is None or image.isNull():
            return
        self._requested.discard(folder)
        QPixmapCache.insert(str(self.sessions[row].thumbnail), QPixmap.fromImage(image))
        self.dataChanged.emit(self.index(row), self.index(row))


class _CardDelegate(QStyledItemDelegate):
    """Paints a session as a card: the picture, and at its right a line for each fact."""

    def __init__(self, view: CardList) -> None:
        super().__init__(view)
        self._view = view

    @override
    def sizeHint(self, _option: QStyleOptionViewItem, _index: Index) -> QSize:
        return self._view.gridSize()

    @override
    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        session: SessionSummary = index.data(Qt.ItemDataRole.UserRole)
        state: QStyle.StateFlag = option.state
        is_selected = bool(state & QStyle.StateFlag.State_Selected)
        is_pointed_at = bool(state & (QStyle.StateFlag.State_MouseOver | QStyle.StateFlag.State_HasFocus))
        theme = theme_of(self._view)
        gap = GRID_PX / 2 + 1
        card = QRectF(option.rect).adjusted(gap, gap, -gap, -gap)
        painter.save()
        painter.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.SmoothPixmapTransform)
        edge = theme.color("accent" if is_selected or is_pointed_at else "line")
        painter.setPen(QPen(edge, 2 if is_selected else 1))
        painter.setBrush(theme.color("raised" if is_selected else "surface"))
        painter.drawRoundedRect(card, 4, 4)
        frame = QRectF(card.topLeft(), _PICTURE_PX).translated(GRID_PX, (card.height() - 90) / 2)
        picture = index.data(Qt.ItemDataRole.DecorationRole)
        if picture is None:
            painter.fillRect(frame, theme.color("window"))
            painter.setPen(theme.color("muted"))
            painter.drawText(frame, Qt.AlignmentFlag.AlignCenter, self._view.tr("no picture"))
        else:
            painter.drawPixmap(frame, picture, QRectF(picture.rect()))
        text = card.adjusted(frame.width() + 2.5 * GRID_PX, GRID_PX, -GRID_PX, -GRID_PX)
        self._paint_lines(painter, text, session)
        painter.restore()

    def _paint_lines(self, painter: QPainter, box: QRectF, session: SessionSummary) -> None:
        theme, font = theme_of(self._view), self._view.font()
        mark, color = words.verdict_mark(session)
        is_open = session.path == self._view.sessions.open_folder
        name = self._view.tr("{name}  (open)").format(name=session.name) if is_open else session.name
        lines = (
            (name, "text"),
            (f"{mark} {words.verdict_title(session)}", color),
            (words.short_problem(session) or words.score_words(session), "text"),
            ("" if session.problem else words.outcome_words(session), "text"),
            (session.source, "muted"),
            (words.date_words(session), "muted"),
        )
        row = QRectF(box.left(), box.top(), box.width(), box.height() / _LINES)
        for number, (line, ink) in enumerate(lines):
            painter.setFont(tabular(font, bold=number == 0))
            painter.setPen(theme.color(ink))
            draw_elided(painter, row, line, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
            row.translate(0, row.height())


class CardList(QListView):
    """The cards, in as many columns as fit.

    Signals: `chosen` when others are selected; `wanted` with the session that was double-clicked.

    Attributes:
        sessions: the model.
    """

    chosen = Signal()
    wanted = Signal(object)

    def __init__(self, n_columns: int | None = None) -> None:
        """With `n_columns` there are that many, however narrow."""
        super().__init__()
        self.setObjectName("sessions")
        self.setAccessibleName(self.tr("Sessions, newest first"))
        self._n_columns = n_columns
        self.sessions = SessionModel(self)
        self.setModel(self.sessions)
        self.setItemDelegate(_CardDelegate(self))
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
        self.activated.connect(lambda index: self.wanted.emit(index.data(Qt.ItemDataRole.UserRole)))

    @property
    def selected(self) -> list[SessionSummary]:
        """The selected sessions, the oldest first."""
        rows = sorted((index.row() for index in self.selectedIndexes()), reverse=True)
        return [self.sessions.sessions[row] for row in rows]

    @property
    def card_height_px(self) -> int:
        """Height of a card with the gap around it."""
        lines_px = _LINES * (self.fontMetrics().height() + 1)
        return max(lines_px, _PICTURE_PX.height()) + 3 * GRID_PX

    def show_sessions(self, sessions: Sequence[SessionSummary]) -> None:
        """Show sessions; the selection and the scroll position stay, as far as they still exist."""
        if tuple(sessions) == self.sessions.sessions:
            return
        chosen = [session.path for session in self.selected]
        scrolled_px = self.verticalScrollBar().value()
        self.sessions.set_sessions(sessions)
        self.doItemsLayout()
        self.select(chosen)
        self.verticalScrollBar().setValue(scrolled_px)

    def select(self, folders: Sequence[Path]) -> None:
        """Select sessions by their folders instead of others, and scroll to the last of them."""
        selection = self.selectionModel()
        selection.clearSelection()
        for folder in folders:
            row = self.sessions.row_of(folder)
            if row is not None:
                index = self.sessions.index(row)
                selection.select(index, QItemSelectionModel.SelectionFlag.Select)
                selection.setCurrentIndex(index, QItemSelectionModel.SelectionFlag.NoUpdate)
                self.scrollTo(index)

    def set_open(self, folder: Path | None) -> None:
        """Mark the open session."""
        self.sessions.open_folder = folder
        self.viewport().update()

    @override
    def resizeEvent(self, event: QResizeEvent) -> None:
        # The scroll bar's width is always kept free: a grid that depended on it would make it come and go.
        width_px = self.width() - self.verticalScrollBar().sizeHint().width()
        n_columns = self._n_columns or max(width_px // _CARD_PX, 1)
        self.setGridSize(QSize(width_px // n_columns, self.card_height_px))
        super().resizeEvent(event)
