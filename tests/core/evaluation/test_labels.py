"""Labels and raw answers are read, or refused with a sentence."""

from pathlib import Path

import pytest

from core.errors import InputError
from core.evaluation.labels import Agreement, LabelledObject, read_labels


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
        ("id,label,capacity_ml\nmug,container,much\n", "'much', the capacity_ml of 'mug', is no volume"),
        ("id,label,capacity_ml\nmug,container,-3\n", "'-3', the capacity_ml of 'mug', is no volume"),
    ],
)
def test_labels_that_cannot_be_used(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        read_labels(folder_with(tmp_path, text))


def test_what_an_object_holds_may_be_known(tmp_path: Path) -> None:
    rows = "id,label,capacity_ml\nmug,container,312.5\npot,container,\n"
    mug, pot = read_labels(folder_with(tmp_path, rows))
    assert (mug.capacity_ml, pot.capacity_ml) == (312.5, None)


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


ANSWERS = "object,annotator,contains,pourable,calib\n"


def test_the_majority_of_raw_answers_decides(tmp_path: Path) -> None:
    rows = ["mug,a,1,yes,1", "mug,b,1,1,", "mug,c,0,1,", "lid,a,1,0,", "lid,b,true,n,", "lid,c,y,y,"]
    mug, lid = read_labels(folder_with(tmp_path, ANSWERS + "\n".join(rows)))
    assert (mug.label, mug.agreement, mug.is_calibration) == ("container", Agreement(2, 3), True)
    assert (lid.label, lid.agreement) == ("non-container", Agreement(1, 3)), "both must be said of it"


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ("mug,a,1,1,\nmug,a,0,1,", "'a' answers twice about 'mug'"),
        ("mug,a,1,1,\nmug,b,0,1,", "about 'mug' are split evenly"),
        ("mug,a,1,perhaps,", "'perhaps' in the column pourable is no answer"),
        ("mug,,1,1,", "lacks the object or the annotator"),
    ],
)
def test_answers_that_cannot_be_used(tmp_path: Path, rows: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        read_labels(folder_with(tmp_path, ANSWERS + rows))
