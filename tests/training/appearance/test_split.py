"""What is held out is never learnt from."""

import numpy as np

from training.appearance.split import split

KNOWN = {
    "name": np.array(["cup-000", "cup-001", "bowl-000", "bowl-001", "old_bowl", "drill"]),
    "kind": np.array(["cup", "cup", "bowl", "bowl", "bowl", "tool"]),
    "is_held_out": np.array([False, True, False, True, False, False]),
}


def test_members_are_held_out_of_the_families_that_are_learnt_from():
    learnt, held_out = split(KNOWN, ())
    assert list(KNOWN["name"][held_out]) == ["cup-001", "bowl-001"]
    assert (learnt == ~held_out).all()


def test_of_a_kind_that_is_left_out_no_family_is_learnt_and_its_objects_are_held_out():
    learnt, held_out = split(KNOWN, ("bowl", "tool"))
    assert list(KNOWN["name"][held_out]) == ["old_bowl", "drill"]
    assert list(KNOWN["name"][learnt]) == ["cup-000"]
