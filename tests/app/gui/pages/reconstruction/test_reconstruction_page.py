import json
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtWidgets import QDoubleSpinBox, QLabel, QPushButton

from app.gui.pages.reconstruction.page import ReconstructionPage
from core.mesh_file import write_ply
from core.parameters import apply_settings
from core.session import Session


@pytest.fixture
def page(qtbot, desk):
    page = ReconstructionPage(desk)
    qtbot.addWidget(page)
    page.resize(1060, 640)
    page.show()
    return page


@pytest.fixture
def mug_page(page, desk, mug_session, qtbot):
    desk.workspace.open(mug_session)
    qtbot.waitUntil(lambda: page.model is not None)
    return page


def text(page, name):
    return page.findChild(QLabel, name).text()


def primary(page):
    return page.findChild(QPushButton, "primary")


def mode(page, key):
    return page.findChild(QPushButton, f"model_mode_{key}")


def number(page, name):
    return page.findChild(QDoubleSpinBox, name)


def change(desk, **settings):
    named = {name.replace("__", "."): value for name, value in settings.items()}
    desk.workspace.edit(apply_settings(desk.workspace.parameters, named), "change")


def test_without_a_scan_it_says_what_will_be_here_and_leads_there(page, desk, qtbot):
    assert "appears here" in text(page, "model_verdict")
    assert not primary(page).isEnabled()
    with qtbot.waitSignal(desk.page_wanted) as wanted:
        page.findChild(QPushButton, "model_empty_button").click()
    assert wanted.args == ["scan"]


def test_size_volume_and_pose_health_are_shown(mug_page):
    facts = {fact.title: fact.value for fact in mug_page.side.facts.facts}
    x, _, z = (float(word) for word in facts["Size in mm"].split(" × "))
    assert 80 < x < 110
    assert 90 < z < 105
    assert 100 < float(facts["Volume"].removesuffix(" ml")) < 200
    assert facts["Platform"] == "80.0 mm"
    assert text(mug_page, "model_verdict") == "Good scan"
    rows = mug_page.side.table.rows
    assert len(rows) == 24
    assert all(isinstance(value, float) for value in rows[0].values[1:])
    assert "Table seen at" in text(mug_page, "health_sentence")


def test_a_changed_parameter_makes_the_model_stale_until_it_is_undone(mug_page, desk):
    assert not primary(mug_page).isEnabled()
    change(desk, reconstruction__max_depth_m=5.0)
    assert primary(mug_page).isEnabled()
    assert mug_page.side.stale.text == "This is from before you changed “Max depth”: press Reconstruct."
    desk.workspace.undo_stack.undo()
    assert not primary(mug_page).isEnabled()
    assert mug_page.side.stale.text == ""


def test_a_model_is_read_once_not_at_every_edit(mug_page, desk):
    model = mug_page.model
    change(desk, reconstruction__max_depth_m=5.0)
    assert desk.background.is_idle
    assert mug_page.model is model


def test_the_modes_that_have_something_to_show_can_be_chosen(mug_page):
    enabled = [
        key
        for key in ("shape", "height", "coverage", "collision", "difference")
        if mode(mug_page, key).isEnabled()
    ]
    assert enabled == ["shape", "height", "coverage", "collision"]
    assert "reconstruct" in mode(mug_page, "difference").toolTip()
    mode(mug_page, "coverage").click()
    assert text(mug_page, "model_caption").startswith("In how many of 24 views")
    mode(mug_page, "collision").click()
    assert "faces" in text(mug_page, "model_caption")
    assert "collision" in mug_page.view.scene.layers()
    mode(mug_page, "height").click()
    assert "collision" not in mug_page.view.scene.layers()


def test_the_inside_of_an_opening_that_no_view_saw_is_shown(page, desk, mug_session, qtbot):
    arrays = dict(np.load(mug_session / "quality" / "quality.npz"))
    np.savez(mug_session / "quality" / "quality.npz", **arrays | {"frontier_m": np.full((5, 3), 0.1)})
    desk.workspace.open(mug_session)
    qtbot.waitUntil(lambda: page.model is not None)
    assert "hidden" not in page.view.scene.layers()
    mode(page, "coverage").click()
    assert "hidden" in page.view.scene.layers()


def test_the_crop_box_is_edited_in_numbers_and_by_its_handles(mug_page, desk):
    mug_page.findChild(QPushButton, "crop_toggle").click()
    assert "crop" in mug_page.view.scene.layers()
    assert number(mug_page, "crop_max_z").value() == 350
    number(mug_page, "crop_max_z").setValue(250)
    settings = desk.workspace.parameters.reconstruction
    assert settings.crop_max_m == pytest.approx((0.18, -0.15, 0.25))
    assert settings.crop_min_m == pytest.approx((-0.3, -0.55, 0.03))
    assert desk.workspace.undo_stack.undoText() == "crop box"
    mug_page.view.scene.box_edited.emit("crop", np.array([-0.2004, -0.5, 0.03]), np.array([0.1, -0.2, 0.3]))
    assert number(mug_page, "crop_min_x").value() == -200
    assert desk.workspace.parameters.reconstruction.crop_min_m == (-0.2, -0.5, 0.03)
    desk.workspace.undo_stack.undo()
    assert number(mug_page, "crop_min_x").value() == -300
    mug_page.findChild(QPushButton, "crop_reset").click()
    assert desk.workspace.parameters.reconstruction.crop_min_m is None
    assert number(mug_page, "crop_max_z").value() == 350


def test_a_crop_box_without_room_is_refused_in_a_sentence(mug_page, desk, qtbot):
    before = desk.workspace.parameters
    with qtbot.waitSignal(desk.message) as told:
        number(mug_page, "crop_max_z").setValue(20)
    assert "crop_max_m must exceed crop_min_m" in told.args[0]
    assert desk.workspace.parameters == before
    assert number(mug_page, "crop_max_z").value() == 350


def test_the_ruler_measures_the_mug(mug_page):
    mug_page.findChild(QPushButton, "ruler_toggle").click()
    heights = mug_page.model.centers_m[:, 2]
    for face in (int(heights.argmin()), int(heights.argmax())):
        mug_page.view.scene.picked.emit("object", face)
    assert mug_page.view.ruler.distance_m > 0.09
    assert text(mug_page, "model_caption").startswith("Ruler: ")
    mug_page.findChild(QPushButton, "ruler_toggle").click()
    assert not text(mug_page, "model_caption").startswith("Ruler")


def test_an_imported_mesh_says_what_it_lacks(page, desk, mug_session, tmp_path, qtbot):
    from core.mesh_file import read_ply

    mesh = read_ply(mug_session / "reconstruction" / "mesh.ply")
    with (
        Session.create_or_open(tmp_path / "mesh") as session,
        session.writing("mesh", inputs={}, parameters={}) as folder,
    ):
        write_ply(folder / "mesh.ply", mesh)
    desk.workspace.open(tmp_path / "mesh")
    qtbot.waitUntil(lambda: page.model is not None)
    assert text(page, "model_verdict") == "Imported mesh"
    assert "no pose health" in text(page, "model_reasons")
    assert not page.side.table.isVisible()
    assert not mode(page, "coverage").isEnabled()
    assert not page.findChild(QPushButton, "crop_toggle").isEnabled()
    assert primary(page).text() == "Build collision model"
    assert primary(page).isEnabled()


def test_a_damaged_model_is_explained_on_the_page(page, desk, mug_session, qtbot):
    (mug_session / "reconstruction" / "result.json").write_text("{")
    desk.workspace.open(mug_session)
    failed = page.findChild(QLabel, "model_failed")
    qtbot.waitUntil(failed.isVisible)
    assert "result.json" in failed.text()


def test_another_session_leaves_nothing_of_the_one_before(mug_page, desk, tmp_path):
    desk.workspace.open(tmp_path / "new")
    assert mug_page.model is None
    assert "object" not in mug_page.view.scene.layers()
    assert "appears here" in text(mug_page, "model_verdict")


@pytest.mark.parametrize(
    ("chosen", "then"), [("shape", "photo"), ("height", "height"), ("difference", "difference")]
)
def test_colours_that_come_last_take_the_place_of_the_bare_shape_only(mug_page, chosen, then):
    view, model = mug_page.view, mug_page.model
    n = len(model.mesh.vertices_m)
    bare, colored = (
        replace(model, body=replace(model.body, rgb=rgb)) for rgb in (None, np.ones((n, 3), "f4"))
    )
    view.show_model(bare, np.zeros(n))
    view.modes.choose(chosen)
    view.show_model(colored, np.zeros(n))
    assert view.modes.mode == then


@pytest.mark.system
def test_a_new_result_is_compared_with_the_last_one(mug_page, desk, qtbot):
    before = mug_page.model
    change(desk, reconstruction__voxel_m=0.006)
    primary(mug_page).click()
    assert not primary(mug_page).isEnabled()
    assert not desk.jobs.is_idle
    qtbot.waitUntil(lambda: mug_page.view.modes.mode == "difference")
    after = mug_page.model
    assert len(after.mesh.faces) < len(before.mesh.faces)
    facts = {fact.title: fact for fact in mug_page.side.facts.facts}
    assert facts["Faces"].before.replace("\u202f", "") == str(len(before.mesh.faces))
    mean_mm = float(facts["Difference"].value.split(" mm")[0])
    assert 0.05 < mean_mm < 3
    assert f"{mean_mm:.2f} mm on average" in text(mug_page, "model_caption")
    record = json.loads((desk.workspace.folder / "reconstruction" / "record.json").read_text())
    assert record["parameters"]["reconstruction.voxel_m"] == 0.006
