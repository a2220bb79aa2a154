"""The Tune page with real objects: judged in a host process, kept on the disk, compared side by side."""

import csv

import pytest
from PySide6.QtWidgets import QLabel, QLineEdit, QPushButton

from app.gui.pages import saved_presets
from app.gui.pages.tuning.page import TuningPage
from app.gui.pages.tuning.score_cell import CELL_ROLE
from app.library import places
from app.operations.tuning_board import Board, csv_text, last_source, load_board
from core.errors import InputError
from core.evaluation.verdicts import ObjectVerdict, mesh_mark
from core.mesh_file import write_ply
from core.parameters import Parameters, apply_settings, load_preset
from hardware.simulation.objects import builtin_object

QUICK = {
    "containability.verdict": "omega",
    "containability.n_max": 64,
    "containability.n_min": 20,
    "solver.substeps": 4,
}
ROWS = "id,label,category\nmug,container,mug\nbottle,ambiguous,\nblock,non-container,\nlost,container,\n"


@pytest.fixture(autouse=True)
def own_folders(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "objects"
    (folder / "meshes").mkdir(parents=True)
    for name in ("mug", "block"):
        write_ply(folder / "meshes" / f"{name}.ply", builtin_object(name))
    write_ply(folder / "meshes" / "bottle.ply", builtin_object("bottle"))
    (folder / "labels.csv").write_text(ROWS)
    return folder


def shown(desk, qtbot, folder=None):
    page = TuningPage(desk)
    qtbot.addWidget(page)
    page.resize(1060, 640)
    page.show()
    if folder is not None:
        page.open(folder)
    qtbot.waitUntil(lambda: desk.background.is_idle)
    return page


def button(page, name):
    return page.findChild(QPushButton, name)


def run(page, qtbot, name="primary"):
    with qtbot.waitSignal(page.desk.jobs.finished):
        button(page, name).click()
    qtbot.waitUntil(lambda: page.desk.background.is_idle)


def cell(page, name, column):
    return page._view.objects._rows[name].data(column, CELL_ROLE)


def judged(folder, omegas, shares=None, **settings):
    """A board with made verdicts: `{name: n_in of 100}`, with capacity shares by these."""
    settings = {"containability.verdict": "omega" if shares is None else "capacity"} | settings
    return with_verdicts(load_board(folder), apply_settings(Parameters(), settings), omegas, shares or {})


def with_verdicts(board, parameters, omegas, shares):
    board, one = board.with_set(parameters)
    for each in board.objects:
        if each.name in omegas:
            facts = each.name, mesh_mark(each.mesh), 100, omegas[each.name], 1.0
            verdict = ObjectVerdict(*facts, capacity_share=shares.get(each.name))
            board = board.with_verdict(one.key, verdict)
    return board


def test_empty_it_says_what_will_be_here(desk, qtbot):
    page = shown(desk, qtbot)
    assert "Choose a folder of meshes" in page.findChild(QLabel, "tuning_hint").text()
    assert button(page, "primary").text() == "Choose objects"
    assert not button(page, "run_selected").isVisibleTo(page)


def test_a_folder_without_labels_is_a_sentence(desk, qtbot, tmp_path):
    with qtbot.waitSignal(desk.message) as told:
        shown(desk, qtbot, tmp_path)
    assert "holds no labels" in told.args[0]


@pytest.mark.system
def test_all_are_run_and_kept_for_the_next_start(desk, qtbot, folder):
    page = shown(desk, qtbot, folder)
    page._edit(apply_settings(Parameters(), QUICK))
    assert "a run adds Set A" in page.findChild(QLabel, "column_note").text()
    run(page, qtbot)
    assert cell(page, "mug", 1).is_right is True
    assert cell(page, "block", 1).score == 0
    assert cell(page, "bottle", 1).is_right is None
    assert cell(page, "lost", 1).word == "failed"
    assert "lost.obj" in page._view.objects._rows["lost"].toolTip(1)
    found = page._board.score(page._board.sets[0])
    assert (found.n_right, found.n_judged, found.n_failed) == (2, 2, 1)
    assert page._view.sets.rows[0].values[2] == "2 / 2, 100.0 %, 1 failed"
    assert "1 of 4 objects still to judge" in page.findChild(QLabel, "column_note").text()

    page._edit(apply_settings(page._draft[1], {"containability.omega_threshold": 0.99}))
    assert "a run adds Set B" in page.findChild(QLabel, "column_note").text()
    page._view.objects._rows["mug"].setSelected(True)
    run(page, qtbot, "run_selected")
    assert [one.name for one in page._board.sets] == ["Set A", "Set B"]
    assert cell(page, "block", 2).score == 0, "the threshold decides no score: what was judged holds"
    assert cell(page, "mug", 2).is_right is False and cell(page, "mug", 2).is_flipped

    again = shown(desk, qtbot)
    assert last_source() == folder
    assert [one.name for one in again._board.sets] == ["Set A", "Set B"]
    assert cell(again, "mug", 1) == cell(page, "mug", 1)
    assert again._draft[1] == page._board.sets[1].parameters


def test_a_changed_mesh_is_judged_anew(folder):
    board = judged(folder, {"mug": 50, "block": 0})
    one = board.sets[0]
    for verdict in board.of(one).values():
        board.verdicts_folder(one).mkdir(parents=True, exist_ok=True)
        verdict.save(board.verdicts_folder(one) / f"{verdict.name}.json")
    from app.operations.tuning_board import save_board

    save_board(board)
    assert set(load_board(folder).of(one)) == {"mug", "block"}
    write_ply(folder / "meshes" / "mug.ply", builtin_object("bowl"))
    assert set(load_board(folder).of(one)) == {"block"}


def test_a_set_brings_its_parameters_back_and_undo_takes_them_away(desk, qtbot, folder):
    page = shown(desk, qtbot, folder)
    page._show(judged(folder, {"mug": 50, "block": 60}, seed=5))
    assert page._view.sets.rows[0].needs_attention, "the margin is negative"
    page._view.sets.selectRow(0)
    assert page._side.editor.parameters.seed == 5
    desk.workspace.undo_stack.undo()
    assert page._draft[1] == Parameters()
    desk.workspace.undo_stack.redo()
    button(page, "remove_set").click()
    assert page._board.sets == ()


def test_the_table_is_exported(desk, qtbot, folder, tmp_path):
    page = shown(desk, qtbot, folder)
    page._show(judged(folder, {"mug": 50, "block": 60}))
    page.export(tmp_path / "table.csv")
    rows = list(csv.DictReader((tmp_path / "table.csv").open(encoding="utf-8")))
    assert rows[0] == {
        "id": "mug",
        "label": "container",
        "category": "mug",
        "Set A omega": "0.5",
        "Set A right": "1",
    }
    assert [row["Set A right"] for row in rows] == ["1", "", "0", ""]
    assert csv_text(Board(folder, page._board.objects)).splitlines()[0] == "id,label,category"


def both(folder):
    """Set A by capacity, set B by Omega: the block keeps many candies but holds little."""
    omegas = {"mug": 50, "block": 60}
    by_omega = apply_settings(Parameters(), {"containability.verdict": "omega"})
    return with_verdicts(judged(folder, omegas, {"mug": 0.625, "block": 0.03125}), by_omega, omegas, {})


def test_both_kinds_of_sets_are_kept_apart(desk, qtbot, folder):
    page = shown(desk, qtbot, folder)
    page._show(both(folder))
    heads = [page._view.objects.headerItem().text(column) for column in (1, 2)]
    assert heads == ["Set A\ncapacity share", "Set B\nOmega"]
    filled, dropped = cell(page, "block", 1), cell(page, "block", 2)
    assert (filled.score, filled.threshold, filled.is_right) == (0.03125, 0.1, True)
    assert (dropped.score, dropped.threshold, dropped.is_right) == (0.6, 0.13, False)
    assert dropped.is_flipped
    block = page._view.objects._rows["block"]
    assert "Hollow for 3.1 % of its bulk" in block.toolTip(1)
    assert "60 of 100 candies stayed; the threshold is 0.13" in block.toolTip(2)
    by_capacity, by_omega = page._view.sets.rows
    assert by_capacity.values[1:3] == ("Capacity share", "2 / 2, 100.0 %")
    assert by_capacity.values[3:5] == (0.59375, 0.1)
    assert by_omega.values[1:3] == ("Omega", "1 / 2, 50.0 %")
    page._edit(apply_settings(page._board.sets[1].parameters, {"containability.verdict": "capacity"}))
    assert "Same as Set A" in page.findChild(QLabel, "column_note").text()


def test_by_capacity_both_scores_are_exported(folder):
    rows = list(csv.DictReader(csv_text(both(folder)).splitlines()))
    assert list(rows[0])[3:] == [
        "Set A omega",
        "Set A capacity share",
        "Set A right",
        "Set B omega",
        "Set B right",
    ]
    block = next(row for row in rows if row["id"] == "block")
    assert list(block.values())[3:] == ["0.6", "0.03125", "1", "0.6", "0"]
    lost = next(row for row in rows if row["id"] == "lost")
    assert list(lost.values())[3:] == [""] * 5


@pytest.mark.parametrize("name", ["", "  ", "Paper", "default"])
def test_a_preset_needs_a_name_of_its_own(name):
    with pytest.raises(InputError, match="name"):
        places.preset_file(name)


def test_a_preset_is_saved_and_offered(desk, qtbot, folder):
    page = shown(desk, qtbot, folder)
    page._edit(apply_settings(Parameters(), {"containability.omega_threshold": 0.125}))
    page.findChild(QLineEdit, "preset_name").setText("Slick candies")
    button(page, "save_preset").click()
    path = places.presets_folder() / "slick-candies.json"
    assert str(path) in saved_presets.preset_names()
    assert load_preset(str(path)).containability.omega_threshold == 0.125
    assert page._draft[0] == str(path)
    with qtbot.waitSignal(desk.message) as told:
        page._side.save_wanted.emit("paper")
    assert "choose another name" in told.args[0]


def test_objects_have_pictures_and_names_that_people_use(desk, folder, qtbot):
    (folder / "labels.csv").write_text(
        "id,label,category\nmug,container,mug\nblock,non-container,wood block\n"
    )
    (folder / "meshes" / "block.ply").write_text("damaged")
    page = shown(desk, qtbot, folder)
    table = page._view.objects
    mug, block = table._rows["mug"], table._rows["block"]
    qtbot.waitUntil(lambda: not mug.icon(0).isNull())
    picture = mug.icon(0).pixmap(56, 42).toImage()
    assert len({picture.pixel(x, 21) for x in range(picture.width())}) > 5  # a shaded mug, no plain plate
    assert block.icon(0).isNull()  # judging it will say why
    assert (mug.text(0), block.text(0)) == ("Mug", "Block (wood block)")
    assert block.toolTip(0).splitlines()[0] == "block"  # the id of the file of labels
