"""What is said of the arm that is connected."""

from __future__ import annotations

import pytest
from PySide6.QtWidgets import QLabel

from app.gui.pages.robot.side import StatePart
from app.jobs.arm_events import ArmConnected, ArmStatus


@pytest.mark.parametrize(
    ("is_closed", "is_holding", "said"),
    [
        (True, True, "holds something"),
        (True, False, "closed, empty"),
        (True, None, "closed"),
        (False, False, "open"),
        (False, None, "open"),
        (None, None, "--"),
    ],
)
def test_a_gripper_that_tells_what_it_holds_is_shown_so(qtbot, is_closed, is_holding, said):
    panel = StatePart()
    qtbot.addWidget(panel)
    status = ArmStatus(None, is_closed, "", is_holding=is_holding)
    panel.show_state(ArmConnected("UR5", None, is_simulated=True), status, False, False)
    assert said in [label.text() for label in panel.findChildren(QLabel)]


@pytest.mark.parametrize(
    ("is_closed", "width_m", "said"),
    [(True, 0.0621, "closed, 62 mm wide"), (False, 0.085, "open, 85 mm wide")],
)
def test_how_wide_the_fingers_are_is_shown_where_it_is_known(qtbot, is_closed, width_m, said):
    panel = StatePart()
    qtbot.addWidget(panel)
    status = ArmStatus(None, is_closed, "", grip_width_m=width_m)
    panel.show_state(ArmConnected("UR5", None, is_simulated=True), status, False, False)
    assert said in [label.text() for label in panel.findChildren(QLabel)]
