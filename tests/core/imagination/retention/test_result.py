import json
from math import degrees, inf, radians, tan

import numpy as np
import pytest

from core.imagination.retention.result import Retention, equivalent_m_s2, retention_sentence

TILTS = np.radians([0.0, 10.0, 20.0, 30.0])
DIRECTIONS = np.arange(8) * np.pi / 4


def holding_of(*rows, n_asked=20, n_load=20):
    """The first directions lose as the rows say, the others nothing."""
    n_left = np.full((8, 4), n_load)
    for direction, row in enumerate(rows):
        n_left[direction] = row
    return Retention(n_asked, n_load, TILTS, DIRECTIONS, n_left)


def test_first_tenth_and_half_are_those_of_the_worst_direction():
    holding = holding_of([20, 20, 19, 9], [20, 20, 18, 18])
    assert degrees(holding.first_rad) == pytest.approx(20)
    assert degrees(holding.holds_rad) == pytest.approx(10)
    assert degrees(holding.tenth_rad) == pytest.approx(20)
    assert np.degrees(holding.tenth_by_direction_rad[:3]) == pytest.approx([30, 20, inf])
    assert degrees(holding.half_rad) == pytest.approx(30)
    assert holding.half_m_s2 == pytest.approx(9.81 * tan(radians(30)))


def test_curves_and_shares_at_a_tilt():
    holding = holding_of([20, 20, 10, 0], n_asked=40)
    assert holding.mean_share_left == pytest.approx([1, 1, 15 / 16, 7 / 8])
    assert holding.share_at(radians(20))[0] == 0.5
    assert holding.share_at(radians(12))[0] == 0.5  # the next step that reaches it
    assert holding.kept_of_asked_at(radians(20))[0] == 0.25
    with pytest.raises(ValueError, match="only"):
        holding.share_at(radians(31))


def test_a_tenth_of_a_few_is_one():
    holding = holding_of([3, 3, 2, 2], n_load=3)
    assert degrees(holding.tenth_rad) == pytest.approx(20)
    assert holding.half_rad == inf


def test_an_object_without_a_load_holds_nothing():
    holding = Retention(20, 0, TILTS, DIRECTIONS, np.zeros((8, 4), dtype=np.int64))
    assert (holding.first_rad, holding.half_rad) == (0, 0)
    assert holding.share_left.max() == 0
    assert retention_sentence(holding) == "Holds nothing: of 20 candies poured onto it none stays."


def test_no_acceleration_is_as_strong_as_lying_on_the_side():
    assert equivalent_m_s2(np.pi / 2) == inf
    assert equivalent_m_s2(inf) == inf
    assert equivalent_m_s2(radians(45)) == pytest.approx(9.81)


@pytest.mark.parametrize(
    ("rows", "n_load", "sentence"),
    [
        (
            [[20, 20, 19, 9]],
            20,
            "Holds up to 10 degrees: then the first of 20 candies leaves; half are gone at 30 degrees.",
        ),
        (
            [[20, 20, 20, 19]],
            20,
            "Holds up to 20 degrees: then the first of 20 candies leaves; "
            "more than half stay up to 30 degrees.",
        ),
        (
            [[20, 4, 0, 0]],
            20,
            "Holds up to 0 degrees: then the first of 20 candies leaves, and at once half of them.",
        ),
        ([], 20, "Nothing falls out, even tilted 30 degrees."),
        ([[1, 1, 0, 0]], 1, "Holds up to 10 degrees: then the only candy leaves."),
    ],
)
def test_the_sentence_says_what_a_person_asks(rows, n_load, sentence):
    assert retention_sentence(holding_of(*rows, n_load=n_load)) == sentence


def test_saved_and_loaded_it_is_the_same(tmp_path):
    holding = holding_of([20, 20, 19, 9], n_asked=24)
    holding.save(tmp_path)
    read = Retention.load(tmp_path)
    assert (read.n_asked, read.n_load) == (24, 20)
    for name in ("tilt_rad", "direction_rad", "n_left"):
        assert np.array_equal(getattr(read, name), getattr(holding, name))
    table = json.loads((tmp_path / "holding.json").read_text())
    assert table["half_rad"] == pytest.approx(radians(30))
    assert table["n_load"] == 20


def test_what_never_left_is_null_in_json(tmp_path):
    holding_of().save(tmp_path)
    table = json.loads((tmp_path / "holding.json").read_text())
    assert table["first_rad"] is None
    assert table["half_m_s2"] is None
