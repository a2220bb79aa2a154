"""Labels are read or refused with a sentence, and verdicts are summed up."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from core.errors import InputError
from core.evaluation.labels import LabelledObject, read_labels
from core.evaluation.scores import score
from core.evaluation.verdicts import ObjectVerdict, judging_key, mesh_mark
from core.parameters import Parameters, apply_settings


def folder_with(tmp_path: Path, text: str, name: str = "labels.csv") -> Path:
    (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def test_labels_and_meshes_are_found(tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "mug.stl").write_bytes(b"")
    (tmp_path / "block.obj").write_text("")
    folder = folder_with(
        tmp_path, "id,label,category\nmug,container,mug\nblock,non-container,\ngone,ambiguous,\n"
    )
    mug, block, gone = read_labels(folder)
    assert mug == LabelledObject("mug", "container", tmp_path / "meshes" / "mug.stl", "mug")
    assert block.mesh == tmp_path / "block.obj"
    assert gone.mesh == tmp_path / "meshes" / "gone.obj", "judging it will say that it is missing"


def test_the_shared_objects_are_read(shared_data: Path) -> None:
    objects = read_labels(shared_data / "objects")
    labels = [one.label for one in objects]
    assert (len(objects), labels.count("container"), labels.count("ambiguous")) == (45, 19, 4)
    assert all(one.mesh.is_file() for one in objects)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "name no object"),
        ("id,label\n", "name no object"),
        ("id,label\nmug,pot\n", "one of container, non-container, ambiguous"),
        ("id,label\n,container\n", "it needs an id"),
        ("name,kind\nmug,container\n", "it needs an id"),
        ("id,label\nmug,container\nmug,container\n", "'mug' twice"),
    ],
)
def test_labels_that_cannot_be_used(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        read_labels(folder_with(tmp_path, text))


def test_which_csv_holds_the_labels(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no labels"):
        read_labels(tmp_path)
    folder_with(tmp_path, "id,label\nmug,container\n", "a.csv")
    assert len(read_labels(tmp_path)) == 1
    folder_with(tmp_path, "x\n", "b.csv")
    with pytest.raises(InputError, match="several CSV files"):
        read_labels(tmp_path)
    folder_with(tmp_path, "id,label\nmug,container\npot,container\n", "labels.csv")
    assert len(read_labels(tmp_path)) == 2


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
    assert found.smallest_container == (0.05, "tray")
    assert found.largest_other == (0.3, "can")
    assert found.margin == pytest.approx(-0.25)
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
    assert by_capacity["lid"].omega == 0.4, "it is told beside"
    assert score(objects, by_omega, 0.125).n_right == 1
    found = score(objects, by_capacity, 0.125)
    assert (found.n_right, found.margin, found.largest_other) == (2, 0.75, (0.0, "lid"))


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
