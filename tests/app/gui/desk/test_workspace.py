"""The open session: how its stages stand, what the next run will use, and undo."""

from __future__ import annotations

import pytest

from app.gui.desk.page_states import page_states
from core.errors import SessionError
from core.parameters import apply_settings
from core.pipeline.freshness import Freshness


def _words(workspace):
    return {key: state.word for key, state in page_states(workspace, None).items()}


def test_a_session_brings_its_parameters_and_is_fresh(desk, mug_session):
    desk.workspace.open(mug_session)
    assert desk.workspace.parameters.containability.n_max == 150
    assert _words(desk.workspace) == {
        "scan": "fresh",
        "reconstruction": "fresh",
        "imagination": "fresh",
        "pours": "fresh",
        "robot": "empty",
    }
    assert desk.workspace.is_container is True


def test_a_changed_parameter_makes_what_comes_after_stale_and_undo_makes_it_fresh(desk, mug_session):
    workspace = desk.workspace
    workspace.open(mug_session)
    workspace.edit(apply_settings(workspace.parameters, {"seed": 7}), "seed")
    assert workspace.stages["collision"] is Freshness.FRESH
    assert workspace.stages["containability"] is Freshness.STALE
    assert workspace.is_container is None
    workspace.edit(apply_settings(workspace.parameters, {"reconstruction.voxel_m": 0.005}), "voxel")
    assert _words(workspace)["reconstruction"] == "stale"
    assert workspace.undo_stack.undoText() == "voxel"
    workspace.undo_stack.undo()
    workspace.undo_stack.undo()
    assert set(_words(workspace).values()) == {"fresh", "empty"}


def test_a_preset_can_be_undone(desk, mug_session):
    workspace = desk.workspace
    workspace.open(mug_session)
    before = workspace.parameters
    workspace.choose_preset("paper")
    assert workspace.preset_name == "paper"
    workspace.undo_stack.undo()
    assert (workspace.preset_name, workspace.parameters) == ("default", before)


def test_what_is_no_session_is_refused_and_the_open_one_stays(desk, mug_session, tmp_path):
    desk.workspace.open(mug_session)
    other = tmp_path / "other"
    other.mkdir()
    (other / "letter.txt").write_text("dear")
    with pytest.raises(SessionError, match="no session"):
        desk.workspace.open(other)
    assert desk.workspace.folder == mug_session


def test_a_preset_file_that_has_gone_leaves_the_defaults_to_compare_with(desk, mug_session):
    path = mug_session / "parameters.json"
    path.write_text(path.read_text().replace('"default"', '"/nowhere/mine.json"'))
    desk.workspace.open(mug_session)
    assert desk.workspace.preset_name == "default"
    assert desk.workspace.parameters.containability.n_max == 150
