"""The outcome is entered with two big buttons."""

from __future__ import annotations

import pytest

from app.gui.pages.robot.after_pour import OutcomePanel
from core.session.pour_runs import Outcome, PourRun


@pytest.fixture
def panel(qtbot):
    panel = OutcomePanel()
    qtbot.addWidget(panel)
    return panel


def run(tmp_path, outcome=None):
    return PourRun(tmp_path, (), outcome)


def press(panel, name, times=1):
    for _ in range(times):
        panel.findChild(object, name).click()


def test_nothing_is_taken_for_granted(panel, tmp_path):
    panel.show_run(run(tmp_path), 20, "")
    assert not panel.is_complete
    press(panel, "spilled_less")
    assert panel.outcome == Outcome(20, 0, "", is_simulated=False, facts={})
    assert panel.is_complete


def test_plus_and_minus_count_between_none_and_all(panel, tmp_path):
    panel.show_run(run(tmp_path), 3, "")
    press(panel, "spilled_more", 5)
    assert panel.outcome.n_spilled == 3
    press(panel, "spilled_less")
    assert panel.outcome.n_spilled == 2


def test_what_nobody_counted_is_told_as_such(panel, tmp_path):
    panel.show_run(run(tmp_path), 20, "")
    press(panel, "not_counted")
    panel.findChild(object, "remarks").setText("dark in here ")
    assert panel.is_complete
    assert panel.outcome == Outcome(20, None, "dark in here", is_simulated=False, facts={})


def test_what_physics_said_stays_physics_unless_it_is_corrected(panel, tmp_path):
    simulated = Outcome(20, 1, "", is_simulated=True, facts={"n_in_cup": 0})
    panel.show_run(run(tmp_path, simulated), 20, "")
    assert panel.outcome == simulated
    press(panel, "spilled_more")
    assert panel.outcome == Outcome(20, 2, "", is_simulated=False, facts={})


def test_while_physics_counts_nothing_can_be_entered(panel, tmp_path):
    panel.show_counting()
    assert not panel.findChild(object, "spilled_more").isEnabled()
    assert not panel.is_complete
    panel.show_run(run(tmp_path), 20, "")
    assert panel.findChild(object, "spilled_more").isEnabled()
