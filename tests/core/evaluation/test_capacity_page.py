"""The report where what an object holds is judged, not Omega."""

from dataclasses import replace
from math import radians
from pathlib import Path

import pytest

from core.evaluation.pages.cards import cards_of, judged_sentence, poured_sentence
from core.evaluation.pages.charts import histogram, roc_sentence
from core.evaluation.pages.report import report_page
from core.evaluation.statistics import Figures
from core.evaluation.tables import figures_of
from tests.core.evaluation.evaluations import N_POURS, evaluation_of, held, titles_of, trial, two_measures


def said(share: float, n_candies: float, ml: float, holds_rad: float, threshold: float = 0.1) -> str:
    facts = {"capacity_candies": n_candies, "capacity_ml": ml, "holds_rad": holds_rad, "threshold": threshold}
    sentence = judged_sentence(held("mug", "container", share, **facts))
    return sentence.replace("\N{NO-BREAK SPACE}", " ")


def test_the_sentence_of_a_container() -> None:
    assert said(0.508, 242.4, 263.7, radians(42)) == (
        "It holds 242 candies (264 ml) level with its rim; all that stays is 51 % of its convex hull, more "
        "than the threshold of 10 %; nothing falls out up to a tilt of 42 degrees."
    )


@pytest.mark.parametrize(
    ("facts", "start"),
    [
        (
            (0.02, 8.0, 9.1, radians(6)),
            "It holds 8 candies (9 ml) level with its rim; all that stays is 2 % of its convex hull, not",
        ),
        ((0.01, 1.2, 1.0, radians(6)), "It holds 1 candy (1 ml)"),
        (
            (0.0, 0.0, 0.0, 0.0),
            "It holds no candy, 0 % of its convex hull, not more than the threshold of 10",
        ),
        (
            (0.18, 0.0, 0.0, 0.0),
            "No candy lies below its rim; all that stays is 18 % of its convex hull, more",
        ),
        ((0.001, 0.4, 0.4, 0.0), "It holds less than one candy, 0 % of"),
    ],
)
def test_the_sentence_of_others(facts: tuple[float, float, float, float], start: str) -> None:
    assert said(*facts).startswith(start)


def test_a_share_alone_is_told_too() -> None:
    sentence = judged_sentence(held("mug", "container", 0.5, capacity_candies=None, capacity_ml=None))
    assert sentence.startswith("It holds 50\N{NO-BREAK SPACE}% of its convex hull, more than")


def test_strength_is_told_of_what_is_held() -> None:
    assert said(0.2, 60.0, 80.0, 0.0).endswith("of 10 %; something falls out at the slightest tilt.")
    assert said(0.0, 0.0, 0.0, 0.0).endswith("the threshold of 10 %.")


@pytest.mark.parametrize(
    ("share", "threshold", "texts"),
    [
        (0.508, 0.1, "51 % of its convex hull, more than the threshold of 10 %"),
        (0.1004, 0.1, "10.04 % of its convex hull, more than the threshold of 10 %"),
        (0.0996, 0.1, "9.96 % of its convex hull, not more than the threshold of 10 %"),
        (0.1251, 0.125, "13 % of its convex hull, more than the threshold of 12.5 %"),
        (0.1, 0.1, "10 % of its convex hull, not more than the threshold of 10 %"),
    ],
)
def test_the_texts_tell_on_which_side_of_the_threshold_it_lies(
    share: float, threshold: float, texts: str
) -> None:
    assert texts in said(share, 9.0, 9.0, 0.0, threshold)


def test_a_card_says_how_sure_the_pour_is() -> None:
    mug = two_measures().trials[0]
    sentence = poured_sentence(mug, N_POURS).replace("\N{NO-BREAK SPACE}", " ")
    assert "(imagined: 98 % land inside; at least 81 % of such pours spill nothing)" in sentence


def test_the_page_never_says_omega_of_a_capacity(tmp_path: Path) -> None:
    page = report_page(two_measures(), tmp_path)
    parts = page.partition("What went wrong")[2].partition("<h2>Omega of containers and of others</h2>")[0]
    table, _, shown = parts.partition("<h3>Pictures</h3>")
    assert "Omega &gt; Omega_thr" in table, "the row of the paper's verdict"
    assert "Omega" not in shown
    for words in (
        "Histogram of capacity share by label",
        "Capacity share of containers and of others",
        "smallest capacity share of a container",
        "square root of the capacity share",
        "<span>Capacity share ● threshold ┆</span>",
    ):
        assert words in shown, words
    assert "Capacity share as the score" in page
    assert "capacity share &gt; 0.1" in page and "Omega &gt; 0.05" in page


def test_an_overlap_is_told_in_the_measure(tmp_path: Path) -> None:
    page = report_page(
        evaluation_of(held("mug", "container", 0.2), held("can", "non-container", 0.3)), tmp_path
    )
    assert "Containers and others overlap in capacity share" in page


def test_cards_are_sorted_and_marked_by_the_capacity(tmp_path: Path) -> None:
    found = evaluation_of(
        held("close", "container", 0.11, seed=0, n_in=200),
        held("close", "container", 0.5, seed=1, n_in=10),
        held("sure", "container", 0.4, seed=0, n_in=50),
        trial("broken", "container", None),
    )
    cards = cards_of(found, "imagination", tmp_path)
    assert [(card.name, card.state) for card in cards] == [
        *(("broken", "failed"), ("close", "right"), ("sure", "right")),
    ]
    close = cards[1]
    assert (close.mark, close.marks) == (33.2, [70.7])
    assert close.threshold == 31.6 and "shown: seed 0, the worst" in close.seeds


def test_charts_are_of_the_capacity() -> None:
    found = figures_of(two_measures(), "imagination")
    chart = histogram(found)
    bars = [title.partition(" with capacity share from ")[::2] for title in titles_of(chart)]
    assert [what for what, _ in bars] == ["1 container", "1 container", "1 non-container"]
    ranges = [[float(bound) for bound in found.split(" to ")] for _, found in bars]
    assert all(low <= share < high for share, (low, high) in zip((0.08, 0.51, 0.02), ranges, strict=True))
    assert "threshold 0.1" in chart and chart.count("1 at exactly 0") == 1
    assert "50.0 % of the containers and 0.0 % of the others" in roc_sentence(found)


def test_the_other_measure_has_charts_of_its_own(tmp_path: Path) -> None:
    page = report_page(two_measures(), tmp_path)
    both = [
        page.index(f"{measure} of containers and of others</h2>") for measure in ("Capacity share", "Omega")
    ]
    assert both == sorted(both)
    assert page.count("Judgements by label") == 2
    one = replace(two_measures(), variants=("imagination",))
    assert "Omega of containers and of others" not in report_page(one, tmp_path)


def test_where_nothing_of_a_label_could_be_told_the_report_is_made_all_the_same(tmp_path: Path) -> None:
    trials = [
        held("mug", "container", 0.6),
        held("vase", "container", 0.02, unseen_ml=300.0),
        held("teapot", "non-container", 0.04, unseen_ml=1000.0),
    ]
    found = Figures.of(trials, N_POURS)
    assert "50.0 % of the containers and 0.0 % of the others" in roc_sentence(found)
    assert "cannot tell" in report_page(evaluation_of(*trials), tmp_path).lower()
