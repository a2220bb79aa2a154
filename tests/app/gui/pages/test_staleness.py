import json

import pytest

from app.gui.pages.staleness import StaleNote, changed_since
from core.parameters import apply_settings

STAGES = ("reconstruction", "collision", "containability")


@pytest.fixture
def note(qtbot):
    note = StaleNote(STAGES)
    qtbot.addWidget(note)
    return note


@pytest.fixture
def workspace(desk, mug_session):
    desk.workspace.open(mug_session)
    return desk.workspace


def change(workspace, **settings):
    named = {name.replace("__", "."): value for name, value in settings.items()}
    workspace.edit(apply_settings(workspace.parameters, named), "change")


def test_nothing_is_said_while_the_result_is_what_the_parameters_give(workspace, note):
    note.look(workspace, "Imagine")
    assert note.text == ""
    assert changed_since(workspace, STAGES) == []


def test_the_changed_parameters_are_named(workspace, note):
    change(workspace, containability__drop_s=1.0)
    note.look(workspace, "Imagine")
    assert note.text == "This is from before you changed “Drop”: press Imagine."


def test_settings_that_a_record_holds_without_their_group_are_found(workspace):
    change(workspace, collision__aabb_margin_m=0.001, reconstruction__max_depth_m=5.0, seed=4)
    assert changed_since(workspace, STAGES) == [
        "reconstruction.max_depth_m",
        "seed",
        "collision.aabb_margin_m",
    ]


def test_of_many_changes_two_are_named(workspace, note):
    change(workspace, seed=4, containability__drop_s=1.0, containability__n_max=80, particle__mass_kg=0.001)
    note.look(workspace, "Imagine")
    assert "and 2 more: press Imagine." in note.text


def test_what_does_not_concern_the_result_is_not_named(workspace, note):
    change(workspace, evidence__films=False)
    note.look(workspace, "Imagine")
    assert note.text == ""


def test_a_result_of_an_earlier_scan_says_so(workspace, note, mug_session):
    path = mug_session / "scan" / "record.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"digest": "another"}))
    workspace.refresh()
    note.look(workspace, "Imagine")
    assert note.text == "This is from an earlier scan or model: press Imagine."
