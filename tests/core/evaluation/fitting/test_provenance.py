"""A fitted preset is read by everybody who reads presets, and says where it comes from."""

import pytest

from core.errors import SessionError
from core.evaluation.fitting.provenance import Provenance, read_provenance, write_fitted_preset
from core.parameters import Parameters, apply_settings, flatten, load_preset

SCORE = {"margin": 0.25, "threshold": 0.125, "accuracy": 1.0, "by_seed": []}


def provenance(**facts):
    found = {
        "source": "scan",
        "preset": "default",
        "seeds": (0, 1),
        "objects": {"mug": "container", "block": "non-container"},
        "before": SCORE | {"margin": -0.1},
        "after": SCORE,
        "fitted": ({"name": "containability.rotation_rad", "before": 0.05, "after": 0.25, "tied": []},),
    }
    return Provenance(**found | facts)


def test_round_trip(tmp_path):
    path = tmp_path / "fit.json"
    wanted = {"containability.rotation_rad": 0.25, "containability.omega_threshold": 0.125, "seed": 5}
    parameters = apply_settings(Parameters(), wanted)
    made = provenance()
    write_fitted_preset(path, parameters, ["particle.diameter_m"], made)
    assert read_provenance(path) == made
    assert {"optuna", "poursight", "numpy"} <= set(made.versions)
    loaded = load_preset(str(path))
    assert loaded == parameters.model_copy(update={"seed": Parameters().seed}), "a seed belongs to a run"
    names = path.read_text()
    assert "particle.diameter_m" in names, "what was fitted is written even if it is as in the default"
    assert flatten(loaded)["containability.rotation_rad"] == 0.25


def test_the_sentence_tells_what_it_brought():
    said = provenance().sentence
    assert "to 2 objects (scan, 2 seeds)" in said
    assert "Omega margin 0.250 instead of -0.100" in said and "100.0 % right" in said
    assert "capacity share margin 0.250" in provenance(measure="Capacity share").sentence
    spills = {"n": 24, "before": 9.0, "after": 2.5}
    assert "24 measured spills: 2.5 candies off instead of 9.0" in provenance(spills=spills).sentence


def test_the_measure_is_kept_and_without_one_it_is_omega():
    table = provenance(measure="Capacity share").to_table()
    assert Provenance.from_table(table).measure == "Capacity share"
    del table["measure"]
    assert Provenance.from_table(table).measure == "Omega"


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"provenance": 3}', '{"provenance": {"seeds": [1]}}'])
def test_other_files_have_none(tmp_path, text):
    path = tmp_path / "preset.json"
    path.write_text(text)
    assert read_provenance(path) is None
    assert read_provenance(tmp_path / "gone.json") is None


def test_a_folder_that_is_none_is_a_sentence(tmp_path):
    with pytest.raises(SessionError, match="cannot be written"):
        write_fitted_preset(tmp_path / "gone" / "fit.json", Parameters(), (), provenance())
