"""The header's chips: what they say of the arm, and that they are drawn only when it changes."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
from PySide6.QtCore import QEvent, QObject

from app.gui.shell.frame import Chip
from app.jobs.arm_events import ArmConnected, ArmDisconnected, ArmStatus


def test_an_arm_that_moves_is_said_to_move(window):
    arm, chip = window.desk.arm, window.findChild(Chip, "robot_chip")
    arm.connected = SimpleNamespace(name="UR5", pid=0)
    for joint_rad, said in ((0.0, "robot ready"), (0.1, "MOVING"), (0.2, "MOVING"), (0.2, "robot ready")):
        state = SimpleNamespace(joints_rad=np.full(6, joint_rad))
        arm.status = ArmStatus(state, False, "")
        arm.changed.emit()
        assert chip.text == said
        window.desk.cell.changed.emit()
        assert chip.text == said, "shown again for another reason"


def test_a_connected_arm_stays_connected_whatever_session_is_opened(window, tmp_path, mug_session):
    arm, chip = window.desk.arm, window.findChild(Chip, "robot_chip")
    assert chip.text == "robot not connected"
    window.desk.arm_host.open()
    arm.handle(ArmConnected("UR5", None, False, pid=window.desk.arm_host.pid))
    arm.handle(ArmStatus(None, False, ""))
    for folder in (tmp_path / "new", mug_session):
        assert window.desk.open_session(folder)
        assert chip.text == "robot ready"
    window.desk.workspace.close()
    assert chip.text == "robot ready"
    arm.handle(ArmDisconnected())
    assert chip.text == "robot not connected"


def test_an_arm_that_stands_draws_nothing_again(window, qtbot):
    arm = window.desk.arm
    arm.connected = SimpleNamespace(name="UR5", pid=0)
    painted: list[str] = []

    class Painted(QObject):
        def eventFilter(self, watched, event):
            if event.type() == QEvent.Type.Paint:
                painted.append(watched.objectName())
            return False

    def report(joint_rad: float) -> None:
        arm.status = ArmStatus(SimpleNamespace(joints_rad=np.full(6, joint_rad)), False, "")
        arm.changed.emit()

    report(0.0)
    qtbot.wait(100)  # what else there is to draw is drawn
    seen = Painted()
    for chip in window.findChildren(Chip):
        chip.installEventFilter(seen)
    for _ in range(5):
        report(0.0)
        qtbot.wait(20)
    assert painted == []
    report(0.1)
    qtbot.waitUntil(lambda: "robot_chip" in painted)
