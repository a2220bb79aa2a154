from __future__ import annotations

import pytest

from app.gui.views.parameter_editor.draft import Draft, kinds
from core.parameters import Parameters, describe, load_preset

LOW, HIGH = (-0.3, -0.5, 0.0), (0.1, -0.1, 0.3)


@pytest.fixture
def draft():
    return Draft(Parameters(), Parameters())


def test_every_parameter_has_a_kind():
    found = kinds()
    assert list(found) == [fact.name for fact in describe()]
    assert found["reconstruction.truncation_m"] == ("number", True)
    assert found["reconstruction.crop_min_m"] == ("point", True)
    assert found["reconstruction.refine_poses"] == ("yes_no", False)
    assert found["collision.method"] == ("choice", False)
    assert found["seed"] == ("integer", False)


def test_a_value_is_set_and_differs(draft):
    assert draft.set("reconstruction.voxel_m", 0.004)
    assert draft.parameters.reconstruction.voxel_m == 0.004
    assert draft.differs("reconstruction.voxel_m")
    assert not draft.set("reconstruction.voxel_m", 0.004)


def test_a_value_out_of_range_is_refused_in_the_shown_unit_and_nothing_is_lost(draft):
    draft.set("reconstruction.max_depth_m", 3.0)
    assert not draft.set("reconstruction.voxel_m", 0.5)
    assert draft.errors == {"reconstruction.voxel_m": "500 mm is not possible; allowed is 1 to 20 mm."}
    assert draft.value("reconstruction.voxel_m") == 0.002
    assert draft.value("reconstruction.max_depth_m") == 3.0


def test_what_fits_only_together_can_be_entered_one_after_the_other(draft):
    assert not draft.set("reconstruction.crop_min_m", LOW)
    assert "given both" in draft.errors["reconstruction.crop_min_m"]
    assert draft.set("reconstruction.crop_max_m", HIGH)
    assert draft.parameters.reconstruction.crop_min_m == LOW
    assert draft.parameters.reconstruction.crop_max_m == HIGH
    assert draft.errors == {}


def test_and_taken_back_one_after_the_other(draft):
    draft.set("reconstruction.crop_min_m", LOW)
    draft.set("reconstruction.crop_max_m", HIGH)
    assert not draft.set("reconstruction.crop_max_m", None)
    assert draft.set("reconstruction.crop_min_m", None)
    assert draft.parameters == Parameters()


def test_a_change_that_is_possible_alone_does_not_bring_back_what_was_refused(draft):
    assert not draft.set("containability.n_min", 400)
    assert draft.set("containability.n_max", 500)
    assert draft.value("containability.n_min") == 64


def test_entering_the_old_value_again_clears_the_refusal(draft):
    draft.set("containability.n_min", 400)
    assert not draft.set("containability.n_min", 64)
    assert draft.errors == {}
    assert draft.set("containability.n_max", 100)
    assert draft.value("containability.n_min") == 64


def test_loading_forgets_what_was_refused(draft):
    draft.set("containability.n_min", 400)
    paper = load_preset("paper")
    draft.load(paper, paper)
    assert draft.errors == {}
    assert draft.parameters == paper


def test_text_that_is_no_point_is_refused(draft):
    assert not draft.set("reconstruction.crop_min_m", "here and there")
    assert draft.errors["reconstruction.crop_min_m"]
    assert draft.value("reconstruction.crop_min_m") is None
