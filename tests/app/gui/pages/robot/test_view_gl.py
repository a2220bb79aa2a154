"""The cell in 3D, drawn by OpenGL."""

from __future__ import annotations

import numpy as np
import pytest

from app.gui.pages.robot.loading import load_cell
from app.gui.pages.robot.motion import ShownMotion
from app.gui.pages.robot.view import ArmView
from app.jobs.arm_events import PlannedBackOff
from core.motion.pour.plan import MovePhase, PlannedMove, Segment
from core.motion.trajectory import JointTrajectory
from core.parameters import Parameters
from hardware.cell import read_cell

pytestmark = pytest.mark.gl


@pytest.fixture
def cell():
    return load_cell(read_cell(), Parameters().pouring.cup)


@pytest.fixture
def view(qtbot, cell):
    view = ArmView()
    qtbot.addWidget(view)
    view.resize(680, 640)
    view.show()
    qtbot.waitExposed(view)
    view.show_cell(cell)
    return view


def a_motion(cell, holds_cup):
    """One move, with the cup in the hand or without."""
    there = cell.model.home_rad + np.array([0.8, -0.2, -0.3, 0.2, 0.0, 0.3])
    way = JointTrajectory(np.array([0.0, 2.0]), np.array([cell.model.home_rad, there]))
    move = PlannedMove(Segment.CARRY, MovePhase.CARRY, way, holds_cup, None)
    line_m = np.array([[-0.5, 0.1, 0.2], [-0.2, -0.3, 0.4]])
    return ShownMotion(PlannedBackOff(1, (move,), np.eye(4), line_m))


def picture(view, qtbot):
    qtbot.wait(50)
    image = view.scene.grab_image().convertToFormat(view.scene.grab_image().Format.Format_RGB888)
    bits = np.frombuffer(image.constBits(), dtype=np.uint8).reshape(image.height(), image.bytesPerLine())
    return bits[:, : 3 * image.width()].astype(int)


def share_changed(before, after):
    return float((np.abs(before - after) > 8).mean())


def test_the_arm_is_drawn_where_it_is(view, qtbot, cell):
    at_home = picture(view, qtbot)
    assert at_home.std() > 10, "there is something"
    view.show_arm(cell.model.home_rad + np.array([1.0, 0, 0, 0, 0, 0]), holds_cup=False)
    assert share_changed(at_home, picture(view, qtbot)) > 0.01


def test_the_plan_is_a_ghost_that_follows_the_time_line(view, qtbot, cell):
    view.show_arm(cell.model.home_rad, holds_cup=False)
    alone = picture(view, qtbot)
    view.show_motion(a_motion(cell, holds_cup=True))
    view.timeline.set_time(2.0)
    at_end = picture(view, qtbot)
    assert share_changed(alone, at_end) > 0.01
    view.timeline.set_time(1.0)
    assert share_changed(at_end, picture(view, qtbot)) > 0.005
    view.show_motion(None)
    assert share_changed(alone, picture(view, qtbot)) < 0.001


def test_a_cup_that_nobody_knows_of_is_not_drawn(view, qtbot, cell):
    view.show_arm(cell.model.home_rad, holds_cup=False)
    standing = picture(view, qtbot)
    view.show_arm(cell.model.home_rad, holds_cup=None)
    assert share_changed(standing, picture(view, qtbot)) > 0.0005
