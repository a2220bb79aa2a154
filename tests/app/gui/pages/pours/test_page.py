"""The Pours page on real sessions."""

import dataclasses

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QComboBox, QDoubleSpinBox, QLabel, QPushButton, QSpinBox

from app.gui.pages.pours.page import PoursPage
from app.gui.views.pour_map import PourMap
from core.imagination.risk.result import FewerCandies
from core.parameters import apply_settings
from core.session import Session
from core.session.operator_choice import read_operator_choice


@pytest.fixture
def page(desk, qtbot):
    page = PoursPage(desk)
    qtbot.addWidget(page)
    page.resize(1060, 640)
    page.show()
    desk.cell.restore()
    qtbot.waitUntil(lambda: desk.cell.settings is not None)
    return page


def opened(page, folder, qtbot):
    page.desk.workspace.open(folder)
    qtbot.waitUntil(lambda: page.content is not None and page.desk.background.is_idle)
    return page


def text_of(page, name):
    label = page.findChild(QLabel, name)
    return label.text() if label.isVisibleTo(page) else ""


def button(page, name):
    return page.findChild(QPushButton, name)


def test_without_a_session_it_says_what_will_be_here(page, qtbot):
    assert text_of(page, "chosen_pour") == "No pours yet."
    assert text_of(page, "pivot_legend") == ""
    with qtbot.waitSignal(page.desk.page_wanted) as wanted:
        button(page, "primary").click()
    assert wanted.args == ["scan"]


def test_the_chosen_pour_is_shown_and_leads_to_the_motion(page, mug_session, qtbot):
    opened(page, mug_session, qtbot)
    assert "reachable" in text_of(page, "chosen_pour")
    assert page.findChild(PourMap).selection == page.content.chosen
    assert button(page, "primary").text() == "Review motion"
    assert not button(page, "check_with_arm").isVisibleTo(page)
    with qtbot.waitSignal(page.desk.page_wanted) as wanted:
        button(page, "primary").click()
    assert wanted.args == ["robot"]


def test_map_and_scene_are_linked_both_ways(page, mug_session, qtbot):
    opened(page, mug_session, qtbot)
    pours_map, scene = page.findChild(PourMap), page._scene.scene
    pours_map.selected.emit(5, 1)
    assert "25 mm out" in text_of(page, "selected_facts")
    assert "pivots" in text_of(page, "pivot_legend")
    scene.picked.emit("pivots", 3 * 3 + 2)
    assert pours_map.selection == (3, 2)
    indent_m = page.content.grid.indent_m[2]
    assert f"{1000 * indent_m:.0f} mm out" in text_of(page, "selected_facts")
    scene.picked.emit("object", 4)
    assert pours_map.selection == (3, 2)
    scene.look_from("front")
    assert pours_map.rotation_deg == pytest.approx(0)


def test_the_replay_moves_cup_and_candies(page, mug_session, qtbot):
    opened(page, mug_session, qtbot)
    scene, timeline = page._scene.scene, page._scene.timeline
    recording = page.content.grid.recordings[page.content.chosen[0]][page.content.chosen[1]]
    assert timeline.time_s == pytest.approx(float(recording.time_s[-1]))
    timeline.set_time(0.0)
    assert scene._layers["cup"].T_world_layer == pytest.approx(recording.T_world_body[0])
    timeline.set_time(1.5)
    k = int((recording.time_s <= 1.5 + 1e-6).sum()) - 1
    assert scene._layers["cup"].T_world_layer == pytest.approx(recording.T_world_body[k])


def test_another_pour_is_chosen_with_a_reason_and_withdrawn(page, mug_session, qtbot):
    opened(page, mug_session, qtbot)
    program = page.content.chosen
    found = page.content.motions.pours
    wanted = next((one.i, one.j) for one in found if one.is_feasible and (one.i, one.j) != program)
    page.select(*wanted)
    assert not button(page, "choose_pour").isEnabled(), "there is no reason yet"
    page.findChild(QComboBox, "reason").setEditText("the handle is in the way")
    button(page, "choose_pour").click()
    qtbot.waitUntil(lambda: page.content.operator is not None)
    assert page.content.chosen == wanted
    assert "Chosen by the operator" in text_of(page, "chosen_why")
    digest = Session.open(mug_session).record("pouring").digest
    assert read_operator_choice(mug_session, digest).reason == "the handle is in the way"
    button(page, "withdraw_choice").click()
    qtbot.waitUntil(lambda: page.content.operator is None)
    assert page.content.chosen == program


def test_what_the_arm_cannot_make_cannot_be_chosen(page, mug_session, qtbot):
    opened(page, mug_session, qtbot)
    impossible = next(one for one in page.content.motions.pours if not one.is_feasible)
    page.select(impossible.i, impossible.j)
    page.findChild(QComboBox, "reason").setEditText("just because")
    assert not button(page, "choose_pour").isEnabled()
    assert impossible.reason in text_of(page, "selected_arm")


@pytest.mark.system
def test_a_fixed_direction_of_the_grid_is_compared_at_once(page, mug_session, qtbot):
    opened(page, mug_session, qtbot)
    chooser = page.findChild(QComboBox, "compare_with")
    chooser.setCurrentIndex(1)
    chooser.activated.emit(1)
    assert "needs no run of its own" in text_of(page, "comparison")
    page.findChild(QDoubleSpinBox, "fixed_angle").setValue(20)
    assert "have to be imagined" in text_of(page, "comparison")
    assert button(page, "imagine_variant").isEnabled()
    with qtbot.waitSignal(page._variant.imagined):
        button(page, "imagine_variant").click()
    assert "Fixed at 20°" in text_of(page, "comparison")
    assert page._compare.other.grid.p.shape == (1, 3)
    assert page.desk.workspace.is_fresh("pouring"), "the session is left as it was"


def test_another_session_is_compared_with(page, mug_session, block_session, qtbot):
    opened(page, mug_session, qtbot)
    chooser = page.findChild(QComboBox, "compare_with")
    chooser.setCurrentIndex(3)
    page._load_other(mug_session)
    qtbot.waitUntil(lambda: page._compare.other is not None)
    assert "just as good" in text_of(page, "comparison")
    page._load_other(block_session)
    qtbot.waitUntil(lambda: "not an open container" in text_of(page, "comparison"))
    assert page._compare.other is None


@pytest.mark.system
def test_the_run_before_is_compared_with(page, mug_session, qtbot):
    opened(page, mug_session, qtbot)
    first = page.content.grid
    workspace = page.desk.workspace
    workspace.edit(
        apply_settings(workspace.parameters, {"pouring.theta_fixed_rad": 1.0, "risk.n_tries": 0}),
        "one direction",
    )
    qtbot.waitUntil(lambda: button(page, "primary").text() == "Imagine")
    with qtbot.waitSignal(page.desk.jobs.finished):
        button(page, "primary").click()
    qtbot.waitUntil(lambda: page.content.grid.p.shape == (1, 3))
    assert page._before is first
    assert page.findChild(PourMap).selection == page.content.chosen
    assert "Only the direction 57° was imagined" in text_of(page, "chosen_why")
    assert "not yet checked with the arm" in text_of(page, "chosen_pour")
    chooser = page.findChild(QComboBox, "compare_with")
    chooser.setCurrentIndex(2)
    chooser.activated.emit(2)
    assert page._compare.other.grid is first
    assert "The previous run" in text_of(page, "comparison")

    with qtbot.waitSignal(page.desk.jobs.finished):
        button(page, "check_with_arm").click()
    qtbot.waitUntil(lambda: page.content.motions is not None)
    assert "The arm can make" in text_of(page, "chosen_why")
    assert page._compare.other.grid is first, "the same pours: the comparison stays"


def test_changed_parameters_make_it_stale(page, mug_session, qtbot):
    opened(page, mug_session, qtbot)
    workspace = page.desk.workspace
    workspace.edit(apply_settings(workspace.parameters, {"pouring.n_pour": 15}), "fewer candies")
    qtbot.waitUntil(lambda: "press Imagine" in page._choice.stale.text)
    assert button(page, "primary").text() == "Imagine"
    workspace.undo_stack.undo()
    qtbot.waitUntil(lambda: not page._choice.stale.text)
    assert button(page, "primary").text() == "Review motion"


def test_no_container_leads_to_the_imagination(page, block_session, qtbot):
    opened(page, block_session, qtbot)
    assert (
        text_of(page, "chosen_pour") == "No pours were imagined because the object is not an open container."
    )
    assert not page.findChild(PourMap).isVisibleTo(page)
    with qtbot.waitSignal(page.desk.page_wanted) as wanted:
        button(page, "primary").click()
    assert wanted.args == ["imagination"]


def test_how_much_is_asked_for_where_the_pours_are_and_can_be_undone(page, mug_session, qtbot):
    opened(page, mug_session, qtbot)
    workspace = page.desk.workspace
    before = workspace.parameters
    kind, number = page.findChild(QComboBox, "amount_kind"), page.findChild(QSpinBox, "amount_number")
    assert (kind.currentData(), number.value()) == (before.pouring.amount, before.pouring.n_pour)
    assert not button(page, "pour_fewer").isVisibleTo(page)
    number.setFocus()
    number.selectAll()
    qtbot.keyClicks(number, "25")
    assert workspace.parameters == before, "a number half typed is not asked for"
    qtbot.keyClick(number, Qt.Key.Key_Return)
    assert workspace.parameters.pouring.n_pour == 25
    kind.setCurrentIndex(kind.findData("half"))
    kind.activated.emit(kind.currentIndex())
    assert workspace.parameters.pouring.amount == "half"
    assert not number.isVisibleTo(page)
    qtbot.waitUntil(lambda: button(page, "primary").text() == "Imagine")
    workspace.undo_stack.undo()
    workspace.undo_stack.undo()
    assert workspace.parameters == before
    qtbot.waitUntil(lambda: kind.currentData() == before.pouring.amount)
    assert number.value() == before.pouring.n_pour


def test_a_smaller_amount_that_is_sure_enough_is_one_click_away(page, mug_session, qtbot):
    opened(page, mug_session, qtbot)
    fewer = FewerCandies(17, 3, 0, 12, 12)
    risk = dataclasses.replace(page.content.risk, fewer=fewer)
    page.content = dataclasses.replace(page.content, imagined_risk=risk, motions=None)
    page.update_actions()
    less = button(page, "pour_fewer")
    assert less.isVisibleTo(page) and less.text() == "Pour 17 instead"
    with qtbot.waitSignal(page.desk.jobs.started):
        qtbot.mouseClick(less, Qt.MouseButton.LeftButton)
    assert page.desk.workspace.parameters.pouring.n_pour == 17
    page.desk.jobs.cancel()
    qtbot.waitUntil(lambda: page.desk.jobs.is_idle, timeout=20_000)
