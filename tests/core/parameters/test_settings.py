import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.errors import InputError
from core.parameters import (
    PRESET_NAMES,
    Parameters,
    apply_settings,
    describe,
    difference,
    flatten,
    load_preset,
)


def test_presets_differ_from_the_default_only_where_their_file_says():
    for name in PRESET_NAMES:
        changed = difference(load_preset(name), Parameters())
        assert bool(changed) == (name != "default")


def test_paper_and_authors_hold_the_figures_of_text_and_code():
    paper, authors = load_preset("paper"), load_preset("authors")
    assert math.isclose(paper.pouring.gamma_0_rad, math.radians(62))
    assert math.isclose(authors.pouring.gamma_0_rad, math.radians(45 + 1.64), abs_tol=1e-3)
    assert math.isclose(paper.pouring.indent_step_ratio, 1 / 3)
    assert math.isclose(authors.pouring.indent_step_ratio, 1 / 9)
    assert (paper.pouring.counted, authors.pouring.counted) == ("inside", "above_floor")
    assert (paper.particle.shape, authors.particle.shape) == ("ellipsoid", "cylinder")
    assert paper.containability.n_max == authors.containability.n_max == 17**2


def test_the_schedule_lasts_the_papers_1500_steps():
    settings = load_preset("paper").containability
    seconds = settings.drop_s + 2 * settings.rotation_s + 4 * settings.translation_s
    assert round(seconds * 240) == 1500


def test_every_parameter_says_what_it_is():
    for fact in describe():
        assert fact.doc and fact.source, fact.name
        if isinstance(fact.default, int | float) and not isinstance(fact.default, bool):
            assert fact.low is not None and fact.high is not None, fact.name
            assert fact.low <= fact.default <= fact.high, fact.name


@pytest.mark.parametrize(
    ("wrong", "offered"),
    [
        ("containability.omega_treshold", "containability.omega_threshold"),
        ("omega_threshold", "containability.omega_threshold"),
        ("pouring.npour", "pouring.n_pour"),
        ("voxel", "reconstruction.voxel_m"),
    ],
)
def test_an_unknown_name_is_refused_with_the_nearest(wrong, offered):
    with pytest.raises(InputError, match=f"did you mean '{offered}'"):
        apply_settings(Parameters(), {wrong: "1"})


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("containability.omega_threshold", "1.5", "allowed is 0 to 1"),
        ("reconstruction.voxel_m", "-1", "allowed is 0.001 to 0.02 m"),
        ("pouring.counted", "maybe", "one of inside, above_floor"),
        ("pouring.n_pour", "many", "allowed is 1 to 1000"),
        ("seed", "NaN", "allowed is"),
        ("containability.n_min", "300", "n_min must not exceed n_max"),
        ("pouring.cup.slant_rad", "0.5", "narrows to a point"),
        ("reconstruction.crop_max_m", "[0, 0, 0]", "given both or not at all"),
    ],
)
def test_a_value_out_of_range_is_refused_with_the_range(name, value, said):
    with pytest.raises(InputError) as caught:
        apply_settings(Parameters(), {name: value})
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_crop_box_has_both_corners_and_volume():
    box = {"reconstruction.crop_min_m": "[0, 0, 0]", "reconstruction.crop_max_m": "[0.1, 0.1, 0.1]"}
    assert apply_settings(Parameters(), box).reconstruction.crop_max_m == (0.1, 0.1, 0.1)
    with pytest.raises(InputError, match="must exceed crop_min_m"):
        apply_settings(Parameters(), box | {"reconstruction.crop_max_m": "[0.1, 0.1, 0.001]"})


def test_text_and_values_set_the_same():
    from_text = apply_settings(Parameters(), {"pouring.n_pour": "30", "pouring.counted": "above_floor"})
    from_values = apply_settings(Parameters(), {"pouring.n_pour": 30, "pouring.counted": "above_floor"})
    assert from_text == from_values
    assert difference(from_text, Parameters())["pouring.n_pour"] == (60, 30)


@pytest.mark.parametrize("content", ["", "[]", "{}", '{"parameters": 3}', '{"parameters": {"sed": 1}}'])
def test_a_bad_preset_file_is_one_sentence(tmp_path, content):
    path = tmp_path / "mine.json"
    path.write_text(content)
    with pytest.raises(InputError):
        load_preset(str(path))


def test_an_unknown_preset_is_refused_with_the_nearest():
    with pytest.raises(InputError, match="did you mean 'authors'"):
        load_preset("author")


json_values = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner, max_size=2),
    max_leaves=5,
)


@given(name=st.sampled_from(sorted(flatten(Parameters()))), value=json_values)
def test_any_value_is_taken_or_refused_in_a_sentence(name, value):
    for given_value in (value, json.dumps(value)):
        try:
            parameters = apply_settings(Parameters(), {name: given_value})
        except InputError as error:
            assert str(error).endswith(".")
        else:
            assert apply_settings(Parameters(), flatten(parameters)) == parameters
