"""Labels are read or refused with a sentence, and verdicts are summed up."""

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


def test_the_key_follows_what_decides_omega() -> None:
    base = Parameters()
    key = judging_key(base)
    for same in ({"containability.omega_threshold": 0.3}, {"pouring.n_pour": 10}, {"evidence.films": False}):
        assert judging_key(apply_settings(base, same)) == key
    for other in (
        {"seed": 1},
        {"particle.diameter_m": 0.01},
        {"containability.contact.lateral_friction": 0.3},
    ):
        assert judging_key(apply_settings(base, other)) != key


def test_a_verdict_is_read_as_it_was_saved(tmp_path: Path) -> None:
    verdict = ObjectVerdict("mug", mesh_mark(tmp_path), 100, 30, 2.5)
    verdict.save(tmp_path / "mug.json")
    assert ObjectVerdict.load(tmp_path / "mug.json") == verdict
    assert verdict.omega == 0.3
    (tmp_path / "mug.json").write_text("{")
    assert ObjectVerdict.load(tmp_path / "mug.json") is None
    assert mesh_mark(tmp_path / "nowhere") == "missing"
