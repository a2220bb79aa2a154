"""A session as a card: its picture, what it is called, the verdict, the pours and what came of them."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication, QEvent, QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QFont, QFontMetricsF, QPainter, QPainterPath, QPaintEvent, QPen, QPixmap
from PySide6.QtWidgets import QSizePolicy, QWidget
from typing_extensions import override

from app.gui.pages.history import words
from app.gui.pages.history.words import Verdict
from app.gui.theme import GRID_PX, Theme, theme_of
from app.gui.views.painting import draw_elided, smaller, tabular
from app.gui.views.state_mark import paint_mark
from app.library.summary import SessionSummary

PICTURE_PX = QSize(120, 90)
LEAST_WIDTH_PX = 312
_PADDING_PX = GRID_PX
_ROUND_PX = 4
_MARK_PX = 15.0
_LINES = 6
_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
_COLORS: dict[Verdict, str] = {"container": "good", "other": "text", "unknown": "muted"}


def card_height(font: QFont) -> int:
    """Return how high a card must be for its lines and its picture, without the space around it."""
    lines_px = QFontMetricsF(tabular(font, bold=True)).height() + (_LINES - 1) * QFontMetricsF(font).height()
    return round(max(lines_px, PICTURE_PX.height()) + 2 * _PADDING_PX)


def paint_verdict(painter: QPainter, box: QRectF, verdict: Verdict, theme: Theme) -> None:
    """Paint a verdict's mark: a full disc with a tick, a ring with a bar, a ring, or a cross."""
    if verdict == "damaged":
        paint_mark(painter, box, "failed", theme)
        return
    half = min(box.width(), box.height()) * 0.42
    center, color = box.center(), theme.color(_COLORS[verdict])
    painter.save()
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    pen = QPen(color, half * 0.28, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap)
    painter.setPen(pen)
    if verdict == "container":
        painter.setBrush(color)
    painter.drawEllipse(center, half, half)
    if verdict == "container":
        pen.setColor(theme.color("surface"))
        painter.setPen(pen)
        tick = [QPointF(-0.45, 0.05), QPointF(-0.1, 0.4), QPointF(0.5, -0.35)]
        painter.drawPolyline([center + corner * half for corner in tick])
    elif verdict == "other":
        painter.drawLine(center - QPointF(half * 0.5, 0), center + QPointF(half * 0.5, 0))
    painter.restore()


class CardPainter:
    """Paints cards in a widget's theme and font."""

    def __init__(self, widget: QWidget) -> None:
        self._widget = widget

    def paint(
        self,
        painter: QPainter,
        area: QRectF,
        session: SessionSummary,
        picture: QPixmap | None,
        *,
        is_selected: bool = False,
        is_hovered: bool = False,
        is_open: bool = False,
    ) -> None:
        """Paint a session's card into `area`."""
        theme = theme_of(self._widget)
        painter.save()
        painter.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.SmoothPixmapTransform)
        self._paint_ground(painter, area, theme, is_selected, is_hovered)
        inside = area.adjusted(_PADDING_PX, _PADDING_PX, -_PADDING_PX, -_PADDING_PX)
        frame = QRectF(inside.left(), inside.top(), PICTURE_PX.width(), PICTURE_PX.height())
        frame.moveTop(inside.center().y() - frame.height() / 2)
        _paint_picture(painter, frame, picture, theme, smaller(self._widget.font()))
        text = QRectF(inside)
        text.setLeft(frame.right() + 1.5 * GRID_PX)
        self._paint_text(painter, text, session, theme, is_open)
        painter.restore()

    def _paint_ground(
        self, painter: QPainter, area: QRectF, theme: Theme, is_selected: bool, is_hovered: bool
    ) -> None:
        width = 2.0 if is_selected else 1.0
        painter.setPen(QPen(theme.color("accent" if is_selected or is_hovered else "line"), width))
        painter.setBrush(theme.color("raised" if is_selected else "surface"))
        inset = width / 2
        painter.drawRoundedRect(area.adjusted(inset, inset, -inset, -inset), _ROUND_PX, _ROUND_PX)
        painter.setBrush(Qt.BrushStyle.NoBrush)

    def _paint_text(
        self, painter: QPainter, box: QRectF, session: SessionSummary, theme: Theme, is_open: bool
    ) -> None:
        name_font, font = tabular(self._widget.font(), bold=True), tabular(self._widget.font())
        painter.setFont(font)
        line = QFontMetricsF(font).height()
        row = QRectF(box.left(), box.top(), box.width(), QFontMetricsF(name_font).height())
        name_row = QRectF(row)
        if is_open:
            name_row.setRight(self._paint_chip(painter, row, theme) - GRID_PX / 2)
        painter.setFont(name_font)
        painter.setPen(theme.color("text"))
        draw_elided(painter, name_row, session.name, _LEFT)
        painter.setFont(font)
        row = QRectF(box.left(), row.bottom(), box.width(), line)
        paint_verdict(
            painter, QRectF(row.left(), row.top(), _MARK_PX, line), words.verdict_of(session), theme
        )
        draw_elided(
            painter, row.adjusted(_MARK_PX + GRID_PX / 2, 0, 0, 0), words.verdict_words(session), _LEFT
        )
        row.translate(0, line)
        if session.problem:
            self._paint_problem(painter, row, words.short_problem(session), theme)
        else:
            draw_elided(painter, row, words.score_words(session), _LEFT)
            row.translate(0, line)
            draw_elided(painter, row, words.outcome_words(session), _LEFT)
        painter.setFont(smaller(self._widget.font()))
        painter.setPen(theme.color("muted"))
        row.moveTop(box.bottom() - line)
        draw_elided(painter, row, words.date_words(session), _LEFT)
        row.translate(0, -line)
        draw_elided(painter, row, session.source, _LEFT)

    def _paint_problem(self, painter: QPainter, row: QRectF, problem: str, theme: Theme) -> None:
        """Two lines of it; the side panel has all of it."""
        painter.setFont(smaller(self._widget.font()))
        painter.setPen(theme.color("text"))
        both = QRectF(row.left(), row.top(), row.width(), 2 * QFontMetricsF(painter.font()).height())
        flags = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop
        painter.drawText(both, int(flags) | int(Qt.TextFlag.TextWordWrap), problem)

    def _paint_chip(self, painter: QPainter, row: QRectF, theme: Theme) -> float:
        """Mark the open session at the right end of `row`; return the mark's left edge."""
        said = QCoreApplication.translate("History", "open")
        painter.setFont(smaller(self._widget.font()))
        width = QFontMetricsF(painter.font()).horizontalAdvance(said) + 1.5 * GRID_PX
        chip = QRectF(row.right() - width, row.top(), width, row.height())
        path = QPainterPath()
        path.addRoundedRect(chip, chip.height() / 2, chip.height() / 2)
        painter.fillPath(path, theme.color("accent"))
        painter.setPen(theme.color("on_accent"))
        painter.drawText(chip, Qt.AlignmentFlag.AlignCenter, said)
        return chip.left()


def _paint_picture(
    painter: QPainter, frame: QRectF, picture: QPixmap | None, theme: Theme, font: QFont
) -> None:
    painter.save()
    clip = QPainterPath()
    clip.addRoundedRect(frame, _ROUND_PX - 1, _ROUND_PX - 1)
    if picture is None or picture.isNull():
        painter.fillPath(clip, theme.color("window"))
        painter.setPen(theme.color("muted"))
        painter.setFont(font)
        said = QCoreApplication.translate("History", "no picture")
        painter.drawText(frame, Qt.AlignmentFlag.AlignCenter, said)
    else:
        painter.setClipPath(clip)
        painter.drawPixmap(frame, picture, QRectF(picture.rect()))
    painter.restore()


class CardFace(QWidget):
    """One card by itself."""

    def __init__(self, name: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName(name)
        self._session: SessionSummary | None = None
        self._picture: QPixmap | None = None
        self._painter = CardPainter(self)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def show_session(self, session: SessionSummary, picture: QPixmap | None) -> None:
        """Show a session."""
        self._session, self._picture = session, picture
        self.setAccessibleName(words.spoken(session))
        self.setToolTip(words.spoken(session))
        self.update()

    @override
    def sizeHint(self) -> QSize:
        return QSize(LEAST_WIDTH_PX, card_height(self.font()))

    @override
    def minimumSizeHint(self) -> QSize:
        return QSize(LEAST_WIDTH_PX // 2, card_height(self.font()))

    @override
    def paintEvent(self, _event: QPaintEvent) -> None:
        if self._session is not None:
            self._painter.paint(QPainter(self), self.rect().toRectF(), self._session, self._picture)

    @override
    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.update()
