"""`poursight objects make`."""

import csv
import json

from core.evaluation.labels import read_labels
from core.mesh_file import read_mesh
from core.progress import Reporter


def contents(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_an_evaluation_reads_what_was_made(tmp_path, poursight):
    code, out, _ = poursight("objects", "make", tmp_path / "made", "--n", 40, "--seed", 3)
    assert code == 0
    assert out.startswith("40 objects of ")
    labelled = read_labels(tmp_path / "made")
    assert len(labelled) == 40
    assert {one.label for one in labelled} == {"container", "non-container", "ambiguous"}
    assert len({one.category for one in labelled}) >= 20
    for one in labelled:
        assert one.notes.endswith(".")
        assert read_mesh(one.mesh, Reporter()).extents_m.max() < 0.5
    table = json.loads((tmp_path / "made" / "members.json").read_text())
    with (tmp_path / "made" / "labels.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["id"] for row in rows] == [one["id"] for one in table["members"]]
    assert [float(row["capacity_ml"]) for row in rows] == [one["capacity_ml"] for one in table["members"]]
    assert table["seed"] == 3


def test_the_same_command_writes_the_same_bytes(tmp_path, poursight):
    words = ["--families", "mug", "--families", "blob", "--n", 6, "--seed", 5]
    for name in ("one", "other"):
        assert poursight("objects", "make", tmp_path / name, *words)[0] == 0
    assert contents(tmp_path / "one") == contents(tmp_path / "other")
    assert len(contents(tmp_path / "one")) == 8


def test_a_half_has_its_own_families(tmp_path, poursight):
    for half in ("development", "judging"):
        assert poursight("objects", "make", tmp_path / half, "--half", half, "--n", 60)[0] == 0
    halves = [{one.category for one in read_labels(tmp_path / half)} for half in ("development", "judging")]
    assert not halves[0] & halves[1]


def test_what_cannot_be_made_is_said(tmp_path, refused):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes.txt").write_text("mine")
    assert "holds something already" in refused("objects", "make", tmp_path / "mine")
    assert (tmp_path / "mine" / "notes.txt").read_text() == "mine"
    assert "there is a file" in refused("objects", "make", tmp_path / "mine" / "notes.txt")
    assert "did you mean 'goblet'" in refused("objects", "make", tmp_path / "a", "--families", "gobblet")
    assert not (tmp_path / "a").exists()
