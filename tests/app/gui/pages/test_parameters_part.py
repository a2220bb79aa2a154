import pytest
from PySide6.QtWidgets import QComboBox, QToolButton

from app.gui.pages.parameters_part import FoldedParameters, ParametersPart
from core.parameters import Parameters, load_preset

GROUPS = ("reconstruction", "collision")


@pytest.fixture
def part(qtbot, desk):
    part = ParametersPart(desk, GROUPS)
    qtbot.addWidget(part)
    return part


def test_an_edit_goes_to_the_workspace_and_can_be_undone(part, desk):
    workspace = desk.workspace
    part.editor.set_value("reconstruction.voxel_m", 0.003)
    assert workspace.parameters.reconstruction.voxel_m == 0.003
    assert "voxel_m" in workspace.undo_stack.undoText()
    workspace.undo_stack.undo()
    assert workspace.parameters == Parameters()
    assert part.editor.parameters == Parameters()
    workspace.undo_stack.redo()
    assert part.editor.parameters.reconstruction.voxel_m == 0.003


def test_a_preset_is_chosen_and_can_be_undone(part, desk):
    part.choose_preset("paper")
    assert desk.workspace.parameters == load_preset("paper")
    assert part.editor.n_different == 0
    desk.workspace.undo_stack.undo()
    assert desk.workspace.preset_name == "default"


def test_a_preset_that_is_none_is_told_of_and_changes_nothing(part, desk, qtbot):
    with qtbot.waitSignal(desk.message) as told:
        part.choose_preset("papre")
    assert "did you mean 'paper'" in told.args[0]
    assert desk.workspace.preset_name == "default"
    assert part.findChild(QComboBox, "parameter_preset").currentData() == "default"


def test_a_saved_preset_is_the_one_that_is_compared_with_from_now_on(part, desk, tmp_path):
    part.editor.set_value("collision.max_faces", 3000)
    assert part.editor.n_different == 1
    part.save_as(tmp_path / "mine.json")
    assert desk.workspace.preset_name == str(tmp_path / "mine.json")
    assert part.editor.n_different == 0
    assert part.findChild(QComboBox, "parameter_preset").currentText() == "mine"


def test_a_preset_that_cannot_be_saved_is_told_of(part, desk, qtbot, tmp_path):
    with qtbot.waitSignal(desk.message) as told:
        part.save_as(tmp_path / "nowhere" / "mine.json")
    assert "cannot be written" in told.args[0]
    assert desk.workspace.preset_name == "default"


def test_the_header_tells_how_much_differs_and_opens_the_editor(qtbot, desk):
    folded = FoldedParameters(desk, GROUPS)
    qtbot.addWidget(folded)
    folded.show()
    header = folded.findChild(QToolButton, "parameters_header")
    assert header.text() == "Parameters — as in the preset"
    assert not folded.part.isVisible()
    for name, value in (("reconstruction.voxel_m", 0.003), ("collision.max_faces", 3000)):
        folded.part.editor.set_value(name, value)
    assert header.text() == "Parameters — 2 differ from preset"
    header.click()
    assert folded.part.isVisible()
    desk.workspace.undo_stack.undo()
    assert header.text() == "Parameters — 1 differs from preset"
