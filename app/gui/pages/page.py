"""What all pages have in common: one large view, one side panel, one primary button at the bottom right."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, QSize, Qt, QTimer
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QPushButton, QScrollArea, QSplitter, QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.desk.desk import Desk
from app.gui.theme import GRID_PX

SIDE_PX, _NARROWEST_SIDE_PX = 380, 300
PRIMARY = "primary"
"""Object name of the one button that a page is for."""


class Page(QWidget):
    """Base of all pages; a page refreshes when it is shown, and when the session or the cell changes.

    Attributes:
        KEY: its name in the program; also the object's name.
        desk: what the pages share.
    """

    KEY = ""

    def __init__(self, desk: Desk) -> None:
        super().__init__()
        self.setObjectName(self.KEY)
        self.desk = desk
        self._is_outdated = True
        for signal in (
            desk.workspace.session_changed,
            desk.workspace.stages_changed,
            desk.cell.changed,
        ):
            signal.connect(self._outdate)

    def refresh(self) -> None:
        """Show what the session holds now; called when the page is visible, and must return at once."""

    def press_primary(self) -> None:
        """Press the page's main button, if it can be pressed."""
        button = self.findChild(QPushButton, PRIMARY)
        if button is not None and button.isEnabled():
            button.click()

    def offer(self, button: QPushButton, is_shown: bool, is_enabled: bool = True) -> None:
        """Show and enable a button; the focus of one that goes does not wander to some other control."""
        if button.hasFocus() and not (is_shown and is_enabled):
            self.setFocus()
        button.setVisible(is_shown)
        button.setEnabled(is_enabled)

    @override
    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        if self._is_outdated:
            self._refresh()

    def _outdate(self) -> None:
        self._is_outdated = True
        if self.isVisible():
            self._refresh()

    def _refresh(self) -> None:
        self._is_outdated = False
        self.refresh()


class _SideArea(QScrollArea):
    """Scrolls downwards only, and is never narrower than what it holds: sideways it would be cut off."""

    @override
    def minimumSizeHint(self) -> QSize:
        content = self.widget()
        content_px = 0 if content is None else content.minimumSizeHint().width()
        bar_px = self.verticalScrollBar().sizeHint().width()
        return QSize(max(content_px + bar_px, _NARROWEST_SIDE_PX), super().minimumSizeHint().height())

    @override
    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() == QEvent.Type.LayoutRequest:
            self.updateGeometry()
        return super().eventFilter(watched, event)


class SidePanel(QFrame):
    """The few controls of a page, scrolled when they are many, above its buttons.

    Attributes:
        body: the layout that takes the controls.
        primary: the one button that the page is for; enabled by the page.
    """

    def __init__(self, primary_text: str) -> None:
        super().__init__()
        self.setObjectName("side_panel")
        inside = QWidget()
        inside.setObjectName("side_body")
        self.body = QVBoxLayout(inside)
        self.body.setContentsMargins(2 * GRID_PX, 2 * GRID_PX, 2 * GRID_PX, GRID_PX)
        self.body.setSpacing(GRID_PX)
        self._area = area = _SideArea()
        area.setFrameShape(QFrame.Shape.NoFrame)
        area.setWidgetResizable(True)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        area.setWidget(inside)
        self.primary = QPushButton(primary_text)
        self.primary.setObjectName(PRIMARY)
        self.primary.setProperty("role", "primary")
        self.primary.setMinimumHeight(5 * GRID_PX)
        self._buttons = QHBoxLayout()
        self._buttons.setSpacing(GRID_PX)
        self._buttons.setContentsMargins(2 * GRID_PX, GRID_PX, 2 * GRID_PX, 2 * GRID_PX)
        self._buttons.addStretch(1)
        self._buttons.addWidget(self.primary)
        whole = QVBoxLayout(self)
        whole.setContentsMargins(0, 0, 0, 0)
        whole.setSpacing(0)
        whole.addWidget(area, 1)
        whole.addLayout(self._buttons)

    def reveal(self, widget: QWidget) -> None:
        """Scroll to where a control can be seen, once it has its place."""
        QTimer.singleShot(0, self, lambda: self._area.ensureWidgetVisible(widget, 0, GRID_PX))

    @override
    def sizeHint(self) -> QSize:
        """Return the usual width, also for a panel that is shown later than its page."""
        return QSize(SIDE_PX, super().sizeHint().height())

    def add_button(self, button: QPushButton) -> None:
        """Put a second button to the left of the primary one."""
        self._buttons.insertWidget(self._buttons.count() - 1, button)


class SplitView(QSplitter):
    """The large view at the left, the side panel at the right; the border can be dragged."""

    def __init__(self, view: QWidget, side: QWidget) -> None:
        super().__init__(Qt.Orientation.Horizontal)
        self.setChildrenCollapsible(False)
        self.setHandleWidth(1)
        self.addWidget(view)
        self.addWidget(side)
        self.setStretchFactor(0, 1)
        self.setStretchFactor(1, 0)
        self.reset()

    def reset(self) -> None:
        """Give the side panel its usual width."""
        self.setSizes([max(self.width() - SIDE_PX, SIDE_PX), SIDE_PX])
