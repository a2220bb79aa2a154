"""The frame around the pages: session, devices and STOP above, the tabs at the left."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from PySide6.QtCore import QCoreApplication, QEvent, QObject, QPoint, QRect, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QFont,
    QFontMetrics,
    QKeyEvent,
    QKeySequence,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QShortcut,
    QWindow,
)
from PySide6.QtWidgets import (
    QAbstractButton,
    QApplication,
    QButtonGroup,
    QFrame,
    QHBoxLayout,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)
from typing_extensions import override

from app.gui.desk.desk import Desk
from app.gui.desk.page_states import PageState
from app.gui.pages.registry import TabFacts
from app.gui.shell.session_button import SessionButton
from app.gui.stop.panel import STOP_KEYS
from app.gui.theme import GRID_PX, theme_of
from app.gui.views.state_mark import State, paint_mark, state_word
from app.jobs.arm_events import ArmStatus

_STOP_KEY_CODES = [Qt.Key[f"Key_{key}"] for key in STOP_KEYS]
_MARK_PX = 16
_MOVED_RAD = 2e-4
"""Between two reported states; an arm at rest stays within it."""
_TABS_PX = 136


class TopBar(QFrame):
    """The bar above the pages: session, cell, robot, camera and STOP, legible from two metres."""

    def __init__(self, desk: Desk, window: QWidget) -> None:
        super().__init__()
        self.setObjectName("top_bar")
        self._desk = desk
        self._seen_status: ArmStatus | None = None
        self._is_moving = False
        self.session = SessionButton(desk)
        self._cell, self._robot, self._camera = Chip("cell_chip"), Chip("robot_chip"), Chip("camera_chip")
        self.stop = StopButton(window)
        row = QHBoxLayout(self)
        row.setContentsMargins(2 * GRID_PX, GRID_PX // 2, GRID_PX, GRID_PX // 2)
        row.setSpacing(2 * GRID_PX)
        row.addWidget(self.session)
        row.addStretch(1)
        for chip in (self._cell, self._robot, self._camera):
            row.addWidget(chip)
        row.addWidget(self.stop)
        jobs = desk.jobs
        for signal in (desk.cell.changed, desk.arm.changed, jobs.started, jobs.finished, jobs.failed):
            signal.connect(lambda *_: self._show_devices())
        self._show_devices()

    def _show_devices(self) -> None:
        self._show_cell()
        self._show_robot()
        self._show_camera()

    def _show_cell(self) -> None:
        settings = self._desk.cell.settings
        name = settings.name if settings is not None else self.tr("simulated cell")
        if self._desk.cell.is_simulated:
            tip = self.tr("{name}: no real arm moves.").format(name=name)
            self._cell.show_text(self.tr("SIMULATED"), plate="simulated", tip=tip)
        else:
            address = settings.robot.address if settings is not None else ""
            tip = self.tr("{name}: a real arm moves.").format(name=name)
            self._cell.show_text(
                self.tr("REAL  {address}").format(address=address), plate="attention", tip=tip
            )

    def _show_robot(self) -> None:
        arm, is_moving = self._desk.arm, self._sees_motion()
        if arm.connected is None:
            self._robot.show_text(self.tr("robot not connected"), state="empty")
        elif arm.status is None:
            self._robot.show_text(self.tr("robot connecting"), state="running")
        elif arm.status.problem:
            self._robot.show_text(self.tr("robot not ready"), state="failed", tip=arm.status.problem)
        elif is_moving:
            self._robot.show_text(self.tr("MOVING"), plate="attention", tip=arm.connected.name)
        else:
            self._robot.show_text(self.tr("robot ready"), state="fresh", tip=arm.connected.name)

    def _sees_motion(self) -> bool:
        """Whether the joints are elsewhere than in the state before; whatever moves them."""
        status = self._desk.arm.status
        if status is self._seen_status:
            return self._is_moving  # called for another reason
        before, self._seen_status = self._seen_status, status
        states = [None if one is None else one.state for one in (before, status)]
        self._is_moving = False
        if states[0] is not None and states[1] is not None:
            moved_rad = abs(states[1].joints_rad - states[0].joints_rad).max()
            self._is_moving = bool(moved_rad > _MOVED_RAD)
        return self._is_moving

    def _show_camera(self) -> None:
        job = self._desk.jobs.running
        settings = self._desk.cell.settings
        kind = settings.camera.kind if settings is not None else "simulated"
        if job is not None and job.host is self._desk.scan_host:
            self._camera.show_text(self.tr("camera live"), state="fresh", tip=kind)
        else:
            tip = self.tr("Camera ({kind}): connected during a scan.").format(kind=kind)
            self._camera.show_text(self.tr("camera idle"), state="empty", tip=tip)


class Chip(QWidget):
    """A short fact, plain or on a coloured plate, with a state's mark before it if there is one."""

    def __init__(self, name: str) -> None:
        super().__init__()
        self.setObjectName(name)
        self._text = ""
        self._plate = ""
        self._state: State | None = None
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)

    @property
    def text(self) -> str:
        """What it says."""
        return self._text

    def show_text(self, text: str, *, plate: str = "", state: State | None = None, tip: str = "") -> None:
        """Show a text; on a plate if one of the theme's colours is named.

        What is shown already is not drawn again: the arm reports ten times a second, and each time the whole
        window would be composed with its 3D view.
        """
        if (text, plate, state, tip) == (self._text, self._plate, self._state, self.toolTip()):
            return
        self._text, self._plate, self._state = text, plate, state
        self.setAccessibleName(text)
        self.setToolTip(tip)
        self.updateGeometry()
        self.update()

    @override
    def sizeHint(self) -> QSize:
        metrics = QFontMetrics(self.font())
        mark = _MARK_PX + GRID_PX // 2 if self._state is not None else 0
        width = metrics.horizontalAdvance(self._text) + (3 * GRID_PX if self._plate else GRID_PX) + mark
        return QSize(width, metrics.height() + GRID_PX)

    @override
    def paintEvent(self, _event: QPaintEvent) -> None:
        theme, area = theme_of(self), self.rect()
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(theme.color("text"))
        if self._plate:
            painter.setBrush(theme.color(self._plate))
            painter.setPen(Qt.PenStyle.NoPen)
            painter.drawRoundedRect(area.adjusted(1, 1, -1, -1), 6, 6)
            painter.setPen(theme.color("window" if theme.is_dark else "surface"))
        left = 0 if self._plate else GRID_PX // 2
        if self._state is not None:
            paint_mark(painter, QRectF(left, 0, _MARK_PX, area.height()), self._state, theme)
            left += _MARK_PX + GRID_PX // 2
        where = Qt.AlignmentFlag.AlignCenter if self._plate else Qt.AlignmentFlag.AlignVCenter
        painter.drawText(area.adjusted(left, 0, 0, 0), where, self._text)
        painter.end()


class StopButton(QPushButton):
    """STOP acts when pressed, not when released; so do its keys, wherever the focus is."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.setObjectName("stop")
        self.setText(self.tr("STOP"))
        self.setAccessibleName(self.tr("Stop the arm"))
        self.setToolTip(
            self.tr(
                "Stops the arm and its job at once (keys: {keys}). A software stop, not safety-rated: in "
                "danger press the emergency stop on the robot."
            ).format(keys=", ".join(STOP_KEYS))
        )
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        for key in STOP_KEYS:
            shortcut = QShortcut(QKeySequence(key), window)
            shortcut.setContext(Qt.ShortcutContext.ApplicationShortcut)
            shortcut.activated.connect(self.pressed)
        self._watch()

    @contextmanager
    def deaf(self) -> Iterator[None]:
        """While something is made: Python is asked about each of a page's thousands of events.

        Nothing is missed: presses and keys wait until this thread reads its events again.
        """
        application = QCoreApplication.instance()
        if application is not None:
            application.removeEventFilter(self)
        try:
            yield
        finally:
            self._watch()

    def _watch(self) -> None:
        application = QCoreApplication.instance()
        if application is not None:
            application.installEventFilter(self)

    @override
    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Catch what would not reach STOP; each press reaches one QWindow, once.

        Keys while a dialog disables shortcuts; and the mouse while an open menu takes every press, even one
        on a window of another process.
        """
        if not isinstance(watched, QWindow):
            return False
        if isinstance(event, QMouseEvent) and event.type() == QEvent.Type.MouseButtonPress:
            if QApplication.activePopupWidget() is not None and self._is_at(event.globalPosition().toPoint()):
                self.pressed.emit()
            return False
        if not isinstance(event, QKeyEvent):
            return False
        if event.type() != QEvent.Type.KeyPress or event.key() not in _STOP_KEY_CODES:
            return False
        if not event.isAutoRepeat():
            self.pressed.emit()
        return True

    def _is_at(self, global_position: QPoint) -> bool:
        return self.isVisible() and self.rect().contains(self.mapFromGlobal(global_position))


class Tab(QAbstractButton):
    """A page's title above its state's mark and word."""

    def __init__(self, facts: TabFacts, number: int | None) -> None:
        super().__init__()
        self.setObjectName(f"tab_{facts.key}")
        self.setCheckable(True)
        self.setText(facts.title)
        self.setToolTip(facts.tip)
        self.setAccessibleName(facts.title)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._number = number
        self._state: PageState | None = PageState("empty") if number is not None else None

    @property
    def state(self) -> PageState | None:
        """What it shows; none for pages that have no state."""
        return self._state

    def set_state(self, state: PageState) -> None:
        """Show another state."""
        if state != self._state:
            self._state = state
            self.setAccessibleDescription(state_word(state.word))
            self.update()

    @override
    def sizeHint(self) -> QSize:
        return QSize(_TABS_PX, 7 * GRID_PX if self._state is not None else 5 * GRID_PX)

    @override
    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        self._paint(painter)
        painter.end()

    def _paint(self, painter: QPainter) -> None:
        theme, area = theme_of(self), self.rect()
        if self.isChecked():
            painter.fillRect(area, theme.color("surface"))
            painter.fillRect(QRect(0, 0, 4, area.height()), theme.color("accent"))
        elif self.underMouse() or self.hasFocus():
            painter.fillRect(area, theme.color("raised"))
        font = QFont(self.font())
        font.setWeight(QFont.Weight.DemiBold if self.isChecked() else QFont.Weight.Normal)
        font.setPointSizeF(self.font().pointSizeF() + 1)
        painter.setFont(font)
        painter.setPen(theme.color("text"))
        title = self.text() if self._number is None else f"{self._number}  {self.text()}"
        inside = area.adjusted(2 * GRID_PX, GRID_PX, -GRID_PX // 2, -GRID_PX)
        if self._state is None:
            painter.drawText(inside, Qt.AlignmentFlag.AlignVCenter, title)
            return
        painter.drawText(inside, Qt.AlignmentFlag.AlignTop, title)
        self._paint_state(painter, inside, self._state)

    def _paint_state(self, painter: QPainter, inside: QRect, state: PageState) -> None:
        theme = theme_of(self)
        mark = QRect(inside.left() + 2 * GRID_PX + 2, inside.bottom() - 14, 14, 14)
        paint_mark(painter, mark.toRectF(), state.word, theme)
        font = QFont(self.font())
        font.setPointSizeF(self.font().pointSizeF() - 1)
        painter.setFont(font)
        painter.setPen(theme.color("muted"))
        is_told = state.figure and state.word in ("fresh", "running", "failed")
        text = state.figure if is_told else state_word(state.word)
        area = QRect(mark.right() + GRID_PX // 2 + 2, mark.top() - 2, inside.right() - mark.right(), 18)
        painter.drawText(area, Qt.AlignmentFlag.AlignVCenter, text)


class TabList(QFrame):
    """The pages in the order of the work, each with its state; the others below a line."""

    chosen = Signal(str)

    def __init__(self, stages: tuple[TabFacts, ...], others: tuple[TabFacts, ...]) -> None:
        super().__init__()
        self.setObjectName("tab_list")
        self.setFixedWidth(_TABS_PX)
        self._tabs: dict[str, Tab] = {}
        self._group = QButtonGroup(self)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, GRID_PX, 0, GRID_PX)
        column.setSpacing(0)
        for number, facts in enumerate(stages, 1):
            column.addWidget(self._add(facts, number))
        line = QFrame()
        line.setProperty("role", "line")
        column.addSpacing(GRID_PX)
        column.addWidget(line)
        column.addSpacing(GRID_PX)
        for facts in others:
            column.addWidget(self._add(facts, None))
        column.addStretch(1)

    def choose(self, key: str) -> None:
        """Mark a page as the one that is shown; none of them for a key that has no tab."""
        self._group.setExclusive(False)
        for name, tab in self._tabs.items():
            tab.setChecked(name == key)
        self._group.setExclusive(True)

    def set_state(self, key: str, state: PageState) -> None:
        """Show a page's state."""
        self._tabs[key].set_state(state)

    def _add(self, facts: TabFacts, number: int | None) -> Tab:
        tab = Tab(facts, number)
        tab.clicked.connect(lambda: self.chosen.emit(facts.key))
        self._group.addButton(tab)
        self._tabs[facts.key] = tab
        return tab
