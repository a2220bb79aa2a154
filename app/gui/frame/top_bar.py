"""Session, cell, robot and camera, and STOP: what must be seen from two metres."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QWidget
from typing_extensions import override

from app.gui.desk.desk import Desk
from app.gui.frame.chip import Chip
from app.gui.frame.stop_button import StopButton
from app.gui.theme import GRID_PX


class TopBar(QFrame):
    """The bar above the pages."""

    def __init__(self, desk: Desk, window: QWidget) -> None:
        super().__init__()
        self.setObjectName("top_bar")
        self._desk = desk
        self._session = QLabel()
        self._session.setObjectName("session_name")
        self._session.setProperty("role", "title")
        self._cell, self._robot, self._camera = Chip("cell_chip"), Chip("robot_chip"), Chip("camera_chip")
        self.stop = StopButton(window)
        row = QHBoxLayout(self)
        row.setContentsMargins(2 * GRID_PX, GRID_PX // 2, GRID_PX, GRID_PX // 2)
        row.setSpacing(2 * GRID_PX)
        row.addWidget(self._session, 1)
        for chip in (self._cell, self._robot, self._camera):
            row.addWidget(chip)
        row.addWidget(self.stop)
        desk.workspace.session_changed.connect(self._show_session)
        desk.cell.changed.connect(self._show_cell)
        desk.arm.changed.connect(self._show_cell)
        desk.jobs.started.connect(lambda *_: self._show_cell())
        desk.jobs.finished.connect(lambda *_: self._show_cell())
        desk.jobs.failed.connect(lambda *_: self._show_cell())
        self._show_session()
        self._show_cell()

    @override
    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._show_session()

    def _show_session(self) -> None:
        session = self._desk.workspace.session
        text = self.tr("No session") if session is None else session.name
        self._session.setToolTip("" if session is None else str(session.path))
        room = max(self._session.width(), 200)
        self._session.setText(
            self._session.fontMetrics().elidedText(text, Qt.TextElideMode.ElideMiddle, room)
        )

    def _show_cell(self) -> None:
        settings = self._desk.cell.settings
        name = settings.name if settings is not None else self.tr("simulated cell")
        if self._desk.cell.is_simulated:
            tip = self.tr("{name}: nothing real moves.").format(name=name)
            self._cell.say(self.tr("SIMULATED"), color="simulated", is_filled=True, tip=tip)
        else:
            address = settings.robot.address if settings is not None else ""
            text = self.tr("REAL  {address}").format(address=address)
            self._cell.say(
                text,
                color="attention",
                is_filled=True,
                tip=self.tr("{name}: the arm moves.").format(name=name),
            )
        self._show_robot()
        self._show_camera()

    def _show_robot(self) -> None:
        arm = self._desk.arm
        if arm.connected is None:
            self._robot.say(self.tr("robot not connected"), state="empty")
        elif arm.status is None:
            self._robot.say(self.tr("robot connecting"), state="running")
        elif arm.status.problem:
            self._robot.say(self.tr("robot not ready"), state="failed", tip=arm.status.problem)
        else:
            self._robot.say(self.tr("robot ready"), state="fresh", tip=arm.connected.name)

    def _show_camera(self) -> None:
        job = self._desk.jobs.running
        settings = self._desk.cell.settings
        kind = settings.camera.kind if settings is not None else "simulated"
        if job is not None and job.host is self._desk.scan_host:
            self._camera.say(self.tr("camera live"), state="fresh", tip=kind)
        else:
            tip = self.tr("Camera ({kind}): connected while a scan runs.").format(kind=kind)
            self._camera.say(self.tr("camera idle"), state="empty", tip=tip)
