"""Where the candies are before, during and after the rotation that pours."""

from __future__ import annotations

import numpy as np
import pytest

from app.gui.pages.robot.after_pour import OutcomePanel
from app.gui.pages.robot.candies import PouredCandies, load_imagined, load_truth
from core.geometry import invert_pose, make_pose, rotation_z, transform_points
from core.imagination.recording import Recording
from core.pipeline.session_view import SessionView
from core.session.pour_runs import Outcome, PourRun


@pytest.fixture
def candies():
    """Two candies: one leaves the cup, one never does; the cup moves by a metre along x."""
    times_s = np.array([0.0, 0.5, 1.0], dtype=np.float32)
    positions_m = np.array([[[0, 0, 1], [0, 0, 2]], [[1, 0, 0.5], [1, 0, 2]], [[3, 0, 0], [1, 0, 2]]])
    quaternions = np.tile([0, 0, 0, 1], (3, 2, 1))
    cups = np.array([make_pose(np.eye(3), [x, 0, 0]) for x in (0, 1, 1)])
    recording = Recording(times_s, *(a.astype(np.float32) for a in (positions_m, quaternions, cups)))
    kept, staying = np.array([True, False]), np.array([False, True])
    return PouredCandies(
        recording, kept, staying, (np.empty((0, 3)), np.empty((0, 3))), 0.2, 0.8, is_true=False
    )


def test_in_the_carried_cup_they_lie_as_they_were_packed(candies):
    T_base_cup = make_pose(rotation_z(np.pi / 2), [5, 0, 0])
    positions_m, _ = candies.carried(10.0, T_base_cup)
    in_cup = transform_points(invert_pose(T_base_cup), positions_m)
    np.testing.assert_allclose(in_cup, [[0, 0, 1], [0, 0, 2]], atol=1e-6)


def test_afterwards_what_is_still_in_the_cup_goes_with_it_and_what_left_stays(candies):
    positions_m, _ = candies.after(9.0, make_pose(np.eye(3), [7, 0, 0]))
    np.testing.assert_allclose(positions_m, [[3, 0, 0], [7, 0, 2]], atol=1e-6)


def test_the_imagined_pour_of_a_session_ends_as_it_was_counted(mug_session):
    view = SessionView.of(mug_session)
    i, j = view.place
    found = load_imagined(mug_session, i, j)
    n_in = int(view.grid.n_in[i, j, 0])
    assert int(found.kept.sum()) == n_in
    assert len(found.kept) == view.grid.n_pour
    assert load_truth(mug_session, mug_session / "pours" / "0001") is None


@pytest.mark.parametrize(
    ("name", "n_in_cup", "said"),
    [("mug", 0, "19 of 20 in the mug"), ("test 3", 2, "17 of 20 in the object")],
)
def test_the_card_says_how_many_are_in_the_object(qtbot, tmp_path, name, n_in_cup, said):
    panel = OutcomePanel()
    qtbot.addWidget(panel)
    panel.call_object(name)
    outcome = Outcome(20, 1, "", is_simulated=True, facts={"n_in_cup": n_in_cup})
    panel.show_run(PourRun(tmp_path, (), outcome), 20, "")
    assert panel.heading.text() == said
    for button, signal in (("outcome_report", panel.report_wanted), ("outcome_new", panel.object_wanted)):
        with qtbot.waitSignal(signal):
            panel.findChild(object, button).click()
