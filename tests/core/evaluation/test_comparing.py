"""Two evaluations side by side."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from core.errors import InputError
from core.evaluation.comparing import compare
from core.evaluation.evaluation import EvaluatedObject, Evaluation, trial_file, write_trial
from core.evaluation.pages.comparison import change_sentence, figure_rows, write_comparison
from tests.core.evaluation.evaluations import evaluation_of, small_evaluation, trial, two_measures


@pytest.fixture
def changed() -> Evaluation:
    """The small evaluation, but the tray is right, a ball is not, the vase spills and the bowl does not."""
    new = {
        "tray": trial("tray", "container", 20),
        "ball": trial("ball", "non-container", 30),
        "vase": trial("vase", "container", 60, spilled=(0, 1, 2), in_cup=(0, 0, 0)),
        "bowl": trial("bowl", "container", 120),
    }
    found = small_evaluation()
    return replace(
        found,
        trials=tuple(new.get(one.name, one) for one in found.trials),
        parameters={**found.parameters, "containability.omega_threshold": 0.07, "gone": 1},
        preset="mine",
    )


def test_objects_that_flipped(changed: Evaluation) -> None:
    (pair,) = compare(small_evaluation(), changed).variants
    changed_objects = {one.name: one.changes for one in pair.objects if one.changes}
    assert changed_objects == {
        "tray": ("judged better",),
        "ball": ("judged worse",),
        "vase": ("spilled more",),
        "bowl": ("spilled less",),
    }
    (vase,) = pair.changed("spilled more")
    assert (
        change_sentence(pair, vase, "spilled more")
        == "vase: clean 3 of 3, now 1 of 3; Omega 0.300, now 0.300"
    )


def test_figures_and_their_difference(changed: Evaluation) -> None:
    (pair,) = compare(small_evaluation(), changed).variants
    rows = {row.name: row for row in figure_rows(pair)}
    accuracy = rows["accuracy, %"]
    assert (accuracy.before, accuracy.after, accuracy.difference) == (
        *("70.00 (39.7–89.2)", "70.00 (39.7–89.2)", "same"),
    )
    # mug 3, bowl 3, vase 1, tray 3 of 15 against 8 of 15
    assert rows["pours without a spilled candy, %"].difference == "+13.33"
    # ball 0.15 is now the largest of the others, tray 0.1 the smallest container
    assert rows["margin of Omega"].after == "−0.050" and rows["margin of Omega"].difference == "+0.030"


def test_what_was_changed(changed: Evaluation) -> None:
    found = compare(small_evaluation(), changed)
    assert found.settings == (("preset", "default", "mine"),)
    threshold, gone = found.parameters
    assert threshold[0] == "containability.omega_threshold" and threshold[2] == "0.07"
    assert gone == ("gone", "not there", "1", "not in this version")


def test_figures_are_of_the_objects_that_both_have() -> None:
    before = evaluation_of(trial("mug", "container", 80), trial("pot", "container", 0))
    after = evaluation_of(trial("mug", "container", 80), trial("jar", "container", 0))
    found = compare(before, after)
    assert (found.only_before, found.only_after) == (("pot",), ("jar",))
    (pair,) = found.variants
    assert [one.accuracy.n for one in pair.figures] == [1, 1]


def test_several_seeds_are_summed_up() -> None:
    before = evaluation_of(*(trial("mug", "container", 80, seed=seed) for seed in range(4)))
    after = evaluation_of(*(trial("mug", "container", n, seed=seed) for seed, n in enumerate((80, 2))))
    (pair,) = compare(before, after).variants
    (mug,) = pair.changed("judged worse")
    assert (
        change_sentence(pair, mug, "judged worse") == "mug: right 4 of 4, now 1 of 2; Omega 0.400, now 0.205"
    )
    assert ("seeds", "0, 1, 2, 3", "0, 1") in compare(before, after).settings


def test_relabelled_objects_and_other_meshes_are_told(tmp_path: Path) -> None:
    trials = trial("mug", "container", 80), trial("mug", "non-container", 80)
    objects = (
        EvaluatedObject("mug", "container", sha256="a"),
        EvaluatedObject("mug", "non-container", sha256="b"),
    )
    before, after = (evaluation_of(t, objects=(one,)) for t, one in zip(trials, objects, strict=True))
    found = compare(before, after)
    assert found.relabelled == (("mug", "container", "non-container"),) and found.other_meshes == ("mug",)
    text = write_comparison(before, after, tmp_path / "c.html")
    assert (
        "Labelled differently: mug (container, now non-container)" in text and "Different mesh: mug" in text
    )


def test_variants_without_a_common_name_are_set_against_each_other() -> None:
    before = evaluation_of(trial("mug", "container", 80))
    after = evaluation_of(trial("mug", "container", 2, variant="convex-parts"))
    (pair,) = compare(before, after).variants
    assert (pair.before, pair.after) == ("imagination", "convex-parts") and pair.changed("judged worse")


def test_the_page_and_the_text(changed: Evaluation, tmp_path: Path) -> None:
    text = write_comparison(small_evaluation(), changed, tmp_path / "comparison.html")
    page = (tmp_path / "comparison.html").read_text()
    assert max(len(line) for line in text.splitlines()) <= 100
    for said in ("tray: right 0 of 1, now 1 of 1; Omega 0.040, now 0.100", "Spilled more often than before"):
        assert said in text and said in page
    assert "containability.omega_threshold" in page and "Each object before and after: Omega" in page
    assert page.count("(container): ") == 4, "four containers have an Omega in both"
    assert "on the diagonal nothing has changed" in page
    assert "tissue &lt;box&gt;" in page and "<script" not in page


def test_what_was_judged_by_another_measure_has_no_difference(tmp_path: Path) -> None:
    found = two_measures()
    by_omega = tuple(replace(one, variant="imagination") for one in found.of_variant("omega"))
    before = replace(found, trials=by_omega, variants=("imagination",))
    after = replace(found, trials=found.of_variant("imagination"), variants=("imagination",))
    (pair,) = compare(before, after).variants
    (tray,) = pair.changed("judged worse")
    said = "tray: right 1 of 1, now 0 of 1; Omega 0.100, now capacity share 0.080"
    assert change_sentence(pair, tray, "judged worse") == said
    rows = {row.name: row for row in figure_rows(pair)}
    margin, threshold = rows["margin of Omega, now of capacity share"], rows["threshold"]
    assert (margin.before, margin.after, margin.difference) == ("−0.020", "0.060", "")
    assert (threshold.before, threshold.after, threshold.difference) == ("0.050", "0.100", "")
    text = write_comparison(before, after, tmp_path / "c.html")
    page = (tmp_path / "c.html").read_text()
    assert said in text and ">Omega before<" in page and ">Capacity share after<" in page
    assert "nothing has changed" not in page, "no diagonal between measures"
    assert "Omega: the share of the candies" in page


def test_an_evaluation_of_an_older_version_is_compared(tmp_path: Path) -> None:
    """Its trials know of no capacity."""
    after = two_measures()
    before = replace(after, trials=after.of_variant("omega"), variants=("omega",))
    before.save(tmp_path)
    for one in before.trials:
        write_trial(tmp_path, one, "key")
        file = trial_file(tmp_path, one.name, one.seed, one.variant)
        table = json.loads(file.read_text())
        for name in ("capacity_share", "capacity_candies", "capacity_ml", "holds_rad"):
            del table["trial"][name]
        file.write_text(json.dumps(table))
    old = Evaluation.load(tmp_path)
    assert old == before
    (pair,) = compare(old, after).variants
    assert pair.after == "omega" and pair.figures[0] == pair.figures[1]
    assert pair.measures == ("Omega", "Omega")


def test_nothing_changed(tmp_path: Path) -> None:
    text = write_comparison(small_evaluation(), small_evaluation(), tmp_path / "same.html")
    assert text.startswith("Settings and parameters are the same.") and "No object flipped." in text
    assert "same" in text and "+" not in text


def test_nothing_in_common_is_refused(tmp_path: Path) -> None:
    one, other = (evaluation_of(trial(name, "container", 80)) for name in ("mug", "jar"))
    with pytest.raises(InputError, match="no object in common"):
        write_comparison(one, other, tmp_path / "c.html")


def test_another_ground_truth_simulation_is_a_change() -> None:
    usual = small_evaluation()
    rougher = replace(usual, truth={"object_error_m": 0.005})
    assert ("ground-truth simulation: object_error_m", "as usual", "0.005") in compare(
        usual, rougher
    ).settings
