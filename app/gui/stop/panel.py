"""The small window with STOP: always on top, at its place in the program's window or where it was dragged."""

from __future__ import annotations

from PySide6.QtCore import QPoint, QRect, Qt, Signal
from PySide6.QtGui import QCloseEvent, QKeySequence, QMouseEvent, QShortcut
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QSizePolicy, QVBoxLayout, QWidget
from typing_extensions import override

from app.gui.stop.messages import Answered, Dock

STOP_KEYS = ("F12", "Pause")
_GRIP_PX = 12


class StopPanel(QWidget):
    """STOP, a grip to drag it by, and what is known of its channel.

    Signals: `pressed`, when the button or its key goes down.
    """

    pressed = Signal()

    def __init__(self) -> None:
        flags = Qt.WindowType
        super().__init__(None, flags.Tool | flags.FramelessWindowHint | flags.WindowStaysOnTopHint)
        self.setObjectName("stop_panel")
        self.setWindowTitle(self.tr("Poursight STOP"))
        self.setAttribute(Qt.WidgetAttribute.WA_ShowWithoutActivating)
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self._button = QPushButton(self.tr("STOP"))
        self._button.setObjectName("stop")
        self._button.setAccessibleName(self.tr("Stop the arm"))
        self._button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._button.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Expanding)
        self._button.setToolTip(
            self.tr(
                "Stops the arm at once (keys: {keys}), whatever the program is doing. A software stop, not "
                "safety-rated: in danger press the emergency stop on the robot."
            ).format(keys=", ".join(STOP_KEYS))
        )
        self._button.pressed.connect(self.pressed)
        for key in STOP_KEYS:
            QShortcut(QKeySequence(key), self, self.pressed.emit)
        self._state = QLabel()
        self._state.setObjectName("stop_channel")
        self._state.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._state.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self._grip = _Grip(self)
        self._answer = ""
        self._lay_out()

    def dock(self, place: Dock) -> None:
        """Take the place that the window keeps for it, unless it was dragged away."""
        if self._grip.is_free:
            return
        self._grip.home = QRect(place.x, place.y, place.width, place.height)
        self.setGeometry(self._grip.home)

    def show_channel(self, is_open: bool) -> None:
        """Say whether the channel to the controller is open, and how long the last press took."""
        channel = self.tr("channel open") if is_open else self.tr("no channel")
        self._state.setText(" · ".join(filter(None, (channel, self._answer))))

    def show_answer(self, answered: Answered) -> None:
        """Say from now on what came of the last press."""
        ms = round(1000 * answered.seconds)
        self._answer = self.tr("no answer") if answered.problem else self.tr("{ms} ms").format(ms=ms)
        self._state.setToolTip(answered.problem)

    @override
    def closeEvent(self, event: QCloseEvent) -> None:
        event.ignore()  # it goes with the arm alone

    def _lay_out(self) -> None:
        column = QVBoxLayout()
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self._button, 1)
        column.addWidget(self._state)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(0)
        row.addWidget(self._grip)
        row.addLayout(column, 1)


class _Grip(QLabel):
    """Dragged, it takes the panel along; a double click docks it again.

    Attributes:
        is_free: whether the panel was dragged from its place.
        home: its place in the program's window.
    """

    def __init__(self, panel: QWidget) -> None:
        super().__init__("⋮", panel)
        self.setFixedWidth(_GRIP_PX)
        self.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.setCursor(Qt.CursorShape.SizeAllCursor)
        self.setToolTip(self.tr("Drag STOP to where you want it; double-click to put it back."))
        self.is_free = False
        self.home = QRect()
        self._panel = panel
        self._held_at: QPoint | None = None

    @override
    def mousePressEvent(self, event: QMouseEvent) -> None:
        self._held_at = event.globalPosition().toPoint() - self._panel.pos()

    @override
    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._held_at is not None:
            self.is_free = True
            self._panel.move(event.globalPosition().toPoint() - self._held_at)

    @override
    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        self._held_at = None

    @override
    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        self._held_at = None
        self.is_free = False
        self._panel.setGeometry(self.home)
