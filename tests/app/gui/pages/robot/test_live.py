"""The panel that follows the arm's moves."""

from __future__ import annotations

from types import SimpleNamespace

from PySide6.QtCore import QEvent, QObject
from PySide6.QtWidgets import QApplication

from app.gui.pages.robot.panels import LivePanel
from app.jobs.arm_events import MoveProgress
from core.motion.pour.plan import Segment

MOTION = SimpleNamespace(duration_s=10.0, moves=[None] * 14)


class Paints(QObject):
    """Counts how often something was painted."""

    n = 0

    def eventFilter(self, _watched, event) -> bool:
        self.n += event.type() == QEvent.Type.Paint
        return False


def test_following_the_arm_paints_nothing_at_once(qtbot):
    """A 3D view in the window would be drawn with it, once for each of the events that came meanwhile."""
    panel, paints = LivePanel(), Paints()
    qtbot.addWidget(panel)
    with qtbot.waitExposed(panel):
        panel.show()
    panel.begin(is_return=False)
    qtbot.wait(50)
    QApplication.instance().installEventFilter(paints)
    for done_s in (2.0, 5.0, 9.0):
        panel.follow(MoveProgress(3, Segment.LIFT.value, 0.5, done_s, 10 - done_s, None), MOTION)
    assert paints.n == 0
    qtbot.waitUntil(lambda: paints.n > 0)
    assert panel._bar.fraction == 0.9
