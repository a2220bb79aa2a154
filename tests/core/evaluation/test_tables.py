"""The paper's tables, with its own figures in them, and their text."""

from dataclasses import replace
from pathlib import Path

import pytest

from core.evaluation.statistics import Share
from core.evaluation.tables import (
    classification,
    paper_rows,
    percent,
    pouring,
    table_rows,
    text_tables,
    title_of,
    world_rows,
)
from core.evaluation.trials import Trial
from core.evaluation.variants import variants_of
from core.parameters import Parameters
from tests.core.evaluation.evaluations import (
    evaluation_of,
    large_evaluation,
    small_evaluation,
    trial,
    two_measures,
)


def test_the_papers_rows_are_the_papers() -> None:
    judged = [row.accuracy for row in classification(paper_rows())]
    accuracies = [percent(share.value) for share in judged if share is not None]
    assert accuracies == ["100.00", "100.00", "96.15"]
    rates = [f"{100 * (row.pours.value or 0):.2f}" for row in pouring(paper_rows())]
    assert rates == ["82.61", "91.30", "100.00", "100.00", "94.55", "98.18"]


def test_our_rows_count_as_the_paper_does() -> None:
    containers = [trial(f"c{k}", "container", 80) for k in range(54)]
    spilled = trial("vase", "container", 80, spilled=(0,), in_cup=(0,))
    one_pour = [Trial(**{**one.__dict__, "spilled": (0,), "in_cup": (0,)}) for one in containers]
    found = evaluation_of(*one_pour, Trial(**{**spilled.__dict__, "spilled": (4,)}), n_pours=1)
    (row,) = pouring(table_rows(found))
    assert (row.pours, row.clean_objects, row.n_containers) == (Share(54, 55), Share(54, 55), 55)
    assert "98.18 (90.4–99.7)" in text_tables(found)


def test_an_ambiguous_object_of_which_it_cannot_be_told_counts_nowhere() -> None:
    vase, shoe = (
        replace(trial(name, label, 80), unseen_ml=200.0)
        for name, label in (("vase", "container"), ("shoe", "ambiguous"))
    )
    lines = text_tables(evaluation_of(vase, shoe)).splitlines()
    told = [line.split(")", 1)[1] for line in lines if line.startswith("Cannot tell (")]
    assert told == [", counted as not right: vase.", ", ambiguous, not counted: shoe."]


def test_pours_are_counted_by_ground_truth_world() -> None:
    worlds = ("bullet", "mujoco", "peanuts")
    clean = trial("mug", "container", 80, worlds=worlds, spilled=(0, 0, 0), in_cup=(0, 0, 0))
    spilled = trial("tray", "container", 80, worlds=worlds, spilled=(0, 2, 0), in_cup=(0, 0, 0))
    found = evaluation_of(clean, spilled, worlds=worlds)
    assert [(world, pours) for _, world, pours in world_rows(found)] == [
        ("bullet", Share(2, 2)),
        ("mujoco", Share(1, 2)),
        ("peanuts", Share(2, 2)),
    ]
    lines = text_tables(found).splitlines()
    assert any("mujoco" in line and "50.00" in line for line in lines)
    assert world_rows(evaluation_of(replace(clean, worlds=("bullet",) * 3))) == []


def test_each_set_has_a_row_for_each_variant(tmp_path: Path) -> None:
    found = large_evaluation(tmp_path, n_seeds=1, n_variants=2, with_pictures=False)
    rows = [(row.dataset, row.variant) for row in table_rows(found)]
    sets = ("all", "restricted", "calibration", "other")
    assert rows == [(one, variant) for one in sets for variant in ("imagination", "fixed-theta")]
    n = {row.dataset: row.n_objects for row in table_rows(found)}
    assert (n["all"], n["calibration"] + n["other"]) == (41, 41)


def test_the_text_fits_a_terminal_and_says_what_failed(tmp_path: Path) -> None:
    for found in (
        small_evaluation(),
        large_evaluation(tmp_path, n_seeds=2, with_pictures=False),
        evaluation_of(*(trial(f"{'long_' * 9}{k}", "container", 80 * k) for k in range(2))),
    ):
        assert max(len(line) for line in text_tables(found).splitlines()) <= 100
    text = text_tables(small_evaluation())
    assert "bucket (seed 0, imagination): The mesh cannot be read." in text
    assert "smallest Omega of a container 0.040 (tray)" in text and "margin −0.080" in text
    assert "70.00 (39.7–89.2)" in text


def test_each_row_says_what_makes_a_container() -> None:
    rows = classification([*table_rows(two_measures()), *paper_rows()])
    assert [row.rule for row in rows] == [
        *("capacity share > 0.1", "Omega > 0.05"),
        *("", "Omega > 0", "Omega > 0"),
    ]
    text = text_tables(two_measures())
    assert "Judged by capacity share: imagination.\nJudged by Omega: omega, the paper's.\n" in text
    assert "smallest capacity share of a container 0.080 (tray), largest of a non-container 0.020" in text
    assert "smallest Omega" not in text
    assert "Judged by Omega: imagination, the paper's." in text_tables(small_evaluation())


def test_the_verdicts_are_rows_of_their_own() -> None:
    judged = {one.name: one.of(Parameters()).containability for one in variants_of(["all"])}
    assert {name for name, one in judged.items() if one.verdict == "omega"} == {
        "paper", "authors", "omega", "threshold-0"
    }  # fmt: skip
    assert judged["omega"] == Parameters().containability.model_copy(update={"verdict": "omega"})
    assert judged["threshold-0"].omega_threshold == 0 < judged["omega"].omega_threshold
    assert title_of("omega") == "Imagination, Omega > Omega_thr (tuned)"


def test_nothing_but_ambiguous_objects() -> None:
    text = text_tables(evaluation_of(trial("box", "ambiguous", 9)))
    assert "imagination          all" in text and "–" in text


@pytest.mark.parametrize(("name", "title"), [("imagination", "Imagination"), ("of another version",) * 2])
def test_titles(name: str, title: str) -> None:
    assert title_of(name) == title
