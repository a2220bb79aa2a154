"""Verdicts are kept, summed up, and known by what they depend on."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from core.evaluation.labels import LabelledObject
from core.evaluation.verdicts import ObjectVerdict, judging_key, mesh_mark, score
from core.parameters import Parameters, apply_settings


def test_a_score_counts_and_names_the_margin() -> None:
    objects = [
        LabelledObject(name, label, Path("x"))
        for name, label in (
            ("mug", "container"),
            ("tray", "container"),
            ("can", "non-container"),
            ("block", "non-container"),
            ("plate", "ambiguous"),
            ("broken", "container"),
            ("not yet", "container"),
        )
    ]
    kept = {"mug": 50, "tray": 5, "can": 30, "block": 0, "plate": 100}
    verdicts = {name: ObjectVerdict(name, "", 100, n_in, 1.0) for name, n_in in kept.items()}
    verdicts["broken"] = ObjectVerdict("broken", "", 0, 0, 1.0, "It is broken.")
    found = score(objects, verdicts, 0.1)
    assert (found.n_judged, found.n_right, found.n_failed) == (4, 2, 1)
    assert found.accuracy == 0.5
    assert found.ends.smallest_container == (0.05, "tray")
    assert found.ends.largest_other == (0.3, "can")
    assert found.ends.value == pytest.approx(-0.25)
    assert score(objects, verdicts, 0.0).n_right == 3
    assert score(objects, {}, 0.0).accuracy is None


def test_what_decides_is_counted() -> None:
    """A bowl that keeps few candies and a lid that keeps many: the capacity share tells them apart."""
    objects = [
        LabelledObject("bowl", "container", Path("x")),
        LabelledObject("lid", "non-container", Path("x")),
    ]
    by_omega = {
        "bowl": ObjectVerdict("bowl", "", 100, 20, 1.0),
        "lid": ObjectVerdict("lid", "", 100, 40, 1.0),
    }
    by_capacity = {
        "bowl": replace(by_omega["bowl"], capacity_share=0.75),
        "lid": replace(by_omega["lid"], capacity_share=0.0),
    }
    assert (by_omega["lid"].score, by_omega["lid"].measure) == (0.4, "Omega")
    assert (by_capacity["lid"].score, by_capacity["lid"].measure) == (0.0, "Capacity share")
    assert by_capacity["lid"].omega == 0.4, "it is kept beside it"
    assert score(objects, by_omega, 0.125).n_right == 1
    found = score(objects, by_capacity, 0.125)
    assert (found.n_right, found.ends.value, found.ends.largest_other) == (2, 0.75, (0.0, "lid"))


@pytest.mark.parametrize("verdict", ["omega", "capacity"])
def test_the_key_follows_what_decides(verdict: str) -> None:
    base = apply_settings(Parameters(), {"containability.verdict": verdict})
    key = judging_key(base)
    for same in (
        {"containability.omega_threshold": 0.3},
        {"containability.capacity_threshold": 0.3},
        {"holding.n_load": 7},
        {"pouring.n_pour": 10},
        {"evidence.films": False},
    ):
        assert judging_key(apply_settings(base, same)) == key
    for other in (
        {"seed": 1},
        {"particle.diameter_m": 0.01},
        {"containability.contact.lateral_friction": 0.3},
    ):
        assert judging_key(apply_settings(base, other)) != key
    fillings = judging_key(apply_settings(base, {"capacity.n_fillings": 9}))
    assert (fillings == key) == (verdict == "omega"), "what fills it decides where the filling does"


def test_each_measure_has_verdicts_of_its_own() -> None:
    keys = {
        judging_key(apply_settings(Parameters(), {"containability.verdict": verdict}))
        for verdict in ("omega", "capacity")
    }
    assert len(keys) == 2


def test_a_verdict_is_read_as_it_was_saved(tmp_path: Path) -> None:
    verdict = ObjectVerdict("mug", mesh_mark(tmp_path), 100, 30, 2.5)
    verdict.save(tmp_path / "mug.json")
    assert ObjectVerdict.load(tmp_path / "mug.json") == verdict
    assert verdict.omega == 0.3
    table = json.loads((tmp_path / "mug.json").read_text())
    del table["capacity_share"]
    (tmp_path / "mug.json").write_text(json.dumps(table))
    assert ObjectVerdict.load(tmp_path / "mug.json") == verdict, "written before there was a capacity"
    filled = replace(verdict, capacity_share=0.75)
    filled.save(tmp_path / "mug.json")
    assert ObjectVerdict.load(tmp_path / "mug.json") == filled
    (tmp_path / "mug.json").write_text("{")
    assert ObjectVerdict.load(tmp_path / "mug.json") is None
    assert mesh_mark(tmp_path / "nowhere") == "missing"
