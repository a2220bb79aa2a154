"""What is said of the arm that is connected."""

from __future__ import annotations

import pytest
from PySide6.QtWidgets import QLabel

from app.gui.pages.robot.side import StatePart
from app.jobs.arm_events import ArmConnected, ArmStatus


def facts_of(qtbot, status):
    panel = StatePart()
    qtbot.addWidget(panel)
    panel.show_state(ArmConnected("UR5", None, is_simulated=True), status, False, False)
    return [label.text() for label in panel.findChildren(QLabel)]


@pytest.mark.parametrize(
    ("is_closed", "is_holding", "width_m", "said"),
    [
        (True, True, None, "holds something"),
        (True, False, None, "closed, empty"),
        (True, None, None, "closed"),
        (False, False, None, "open"),
        (False, None, None, "open"),
        (None, None, None, "--"),
        (True, True, 0.0621, "holds something, 62 mm wide"),
        (True, None, 0.0621, "closed, 62 mm wide"),
        (False, None, 0.085, "open, 85 mm wide"),
    ],
)
def test_a_gripper_is_shown_with_what_it_tells_of_itself(qtbot, is_closed, is_holding, width_m, said):
    status = ArmStatus(None, is_closed, "", is_holding=is_holding, grip_width_m=width_m)
    assert said in facts_of(qtbot, status)
