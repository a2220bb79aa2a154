"""A damaged evaluation is named with its file, its fault, and what makes it anew."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from core.errors import SessionError
from core.evaluation.evaluation import EVALUATION_FILE, Evaluation, kept_trial, trial_file, write_trial
from tests.core.evaluation.evaluations import small_evaluation

Damage = Callable[[dict[str, Any]], object]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    evaluation = small_evaluation()
    evaluation.save(tmp_path)
    for one in evaluation.trials:
        write_trial(tmp_path, one, "key")
    assert Evaluation.load(tmp_path) == evaluation
    return tmp_path


def change(path: Path, damage: Damage) -> None:
    table = json.loads(path.read_text())
    damage(table)
    path.write_text(json.dumps(table))


def refused(folder: Path) -> str:
    with pytest.raises(SessionError) as error:
        Evaluation.load(folder)
    said = str(error.value)
    assert said.endswith("; evaluate into the same folder again, which makes it anew.")
    assert len(said) <= 300 + len(str(folder)) and "\n" not in said
    return said


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (lambda table: table.pop("objects"), "objects: Field required"),
        (lambda table: table.update(variants=[]), "variants: "),
        (lambda table: table.update(seeds=[0, 0]), "seeds: one is there twice"),
        (lambda table: table.update(versions=["1"]), "versions: "),
        (lambda table: table["objects"][0].update(name="../../mug"), "objects.0.name: "),
        (lambda table: table["objects"][0].update(name="m" * 5000), "objects.0.name: "),
        (lambda table: table["objects"][1].update(label="pot"), "objects.1.label: "),
        (lambda table: table["objects"].append(table["objects"][0]), "objects: one is there twice"),
        (lambda table: table["objects"][0].update(n_container=2, n_asked=1), "n_container exceeds n_asked"),
    ],
)
def test_a_damaged_evaluation(folder: Path, damage: Damage, said: str) -> None:
    change(folder / EVALUATION_FILE, damage)
    sentence = refused(folder)
    assert f"{EVALUATION_FILE} is damaged (" in sentence and said in sentence


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (lambda trial: trial.update(threshold=None), "trial.threshold: "),
        (lambda trial: trial.update(n_in="80"), "trial.n_in: "),
        (lambda trial: trial.update(n_in=201), "n_in exceeds n_drop"),
        (lambda trial: trial.update(spilled=3), "trial.spilled: "),
        (lambda trial: trial.update(worlds=["bullet"]), "have not one length"),
        (lambda trial: trial.update(choice=[1]), "trial.choice"),
        (lambda trial: trial.update(seconds={"scan": "x" * 5000}), "trial.seconds.scan: "),
        (lambda trial: trial.update(name="bowl"), "holds another trial"),
    ],
)
def test_a_damaged_trial_is_no_missing_one(folder: Path, damage: Damage, said: str) -> None:
    """Left out in silence it would change every figure. Whoever evaluates again makes it anew."""
    path = trial_file(folder, "mug", 0, "imagination")
    change(path, lambda table: damage(table["trial"]))
    sentence = refused(folder)
    assert f"{path} is damaged (" in sentence and said in sentence
    assert kept_trial(path, "key") is None


def test_what_is_no_file_or_no_json_is_refused_and_what_is_not_there_yet_is_not(folder: Path) -> None:
    path = trial_file(folder, "mug", 0, "imagination")
    path.write_text("{")
    assert str(path) in refused(folder)
    path.unlink()
    assert len(Evaluation.load(folder).trials) == len(small_evaluation().trials) - 1
    path.mkdir()
    assert "no regular file" in refused(folder)
    (folder / EVALUATION_FILE).unlink()
    assert "No such file" in refused(folder)


def test_what_a_newer_version_adds_is_left_out(folder: Path) -> None:
    change(folder / EVALUATION_FILE, lambda table: table.update(of_tomorrow=1))
    change(trial_file(folder, "mug", 0, "imagination"), lambda table: table["trial"].update(of_tomorrow=1))
    assert Evaluation.load(folder) == small_evaluation()
