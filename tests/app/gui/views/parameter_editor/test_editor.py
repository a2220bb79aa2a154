from __future__ import annotations

import time

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtWidgets import QCheckBox, QComboBox, QLabel, QLineEdit

from app.gui.views.parameter_editor.editor import ParameterEditor
from app.gui.views.parameter_editor.inputs import ChoiceInput, NumberInput, PointInput
from app.gui.views.parameter_editor.tree import RESET, VALUE, ParameterTree
from core.parameters import Parameters, apply_settings, load_preset
from tests.awake import in_time

LEFT = Qt.MouseButton.LeftButton
VOXEL = "reconstruction.voxel_m"


@pytest.fixture
def editor(qtbot):
    widget = ParameterEditor(groups=("reconstruction", "collision"))
    qtbot.addWidget(widget)
    widget.resize(360, 700)
    widget.show()
    qtbot.waitExposed(widget)
    return widget


def view_of(editor):
    return editor.findChild(ParameterTree)


def rows(editor):
    """`{dotted name: its row}` of what is shown."""
    tree = view_of(editor)
    return {name: tree.row(name) for name in tree.names if not tree.row(name).isHidden()}


def click(qtbot, editor, name, column=VALUE):
    tree = view_of(editor)
    index = tree.indexFromItem(rows(editor)[name], column)
    qtbot.mouseClick(tree.viewport(), LEFT, pos=tree.visualRect(index).center())
    qtbot.wait(10)


def open_input(qtbot, editor, name, kind):
    click(qtbot, editor, name)
    found = view_of(editor).findChild(kind)
    assert found is not None
    return found


def type_number(qtbot, editor, name, text):
    spin = open_input(qtbot, editor, name, NumberInput)
    spin.lineEdit().setText(text)
    qtbot.keyClick(spin, Qt.Key.Key_Return)
    qtbot.wait(10)


def test_typing_a_number_in_mm_sends_the_new_parameters(qtbot, editor):
    with qtbot.waitSignal(editor.edited) as heard:
        type_number(qtbot, editor, VOXEL, "4")
    assert heard.args[0] == apply_settings(Parameters(), {VOXEL: 0.004})
    assert editor.parameters == heard.args[0]
    assert rows(editor)[VOXEL].text(VALUE) == "4 mm"
    assert "preset: 2 mm" in rows(editor)[VOXEL].text(0)
    assert editor.findChild(QLabel, "parameter_count").text() == "1 differs from preset"


def test_opening_and_leaving_changes_nothing(qtbot, editor):
    gamma = "collision.coacd_threshold"
    with qtbot.assertNotEmitted(editor.edited):
        spin = open_input(qtbot, editor, gamma, NumberInput)
        qtbot.keyClick(spin, Qt.Key.Key_Return)
        qtbot.wait(10)


def test_a_refused_value_is_explained_under_the_row_and_the_old_one_returns(qtbot, editor):
    with qtbot.assertNotEmitted(editor.edited):
        type_number(qtbot, editor, VOXEL, "500")
    assert editor.error(VOXEL) == "500 mm is not possible; allowed is 1 to 20 mm."
    row = rows(editor)[VOXEL]
    assert row.text(VALUE) == "2 mm"
    assert row.child(0).text(0) == editor.error(VOXEL)
    assert view_of(editor).visualItemRect(row.child(0)).height() > 10
    type_number(qtbot, editor, VOXEL, "3,5")
    assert editor.error(VOXEL) == ""
    assert rows(editor)[VOXEL].childCount() == 0
    assert editor.parameters.reconstruction.voxel_m == 0.0035


def test_a_choice_is_made_in_words(qtbot, editor):
    combo = open_input(qtbot, editor, "collision.method", ChoiceInput)
    assert [combo.itemText(k) for k in range(combo.count())] == ["exact", "V-HACD", "CoACD"]
    combo.hidePopup()
    with qtbot.waitSignal(editor.edited) as heard:
        combo.setCurrentIndex(1)
        combo.activated.emit(1)
    assert heard.args[0].collision.method == "vhacd"


def test_yes_or_no_is_toggled_by_a_click_and_by_space(qtbot, editor):
    with qtbot.waitSignal(editor.edited) as heard:
        click(qtbot, editor, "reconstruction.refine_poses")
    assert heard.args[0].reconstruction.refine_poses is False
    with qtbot.waitSignal(editor.edited) as heard:
        qtbot.keyClick(view_of(editor), Qt.Key.Key_Space)
    assert heard.args[0].reconstruction.refine_poses is True


def test_automatic_is_left_by_typing_and_comes_back_when_the_line_is_emptied(qtbot, editor):
    name = "reconstruction.truncation_m"
    spin = open_input(qtbot, editor, name, NumberInput)
    assert spin.text() == "automatic"
    qtbot.keyClick(spin, Qt.Key.Key_Escape)
    qtbot.wait(10)
    with qtbot.waitSignal(editor.edited) as heard:
        type_number(qtbot, editor, name, "20")
    assert heard.args[0].reconstruction.truncation_m == 0.02
    with qtbot.waitSignal(editor.edited) as heard:
        type_number(qtbot, editor, name, "")
    assert heard.args[0].reconstruction.truncation_m is None


def test_a_point_is_typed_in_mm(qtbot, editor):
    for name, text in (
        ("reconstruction.crop_min_m", "-300, -550, 30"),
        ("reconstruction.crop_max_m", "180 -150 350 mm"),
    ):
        line = open_input(qtbot, editor, name, PointInput)
        line.setText(text)
        qtbot.keyClick(line, Qt.Key.Key_Return)
        qtbot.wait(10)
    assert editor.parameters.reconstruction.crop_min_m == (-0.3, -0.55, 0.03)
    assert editor.parameters.reconstruction.crop_max_m == (0.18, -0.15, 0.35)


def test_one_parameter_is_reset_by_click_and_by_key(qtbot, editor):
    changed = apply_settings(Parameters(), {VOXEL: 0.004, "collision.max_faces": 500})
    editor.set_parameters(changed, "default", Parameters())
    with qtbot.waitSignal(editor.edited) as heard:
        click(qtbot, editor, VOXEL, RESET)
    assert heard.args[0] == apply_settings(Parameters(), {"collision.max_faces": 500})
    view_of(editor).setCurrentItem(rows(editor)["collision.max_faces"])
    with qtbot.waitSignal(editor.edited) as heard:
        qtbot.keyClick(view_of(editor), Qt.Key.Key_Delete)
    assert heard.args[0] == Parameters()


def test_parameters_from_outside_are_shown_without_a_signal(qtbot, editor):
    paper = load_preset("paper")
    with qtbot.assertNotEmitted(editor.edited):
        editor.set_parameters(paper, "default", Parameters())
    assert rows(editor)[VOXEL].text(VALUE) == "4 mm"
    assert editor.n_different == 5  # of the paper's, those in the two groups shown


def test_the_filter_shows_what_matches_by_name_or_description(qtbot, editor):
    line = editor.findChild(QLineEdit, "parameter_filter")
    line.setText("hulls")
    assert list(rows(editor)) == ["collision.vhacd_hulls"]
    line.setText("max depth")
    assert list(rows(editor)) == ["reconstruction.max_depth_m"]
    line.setText("nothing is called so")
    assert rows(editor) == {}
    assert editor.findChild(QLabel, "parameter_none").text() == "No parameter matches the filter."
    line.clear()
    assert len(rows(editor)) == 17


def test_only_what_differs_can_be_shown(qtbot, editor):
    tick = editor.findChild(QCheckBox, "parameter_only_different")
    tick.setChecked(True)
    assert rows(editor) == {}
    editor.set_value(VOXEL, 0.003)
    assert list(rows(editor)) == [VOXEL]
    editor.set_value(VOXEL, 0.002)
    assert rows(editor) == {}
    assert editor.findChild(QLabel, "parameter_none").isVisible()


def test_groups_not_shown_are_kept(qtbot, editor):
    paper = load_preset("paper")
    editor.set_parameters(paper, "paper", paper)
    editor.set_value(VOXEL, 0.003)
    assert editor.parameters == apply_settings(paper, {VOXEL: 0.003})
    assert {name.split(".")[0] for name in rows(editor)} == {"reconstruction", "collision"}


def test_a_preset_is_asked_for_and_a_saved_one_is_offered(qtbot, editor):
    editor.set_preset_names(("default", "paper", "/somewhere/bowl cell.json"))
    combo = editor.findChild(QComboBox, "parameter_preset")
    assert [combo.itemText(k) for k in range(combo.count())] == ["default", "paper", "bowl cell"]
    with qtbot.waitSignal(editor.preset_chosen) as heard:
        combo.activated.emit(2)
    assert heard.args == ["/somewhere/bowl cell.json"]
    with qtbot.assertNotEmitted(editor.preset_chosen):
        editor.set_parameters(Parameters(), "paper", load_preset("paper"))
    assert combo.currentText() == "paper"


def test_arrow_steps_stay_within_the_range(qtbot, editor):
    spin = open_input(qtbot, editor, VOXEL, NumberInput)
    spin.stepBy(-100)
    assert spin.value() == 1.0
    spin.stepBy(1)
    assert spin.value() == pytest.approx(1.1)
    spin.stepBy(1000)
    assert spin.value() == 20.0
    qtbot.keyClick(spin, Qt.Key.Key_Escape)


def test_reveal_finds_a_parameter_whatever_was_filtered(qtbot, editor):
    editor.findChild(QLineEdit, "parameter_filter").setText("hulls")
    editor.reveal(VOXEL)
    assert view_of(editor).currentItem() is rows(editor)[VOXEL]


def test_the_wheel_over_a_row_changes_nothing(qtbot, editor):
    view = view_of(editor)
    with qtbot.assertNotEmitted(editor.edited):
        qtbot.mouseMove(view.viewport(), QPoint(200, 40))
        qtbot.wait(10)
    assert view.findChild(NumberInput) is None


def test_building_is_quick(qtbot):
    times = []
    for _ in range(3):
        begin = time.process_time()
        widget = ParameterEditor(groups=("containability", "pouring"))
        times.append(time.process_time() - begin)
        qtbot.addWidget(widget)
    in_time(min(times), 0.060)
