"""The report of an evaluation: complete, in order, and in one file."""

from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest

from core.evaluation.evaluation import PICTURES_FOLDER, Evaluation
from core.evaluation.outputs import write_outputs
from core.evaluation.pages.card_words import judged_sentence, poured_sentence
from core.evaluation.pages.cards import cards_of
from core.evaluation.pages.charts import Histogram, histogram, place, roc_curve, scatter
from core.evaluation.pages.report import report_page
from core.evaluation.statistics import Figures
from tests.core.evaluation.evaluations import (
    N_POURS,
    draw_picture,
    evaluation_of,
    large_evaluation,
    small_evaluation,
    trial,
)

VOID = {"meta", "img", "br"}


class Page(HTMLParser):
    """Collects text, addresses and what a screen reader says, and checks that the tags close in order."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.addresses: list[str] = []
        self.names: list[str] = []
        self.tags: list[str] = []
        self.text = ""
        self.feed(html)
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = dict(attrs)
        self.tags.append(tag)
        self.addresses += [value or "" for name, value in attrs if name in ("src", "srcset", "href")]
        if tag in ("img", "svg"):
            self.names.append(found.get("alt") or found.get("aria-label") or "")
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open[-1:] != ["style"]:
            self.text = f"{self.text} {' '.join(data.split())}".rstrip()


def page_of(evaluation: Evaluation, folder: Path) -> Page:
    return Page(report_page(evaluation, folder))


def test_figures_first_then_failures_then_the_rest(tmp_path: Path) -> None:
    text = page_of(small_evaluation(), tmp_path).text
    order = (
        "11 objects, scanned, one seed",
        "7 of 10 judgements agree with the labels (70.00 %)",
        "Containers and others overlap in Omega",
        "Table I",
        "Omega > 0.05",
        "96.15",
        "Table II",
        "98.18",
        "Poured into, though no containers",
        "What went wrong",
        "24 of 200 candies stayed: Omega 0.120 is more than the threshold of 0.05",
        "8 of 200 candies stayed",
        "Poured 3 times: 0, 2 and 0 of 60 candies spilled (imagined: 98 % land inside). 1 stayed in the cup.",
        "Failed: The mesh cannot be read.",
        "Omega of containers and of others",
        "What was judged what",
        "Judged right, and nothing spilled",
        "vase",
        "Ambiguous objects",
        "tissue <box>",
        "Parameters",
        "All are the default ones.",
        "Times and versions",
        "scan and reconstruction",
        "pybullet 3.2.7",
    )
    at = 0
    for part in order:
        at = text.index(part, at)


def test_the_page_needs_nothing_else_and_says_what_pictures_show(tmp_path: Path) -> None:
    page = page_of(large_evaluation(tmp_path, n_seeds=1, n_variants=1), tmp_path)
    assert len(page.addresses) >= 44 and all(
        one.startswith("data:image/jpeg;base64,") for one in page.addresses
    )
    assert "script" not in page.tags and "link" not in page.tags
    assert all(page.names) and "svg" in page.tags


def test_45_objects_stay_below_3_mb(tmp_path: Path) -> None:
    path = write_outputs(large_evaluation(tmp_path, n_seeds=1, n_variants=1), tmp_path)
    assert path.stat().st_size < 3e6


def test_names_are_escaped(tmp_path: Path) -> None:
    assert "tissue &lt;box&gt;" in report_page(small_evaluation(), tmp_path)


def test_a_picture_that_cannot_be_read_spoils_nothing(tmp_path: Path) -> None:
    shown, damaged = (trial(name, "container", 80, picture=f"{name}.png") for name in ("good", "bad"))
    draw_picture(tmp_path / PICTURES_FOLDER / "good.png", shown)
    (tmp_path / PICTURES_FOLDER / "bad.png").write_bytes(b"\x89PNG\r\n\x1a\nxxxx")
    page = page_of(evaluation_of(shown, damaged, trial("none", "container", 80)), tmp_path)
    assert len(page.addresses) == 1 and page.text.count("no picture") == 2


def test_of_several_seeds_the_worst_is_shown(tmp_path: Path) -> None:
    found = evaluation_of(
        trial("mug", "container", 80, seed=0),
        trial("mug", "container", None, seed=1),
        trial("mug", "container", 60, seed=2, spilled=(1, 0, 0), in_cup=(0, 0, 0)),
        trial("mug", "container", 60, seed=3, spilled=(1, 1, 0), in_cup=(0, 0, 0)),
    )
    (card,) = cards_of(found, "imagination", tmp_path)
    assert card.state == "spilled" and "shown: seed 3, the worst" in card.seeds
    assert "right with 3 of 4 seeds, 6 of 9 pours clean" in card.seeds
    assert len(card.marks) == 2, "one failed and has no Omega"


def test_the_order_of_the_gallery(tmp_path: Path) -> None:
    cards = cards_of(small_evaluation(), "imagination", tmp_path)
    assert [(card.name, card.state) for card in cards] == [
        ("can", "misjudged"),
        ("tray", "misjudged"),
        ("bowl", "spilled"),
        ("bucket", "failed"),
        ("vase", "right"),
        ("mug", "right"),
        ("hammer", "right"),
        ("spoon", "right"),
        ("ball", "right"),
        ("brick", "right"),
        ("tissue <box>", "ambiguous"),
    ]


def test_sentences_of_a_card() -> None:
    right = trial("ball", "non-container", 10)
    assert judged_sentence(right).endswith(
        "0.050 is not more than the threshold of 0.05, so it was judged no container."
    )
    assert poured_sentence(right, N_POURS) == ""
    missed = trial("mug", "container", 2)
    assert poured_sentence(missed, N_POURS) == "Not poured into, which counts as spilled."
    assert poured_sentence(missed, 0) == ""
    once = trial("mug", "container", 90, spilled=(2,), in_cup=(0,))
    assert poured_sentence(once, 1) == "Poured once: 2 of 60 candies spilled."


def test_changed_parameters_and_the_honest_figure_are_told(tmp_path: Path) -> None:
    found = large_evaluation(tmp_path, n_seeds=1, n_variants=2, with_pictures=False)
    text = page_of(found, tmp_path).text
    assert "reconstruction.voxel_m 0.0031 m" in text
    assert "Accuracy, other objects" in text and "never fitted to" in text
    assert "(unanimous)" in text and "By method" in text


def test_the_histogram_counts_every_trial_once() -> None:
    found = Figures.of(small_evaluation().trials, N_POURS)
    chart = histogram(found)
    n_containers = sum(bar.count for bar in chart.bars if bar.is_container) + chart.n_zero_containers
    n_others = sum(bar.count for bar in chart.bars if not bar.is_container) + chart.n_zero_others
    assert (n_containers, n_others, chart.n_zero_others) == (4, 5, 2)
    below = [bar for bar in chart.bars if bar.x + bar.width <= chart.threshold.at]
    assert sum(bar.count for bar in below) == 3, "tray, spoon and hammer lie below the threshold"
    assert all(Histogram.LEFT <= bar.x <= Histogram.RIGHT - bar.width for bar in chart.bars)


def test_small_values_can_be_told_apart() -> None:
    assert place(0.0) == 0 and place(1.0) == 1
    assert place(0.01) == pytest.approx(0.1)
    assert place(0.2, 0.1) == 1, "what lies beyond the axis stays on it"


def test_the_rocs_ring_is_at_the_threshold() -> None:
    chart = roc_curve(Figures.of(small_evaluation().trials, N_POURS))
    assert chart is not None
    assert chart.at == pytest.approx((chart.LEFT + chart.SIDE / 5, chart.TOP + chart.SIDE / 4))
    assert "75.0 % of the containers and 20.0 % of the others" in chart.said
    assert roc_curve(Figures.of([trial("mug", "container", 9)], 1)) is None


def test_the_scatter_puts_what_has_not_changed_on_the_diagonal() -> None:
    pairs = ("same", "container", 0.3, 0.3), ("less", "container", 0.3, 0.1)
    chart = scatter(pairs, (0.05, 0.08), ("Omega", "Omega"))
    same, less = chart.dots
    assert same.x - chart.LEFT == pytest.approx(chart.TOP + chart.SIDE - same.y)
    assert less.x == same.x and less.y > same.y
    assert less.title == "less (container): 0.300 before, 0.100 after"


def test_an_evaluation_without_pours_or_others(tmp_path: Path) -> None:
    found = evaluation_of(trial("ball", "non-container", 0), n_pours=0, versions={}, seconds=7800.0)
    text = page_of(replace(found, source="mesh"), tmp_path).text
    assert "1 object, given as meshes, one seed" in text and "2 h 10 min" in text
    assert "there was no container to pour into" in text
    assert "There is no ROC curve" in text and "Nothing: every labelled object was judged right" in text
