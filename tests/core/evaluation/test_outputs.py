"""The files beside the report."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import pytest

from core.errors import SessionError
from core.evaluation.outputs import write_outputs
from tests.core.evaluation.evaluations import (
    evaluation_of,
    large_evaluation,
    small_evaluation,
    trial,
    two_measures,
)

FIRST_COLUMNS = ["id", "label", "omega", "predicted", "p_chosen", "poured", "spilled", "seconds"]


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_the_objects_csv_is_a_contract(tmp_path: Path) -> None:
    assert write_outputs(small_evaluation(), tmp_path) == tmp_path / "report.html"
    rows = {row["id"]: row for row in rows_of(tmp_path / "objects.csv")}
    assert list(rows["mug"])[:8] == FIRST_COLUMNS
    assert [rows["bowl"][column] for column in FIRST_COLUMNS] == [
        *("bowl", "container", "0.6", "container", "0.98", "3", "2", "5.0"),
    ]
    assert [rows["bucket"][column] for column in FIRST_COLUMNS] == [
        *("bucket", "container", "", "", "", "0", "0", "5.0"),
    ]
    assert rows["bucket"]["problem"] == "The mesh cannot be read."
    assert (rows["mug"]["choice_i"], rows["mug"]["choice_j"], rows["can"]["choice_i"]) == ("2", "1", "")


def test_trials_csv_has_all_variants_and_objects_csv_the_first(tmp_path: Path) -> None:
    found = evaluation_of(
        trial("mug", "container", 80), trial("mug", "container", 80, variant="threshold-0", threshold=0.0)
    )
    write_outputs(found, tmp_path)
    assert [row["variant"] for row in rows_of(tmp_path / "objects.csv")] == ["imagination"]
    assert [row["variant"] for row in rows_of(tmp_path / "trials.csv")] == ["imagination", "threshold-0"]


def test_the_csv_tells_what_an_object_holds(tmp_path: Path) -> None:
    write_outputs(two_measures(), tmp_path)
    mug, tray, _, _, by_omega, *_ = rows_of(tmp_path / "trials.csv")
    columns = (
        "omega",
        "measure",
        "threshold",
        "capacity_share",
        "capacity_candies",
        "capacity_ml",
        "holds_rad",
    )
    assert [mug[column] for column in columns] == [
        *("0.0", "Capacity share", "0.1", "0.51", "183.6", "204.0", "0.733038"),
    ]
    assert [by_omega[column] for column in columns] == ["0.4", "Omega", "0.05", "", "", "", ""]
    assert (mug["clean_at_least"], mug["n_tries"], mug["predicted"]) == ("0.812", "48", "container")
    assert (tray["clean_at_least"], tray["n_tries"], tray["predicted"]) == ("", "0", "non-container")


def test_what_failed_was_judged_by_nothing(tmp_path: Path) -> None:
    write_outputs(small_evaluation(), tmp_path)
    (bucket,) = (row for row in rows_of(tmp_path / "objects.csv") if row["id"] == "bucket")
    assert bucket["measure"] == ""


def test_the_summary_names_the_measure(tmp_path: Path) -> None:
    write_outputs(two_measures(), tmp_path)
    found = json.loads((tmp_path / "summary.json").read_text())
    assert (found["measure"], found["threshold"]) == ("Capacity share", 0.1)
    assert found["margins"][0]["smallest_container"] == {"capacity_share": 0.08, "name": "tray"}
    assert found["margins"][0]["largest_other"] == {"capacity_share": 0.02, "name": "can"}
    by_omega = found["variants"]["omega"]
    assert by_omega["measure"] == by_omega["sets"]["all"]["measure"] == "Omega"
    assert by_omega["margins"][0]["largest_other"] == {"omega": 0.12, "name": "can"}


def test_the_summary_is_a_contract(tmp_path: Path) -> None:
    write_outputs(small_evaluation(), tmp_path)
    found = json.loads((tmp_path / "summary.json").read_text())
    assert (found["accuracy"], found["auc"], found["n"], found["seconds"]) == (0.7, 0.925, 10, 90.0)
    assert found["pour_success_rate"] == pytest.approx(8 / 15)
    assert found["confusion"] == {
        "true_positive": 3,
        "false_positive": 1,
        "true_negative": 4,
        "false_negative": 1,
        "failed": 1,
        "undecided": 0,
    }
    assert found["intervals"]["accuracy"] == pytest.approx([0.3968, 0.8922], abs=1e-4)
    (margin,) = found["margins"]
    assert margin["smallest_container"] == {"omega": 0.04, "name": "tray"} and margin["seed"] == 0
    assert [one["name"] for one in found["ambiguous"]] == ["tissue <box>"]
    assert [one["problem"] for one in found["failed"]] == ["The mesh cannot be read."]
    assert found["agreement"] is None
    assert set(found["sets"]) == {"all"} and set(found["variants"]) == {"imagination"}


def test_sets_and_agreement_in_the_summary(tmp_path: Path) -> None:
    write_outputs(large_evaluation(tmp_path, n_seeds=2, n_variants=2, with_pictures=False), tmp_path)
    found = json.loads((tmp_path / "summary.json").read_text())
    assert set(found["sets"]) == {"all", "restricted", "calibration", "other"}
    assert found["sets"]["all"]["accuracy"] == found["accuracy"]
    assert [one["seed"] for one in found["per_seed"]] == [0, 1]
    assert sum(one["n"] for one in found["per_seed"]) == found["n"] == 82
    assert sum(found["agreement"]["n_objects"].values()) == 45


def test_what_is_not_known_is_null(tmp_path: Path) -> None:
    write_outputs(evaluation_of(trial("box", "ambiguous", 0)), tmp_path)
    found = json.loads((tmp_path / "summary.json").read_text())
    assert (found["accuracy"], found["auc"], found["pour_success_rate"]) == (None, None, None)
    assert found["margins"] == [] and found["n"] == 0


def test_the_same_evaluation_gives_the_same_files(tmp_path: Path) -> None:
    folders = [tmp_path / name for name in "ab"]
    for folder in folders:
        folder.mkdir()
        write_outputs(small_evaluation(), folder)
    a, b = ({path.name: path.read_bytes() for path in folder.iterdir()} for folder in folders)
    assert a == b and set(a) == {"report.html", "tables.txt", "objects.csv", "trials.csv", "summary.json"}


def test_an_unfinished_evaluation_is_written_as_far_as_it_is(tmp_path: Path) -> None:
    found = small_evaluation()
    write_outputs(replace(found, trials=found.trials[:3]), tmp_path)
    assert len(rows_of(tmp_path / "objects.csv")) == 3
    assert "8 of 11 trials are not done yet" in (tmp_path / "report.html").read_text()
    write_outputs(replace(found, trials=()), tmp_path)
    assert "No labelled object was tried." in (tmp_path / "report.html").read_text()


def test_a_full_disk_is_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_text", full)
    with pytest.raises(SessionError, match="is full"):
        write_outputs(small_evaluation(), tmp_path)
    assert not list(tmp_path.iterdir())
