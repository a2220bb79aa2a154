"""What several painted widgets share: numbers of one width, small text, and hatching."""

from __future__ import annotations

from math import floor, log10

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter, QPainterPath, QPen
from PySide6.QtWidgets import QAbstractScrollArea


def tabular(font: QFont, points: float | None = None, *, bold: bool = False) -> QFont:
    """Return `font` with digits of one width, optionally at another size."""
    result = QFont(font)
    result.setFeature(QFont.Tag("tnum"), 1)
    result.setBold(bold)
    if points is not None:
        result.setPointSizeF(points)
    return result


def smaller(font: QFont) -> QFont:
    """Return `font` one step smaller, for what is read second."""
    return tabular(font, max(font.pointSizeF() - 1.0, 8.0))


def make_bare(view: QAbstractScrollArea) -> None:
    """Take frame and background off a list that is part of a panel: no frame in a frame."""
    view.setFrameShape(QAbstractScrollArea.Shape.NoFrame)
    view.setStyleSheet(f"{view.metaObject().className()} {{ border: none; }}")
    view.viewport().setAutoFillBackground(False)


def hatch(painter: QPainter, path: QPainterPath, color: QColor, spacing_px: float = 6.0) -> None:
    """Draw 45 degree lines through `path`; unlike a brush pattern they scale with the screen."""
    painter.save()
    painter.setClipPath(path, Qt.ClipOperation.IntersectClip)
    painter.setPen(QPen(color, 1.2))
    box = path.boundingRect()
    x = box.left() - box.height()
    while x < box.right():
        painter.drawLine(QPointF(x, box.bottom()), QPointF(x + box.height(), box.top()))
        x += spacing_px
    painter.restore()


def draw_elided(painter: QPainter, box: QRectF, text: str, flags: Qt.AlignmentFlag) -> None:
    """Draw one line of `text`, its end replaced by an ellipsis where it is too long."""
    metrics = QFontMetricsF(painter.font())
    painter.drawText(box, int(flags), metrics.elidedText(text, Qt.TextElideMode.ElideRight, box.width()))


def tick_step(least: float) -> float:
    """Return the least of 1, 2 and 5 times a power of ten that is not below `least`."""
    decade = 10.0 ** floor(log10(least))
    return next(factor * decade for factor in (1, 2, 5, 10) if factor * decade >= least)
