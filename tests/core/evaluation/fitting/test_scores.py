"""The threshold's rule, the margin, and what is reported for each seed."""

import pytest

from core.evaluation.fitting.scores import CaseScore, FitScore, best_threshold, n_right


def score(containers, others, seed=0):
    kinds = [("c", True, containers), ("o", False, others)]
    return FitScore(
        tuple(
            CaseScore(f"{letter}{k}", is_container, seed, found)
            for letter, is_container, scores in kinds
            for k, found in enumerate(scores)
        )
    )


@pytest.mark.parametrize(
    ("containers", "others", "expected"),
    [
        ([0.4, 0.9], [0.0, 0.1], 0.25),
        ([0.3], [0.0], 0.15),
        ([0.5, 0.2, 0.6], [0.3, 0.0, 0.1], 0.4),  # one too low: the widest gap that judges five of six
        ([0.5, 0.6, 0.7], [0.9, 0.1, 0.2], 0.35),  # one too high
    ],
)
def test_the_threshold(containers, others, expected):
    assert best_threshold(containers, others) == pytest.approx(expected)


def test_no_threshold_judges_more_rightly():
    containers, others = [0.2, 0.31, 0.5, 0.52, 0.7], [0.0, 0.1, 0.3, 0.35, 0.6]
    best = max(n_right(containers, others, k / 1000) for k in range(1001))
    assert n_right(containers, others, best_threshold(containers, others)) == best


def test_near_scores_are_told_apart():
    low, high = 0.2, 0.2 + 1e-6
    assert low <= best_threshold([high], [low]) < high


def test_the_best_accuracy_counts_where_they_overlap():
    found = score([0.2, 0.5, 0.6, 0.7], [0.0, 0.1, 0.3])
    assert found.margin == pytest.approx(-0.1) and not found.is_separating
    assert found.accuracy() == pytest.approx(6 / 7)
    assert found.accuracy(0.65) == pytest.approx(4 / 7)


def test_equal_margins_are_told_apart_by_the_mean():
    near, far = score([0.4, 0.4], [0.0]), score([0.4, 0.9], [0.0])
    assert near.margin == far.margin
    assert far.rank > near.rank and far.objective > near.objective
    hopeless, empty = score([0.0, 0.3], [0.5]), score([0.0, 0.0], [0.5])
    assert hopeless.objective > empty.objective


def test_each_seed_has_its_own_margin():
    both = FitScore(score([0.5], [0.1], 0).scores + score([0.3], [0.2], 1).scores)
    assert both.margin == pytest.approx(0.1)
    table = both.to_table(0.25)
    assert [one["margin"] for one in table["by_seed"]] == pytest.approx([0.4, 0.1])
    assert table["by_seed"][1]["largest_other"] == [0.2, "o0"]
    assert table["accuracy"] == 1 and table["threshold"] == 0.25
