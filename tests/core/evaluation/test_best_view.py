"""Judging by looks: from the best of all views, as the paper does, and what the others are worth."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from core.errors import InputError
from core.evaluation.best_view import from_best_views, view_accuracies
from core.evaluation.evaluation import Evaluation, write_trial
from core.evaluation.labels import Label
from core.evaluation.outputs import write_outputs
from core.evaluation.pages.cards import judged_sentence, poured_sentence
from core.evaluation.statistics import figures_of
from core.evaluation.tables import text_tables
from core.evaluation.trials import Trial, measure_of
from core.evaluation.variants import VARIANTS, variants_of
from tests.core.evaluation.evaluations import evaluation_of, trial


def looked(name: str, label: Label, *scores: float, **facts: object) -> Trial:
    """A trial by looks with these scores, the last view being the top-down one."""
    views = {f"frame-{k:06d}": score for k, score in enumerate(scores)}
    last = f"frame-{len(scores) - 1:06d}"
    values = {"view_scores": views, "view": last, "top_down": last, "threshold": 0.5, "variant": "appearance"}
    return trial(name, label, 0, n_drop=0, **values, **facts)


TRIALS = (
    looked("mug", "container", 0.9, 0.9, 0.2, spilled=(0, 0, 0), in_cup=(0, 0, 0)),
    looked("bowl", "container", 0.8, 0.4, 0.9, n_feasible=0),
    looked("can", "non-container", 0.3, 0.7, 0.1, spilled=(60, 60, 60), in_cup=(0, 0, 0)),
    looked("block", "non-container", 0.7, 0.1, 0.3),
)


def test_a_trial_is_judged_from_the_view_that_counts():
    mug = TRIALS[0]
    assert (mug.measure, mug.score, mug.is_right) == ("Appearance score", 0.2, False)
    assert replace(mug, view="frame-000000").is_right
    assert replace(mug, view="frame-000009").score is None, "a view that does not show it"
    assert measure_of(TRIALS) == "Appearance score"


def test_the_most_accurate_view_counts_and_of_several_the_one_with_the_largest_auc():
    found = view_accuracies(TRIALS)
    assert found.by_view == {"frame-000000": 0.75, "frame-000001": 0.5, "frame-000002": 0.75}
    assert found.best == "frame-000000", "AUC 1, against 0.75"
    assert found.top_down == 0.75
    assert found.mean == pytest.approx(2 / 3)
    assert {one.view for one in from_best_views(TRIALS)} == {"frame-000000"}
    ambiguous = looked("dish", "ambiguous", 0.1, 0.1, 0.1)
    assert view_accuracies([*TRIALS, ambiguous]).by_view == found.by_view


def test_a_view_that_does_not_show_an_object_has_not_judged_it():
    (first, *others) = TRIALS
    hidden = replace(first, view_scores={"frame-000001": 0.9, "frame-000002": 0.2})
    assert view_accuracies([hidden, *others]).by_view["frame-000000"] == 0.5


def test_physics_is_left_alone():
    by_physics = trial("mug", "container", 80)
    assert from_best_views([by_physics]) == (by_physics,)
    assert view_accuracies([by_physics]) is None


def saved(folder: Path, *trials: Trial) -> Evaluation:
    evaluation_of(*trials).save(folder)
    for one in trials:
        write_trial(folder, one, "key")
    return Evaluation.load(folder)


def test_an_evaluation_that_is_read_is_judged_from_the_best_view(tmp_path):
    found = saved(tmp_path, *TRIALS, *(replace(one, variant="imagination") for one in BY_PHYSICS))
    by_looks = figures_of(found, "appearance")
    assert by_looks.accuracy.count == 3 and by_looks.auc == 1.0
    assert (by_looks.pours.count, by_looks.pours.n) == (3, 6), "what the cup would touch counts as spilled"
    text = text_tables(found)
    assert "Judged by appearance score: appearance." in text
    assert "appearance: judged from the best of 3 views, frame-000000, chosen on these very objects" in text
    assert "appearance (paper)" in text and "appearance-3d (paper)" in text
    assert "82.61" in text and "91.30" in text, "the paper's own success of its pours"
    assert max(len(line) for line in text.splitlines()) <= 100
    report = write_outputs(found, tmp_path).read_text()
    assert "chosen on these very objects" in report


BY_PHYSICS = (trial("mug", "container", 80), trial("can", "non-container", 0))


def test_cards_say_what_was_seen():
    mug, bowl = from_best_views(TRIALS)[:2]
    assert judged_sentence(mug) == (
        "By looks from frame-000000: a score of 0.900 is more than the threshold of 0.5, so it was judged a "
        "container."
    )
    assert poured_sentence(bowl, 3) == "The cup would touch the object, which counts as spilled."


def test_without_images_nothing_is_judged_by_looks():
    with pytest.raises(InputError, match="'appearance' judges images, and meshes have none"):
        variants_of(["imagination", "appearance"], has_images=False)
    blind = variants_of(["all"], has_images=False)
    assert [one.name for one in blind] == [name for name, one in VARIANTS.items() if not one.by_looks]
    assert [one.name for one in variants_of(["all"])] == list(VARIANTS)
