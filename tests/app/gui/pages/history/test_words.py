from pathlib import Path

import pytest

from app.gui.pages.history import words
from app.library.summary import PourScore, SessionSummary

MADE = "2026-11-20T10:00:00+00:00"


def session(**facts):
    return SessionSummary(Path("/sessions/mug"), "mug", MADE, **facts)


def test_a_verdict_is_shown_with_its_numbers():
    found = session(is_open_container=True, omega=0.4, omega_threshold=0.034)
    assert words.verdict_sentence(found).replace("\xa0", " ") == (
        "Open container: 40 % of the candies stayed; in a container more than 3.4 % stay."
    )
    assert words.verdict_title(session(is_open_container=False)) == "Not a container"
    assert words.verdict_sentence(session()).startswith("No verdict yet")
    assert words.verdict_sentence(session(problem="damaged")) == "Cannot be read"


def test_every_verdict_has_a_sign_of_its_own():
    found = (
        session(problem="damaged"),
        *(session(is_open_container=is_one) for is_one in (True, False, None)),
    )
    assert len({words.verdict_mark(one)[0] for one in found}) == 4


def test_a_card_names_the_chosen_pour_before_the_best():
    assert (
        words.score_words(session(best=PourScore(0, 0, 1.0), chosen=PourScore(1, 0, 0.95)))
        == "Chosen pour: 95\xa0%"
    )
    assert words.score_words(session(best=PourScore(0, 0, 1.0))) == "Best pour: 100\xa0%"
    assert words.score_words(session()) == ""


def test_who_chose_is_shown():
    chosen = session(chosen=PourScore(1, 0, 0.95), operator_reason="the handle")
    assert words.chosen_words(chosen) == "95\xa0%, chosen by the operator: the handle"


@pytest.mark.parametrize(
    ("facts", "said"),
    [
        ({"is_open_container": True}, "Not poured yet"),
        ({"is_open_container": False}, ""),
        ({"n_runs": 1, "n_spilled": 0}, "Poured: none spilled"),
        ({"n_runs": 2, "n_spilled": 3}, "Poured: 3 spilled"),
        ({"n_runs": 1, "outcome": "Stopped before the first move."}, "Stopped before the first move."),
    ],
)
def test_an_outcome_fits_on_a_card(facts, said):
    assert words.outcome_words(session(**facts)) == said


def test_a_problem_is_shown_without_the_folder():
    broken = session(problem="/sessions/mug/session.json is damaged; delete it.")
    assert words.short_problem(broken) == "session.json is damaged; delete it."


@pytest.mark.parametrize(
    ("facts", "page"),
    [
        ({}, "scan"),
        ({"stages": ("scan",)}, "scan"),
        ({"stages": ("scan", "reconstruction", "collision")}, "reconstruction"),
        ({"stages": ("mesh", "collision", "containability", "pouring")}, "imagination"),
        ({"stages": ("mesh", "collision", "containability"), "best": PourScore(0, 0, 1.0)}, "pours"),
        ({"best": PourScore(0, 0, 1.0), "n_runs": 1}, "robot"),
    ],
)
def test_opening_leads_to_the_last_results(facts, page):
    assert words.results_page(session(**facts)) == page
