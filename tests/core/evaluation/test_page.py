"""The report of an evaluation: complete, in order, and in one file."""

from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

from core.evaluation.evaluation import PICTURES_FOLDER, Evaluation
from core.evaluation.outputs import write_outputs
from core.evaluation.pages.cards import cards_of, judged_sentence, poured_sentence
from core.evaluation.pages.charts import histogram, roc_curve, roc_sentence, scatter
from core.evaluation.pages.report import report_page
from core.evaluation.statistics import Figures
from tests.core.evaluation.evaluations import (
    N_POURS,
    draw_picture,
    evaluation_of,
    large_evaluation,
    small_evaluation,
    titles_of,
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
        "Non-containers that were poured into",
        "What went wrong",
        "24 of 200 candies stayed: Omega 0.120 is more than the threshold of 0.05",
        "8 of 200 candies stayed",
        "Poured 3 times: 0, 2 and 0 of 60 candies spilled (imagined: 98 % land inside). 1 stayed in the cup.",
        "Failed: The mesh cannot be read.",
        "Omega of containers and of others",
        "Judgements by label",
        "Judged right, and nothing spilled",
        "vase",
        "Ambiguous objects",
        "tissue <box>",
        "Parameters",
        "All have their default values.",
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
        "0.050 is not more than the threshold of 0.05, so it was judged not to be a container."
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
    chart = histogram(Figures.of(small_evaluation().trials, N_POURS))
    bars = [(int(title.split()[0]), title) for title in titles_of(chart)]
    n_others = sum(count for count, title in bars if "non-container" in title)
    assert (sum(count for count, _ in bars), n_others) == (7, 3)
    assert "2 at exactly 0" in chart and "0 at exactly 0" in chart and "threshold 0.05" in chart


def test_the_rocs_ring_is_at_the_threshold() -> None:
    found = Figures.of(small_evaluation().trials, N_POURS)
    said = "75.0 % of the containers and 20.0 % of the others"
    curve = roc_curve(found)
    assert curve is not None and said in roc_sentence(found)
    (title,) = titles_of(curve)
    assert said in title
    assert roc_curve(Figures.of([trial("mug", "container", 9)], 1)) is None


def test_the_scatter_names_every_object() -> None:
    pairs = ("<same>", "container", 0.3, 0.3), ("less", "ambiguous", 0.3, 0.1)
    chart = scatter(pairs, (0.05, 0.08), ("Omega", "Omega"), "Each object")
    assert titles_of(chart) == [
        "&lt;same&gt; (container): 0.300 before, 0.300 after",
        "less (ambiguous): 0.300 before, 0.100 after",
    ]
    assert "Omega before" in chart and 'aria-label="Each object"' in chart


def test_charts_take_the_pages_colours_and_are_the_same_every_time() -> None:
    found = Figures.of(small_evaluation().trials, N_POURS)
    chart = histogram(found)
    assert "var(--accent)" in chart and "#0000" not in chart
    assert chart == histogram(found)


def test_an_evaluation_without_pours_or_others(tmp_path: Path) -> None:
    found = evaluation_of(trial("ball", "non-container", 0), n_pours=0, versions={}, seconds=7800.0)
    text = page_of(replace(found, source="mesh"), tmp_path).text
    assert "1 object, given as meshes, one seed" in text and "2 h 10 min" in text
    assert "there was no container to pour into" in text
    assert "There is no ROC curve" in text and "Nothing: every labelled object was judged correctly" in text
