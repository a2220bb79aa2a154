"""At both sizes of the screenshots: no text is cut off, and nothing scrolls in something that scrolls."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QRect
from PySide6.QtGui import QTextDocument
from PySide6.QtWidgets import QAbstractButton, QAbstractScrollArea, QLabel, QPushButton

from app.gui.pages.registry import OTHERS, WORK
from app.gui.shell.window import MainWindow

pytestmark = pytest.mark.usefixtures("themed")

PAGES = (*WORK, *OTHERS)
SIZES = ((1280, 800), (1920, 1080))
PARTS = {
    "imagination": ("side_page_retention", "side_page_parameters"),
    "tuning": ("fit",),
}
"""Buttons that turn a part of a page over, by the page's key."""
SLACK_PX = 1
"""Rounded font metrics."""


def _plain(label: QLabel) -> str:
    document = QTextDocument()
    document.setHtml(label.text())
    return document.toPlainText() if "<" in label.text() else label.text()


def _is_cut(widget: QLabel | QAbstractButton) -> bool:
    """Whether it is smaller than its text needs, or reaches beyond what holds it."""
    if isinstance(widget, QLabel):
        room, metrics = widget.contentsRect(), widget.fontMetrics()
        if widget.wordWrap():
            return widget.heightForWidth(widget.width()) > widget.height() + SLACK_PX
        lines = _plain(widget).splitlines()
        widest_px = max((metrics.horizontalAdvance(line) for line in lines), default=0)
        return widest_px > room.width() + SLACK_PX or len(lines) * metrics.height() > room.height() + SLACK_PX
    return widget.sizeHint().width() > widget.width() + SLACK_PX


def _reaches_beyond(widget: QLabel | QAbstractButton, window: MainWindow) -> bool:
    """Whether it sticks out sideways of what it lies in; downwards it may be scrolled to."""
    parent = widget.parentWidget()
    while parent is not None and parent is not window:
        place = QRect(widget.mapTo(parent, widget.rect().topLeft()), widget.size())
        if place.left() < -SLACK_PX or place.right() > parent.width() + SLACK_PX:
            return True
        parent = parent.parentWidget()
    return False


def cut_texts(window: MainWindow) -> list[str]:
    """Name every visible text that is cut off."""
    found = [
        widget
        for kind in (QLabel, QPushButton)
        for widget in window.findChildren(kind)
        if widget.isVisibleTo(window) and widget.text()
    ]
    return [
        f"{widget.objectName()}: {widget.text()}"
        for widget in found
        if _is_cut(widget) or _reaches_beyond(widget, window)
    ]


def nested_scrolling(window: MainWindow) -> list[str]:
    """Name every area that scrolls downwards inside another one that does."""
    moving = [
        area
        for area in window.findChildren(QAbstractScrollArea)
        if area.isVisibleTo(window) and area.verticalScrollBar().maximum() > 0
    ]
    return [
        f"{inner.objectName()} in {outer.objectName() or type(outer).__name__}"
        for inner in moving
        for outer in moving
        if outer is not inner and outer.isAncestorOf(inner)
    ]


def primary_buttons(window: MainWindow) -> list[str]:
    """Name every visible button that looks like the one that the page is for."""
    page = window.page(window.shown)
    buttons = [button for button in page.findChildren(QPushButton) if button.isVisibleTo(page)]
    return [button.text() for button in buttons if button.property("role") == "primary"]


@pytest.mark.parametrize("size", SIZES, ids=lambda size: f"{size[0]}x{size[1]}")
@pytest.mark.parametrize("session", ["mug_session", "block_session"])
def test_no_text_is_cut_and_nothing_scrolls_in_something_that_scrolls(window, session, size, qtbot, request):
    window.resize(*size)
    assert cut_texts(window) == [], "welcome"
    window.desk.open_session(request.getfixturevalue(session))
    for key in PAGES:
        window.show_page(key)
        qtbot.waitUntil(lambda: window.desk.background.is_idle and window.desk.jobs.is_idle)
        qtbot.wait(100)  # layouts settle in the loop
        for part in ("", *PARTS.get(key, ())):
            if part:
                window.page(key).findChild(QPushButton, part).click()
                qtbot.wait(100)
            assert cut_texts(window) == [], f"{key} {part}"
            assert nested_scrolling(window) == [], f"{key} {part}"
            assert len(primary_buttons(window)) <= 1, f"{key} {part}"


def test_a_text_that_is_cut_is_found(window):
    label = QLabel("cut off for certain", window)
    label.setGeometry(0, 0, 20, 20)
    label.show()
    assert cut_texts(window) == [": cut off for certain"]
