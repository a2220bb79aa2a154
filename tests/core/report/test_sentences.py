from dataclasses import replace

import numpy as np
import pytest

from core.imagination.results import Containability, PourChoice, PourGrid
from core.imagination.risk.result import PourRisk, joined
from core.imagination.verdict import Verdict
from core.report import (
    choice_sentence,
    omega_verdict_sentence,
    pours_sentence,
    risk_sentence,
    tries_sentence,
    verdict_parts,
    verdict_reason,
    verdict_sentence,
    verdict_summary,
    verdict_words,
)
from core.report.sentences import direction_text, duration_text, held_text, known_sentence, percent


def test_verdict(tray: Containability, block: Containability) -> None:
    assert verdict_sentence(tray) == (
        "Open container: 146 of 308 dropped candies stayed (Omega 0.47, the threshold is 0.00)."
    )
    assert verdict_sentence(block) == (
        "Not an open container: 0 of 64 dropped candies stayed (Omega 0.00, the threshold is 0.00)."
    )


def test_a_verdict_by_capacity_says_what_it_holds_and_the_papers_stands_beside(tray: Containability) -> None:
    holds = replace(tray, verdict=Verdict(0.634, 0.1, 137.2, 146.4))
    assert verdict_sentence(holds).replace("\u00a0", " ") == (
        "Open container: it holds 137 candies (146 ml). Hollow for 63 % of its bulk (containers: over 10 %)."
    )
    assert omega_verdict_sentence(holds).startswith(
        "By Omega an open container: 146 of 308 dropped candies stayed"
    )
    sieve = replace(tray, verdict=Verdict(0.634, 0.1, 137.2, 146.4, too_small_m=0.0066))
    assert verdict_sentence(sieve).replace("\u00a0", " ") == (
        "Open container: it holds 137 candies (146 ml). Candies of 7 mm would fall through its openings. "
        "Hollow for 63 % of its bulk (containers: over 10 %)."
    )
    lies_on = replace(tray, verdict=Verdict(0.034, 0.1, 47.0, 54.0))
    assert verdict_sentence(lies_on).replace("\u00a0", " ") == (
        "Not an open container: it holds 47 candies (54 ml). "
        "Hollow for 3 % of its bulk (containers: over 10 %)."
    )
    empty = replace(tray, verdict=Verdict(0.0, 0.1, 0.0, 0.0))
    assert verdict_sentence(empty).replace("\u00a0", " ") == (
        "Not an open container: hollow for 0 % of its bulk (containers: over 10 %)."
    )
    assert verdict_reason(empty, 5).endswith(" 5 lie on top; none would stay when it is tilted.")
    assert verdict_reason(lies_on, 7).endswith(" 7 lie on top, with no wall around them.")


def test_a_verdict_is_parted_into_a_headline_and_the_rest(tray: Containability) -> None:
    for verdict in (
        Verdict(0.634, 0.1, 137.2, 146.4, too_small_m=0.0066),
        Verdict(0.0, 0.1, 0.0, 0.0),
        Verdict(0.02, 0.1, 3.0, 3.2, unseen_ml=42.0, other_share=0.4),
        None,
    ):
        found = replace(tray, verdict=verdict)
        headline, further = verdict_parts(found)
        assert f"{headline} {further}".rstrip() == verdict_sentence(found)
        assert headline.endswith(".")
    assert verdict_parts(replace(tray, verdict=Verdict(0.634, 0.1, 137.2, 146.4)))[0] == (
        "Open container: it holds 137 candies (146 ml)."
    )
    assert verdict_parts(tray)[1] == ""


def test_tries_say_how_sure_a_pour_is(pours: PourGrid, choice: PourChoice) -> None:
    tries = [[[0] for _ in range(3)] for _ in range(8)]
    tries[choice.i][choice.j] = [0] * 13
    tries[7][2] = [0, 4, 2]
    risk = PourRisk(60, joined(tries))
    assert risk_sentence(pours, risk, choice, choice).endswith(
        "The paper's rule (largest P) chooses the same pour."
    )
    surest = tries_sentence(risk, choice.i, choice.j).replace("\u00a0", " ")
    assert surest == "Clean pour: at least 81 % likely (13 of 13 trials clean)."
    assert "(1 of 3 trials clean); 2.0 of 60 candies spilled on average." in tries_sentence(risk, 7, 2)
    assert tries_sentence(risk, 0, 0 if (choice.i, choice.j) != (0, 0) else 1).startswith("Tried once")
    other = replace(choice, i=7, j=2)
    assert "at 52 mm, clean in 1 of 3 trials." in risk_sentence(pours, risk, choice, other)


def test_close_verdict_shows_the_difference(tray: Containability) -> None:
    one = replace(tray, retained=np.arange(tray.n_drop) == 3)
    assert "(Omega 0.003, the threshold is 0.000)" in verdict_sentence(one)


def test_choice(pours: PourGrid, one_direction: PourGrid, choice: PourChoice) -> None:
    assert choice_sentence(pours, choice) == (
        "Pour from 34° (anticlockwise from the x-axis), 1.0 cm out from the footprint's centre: "
        "100 ± 0 % of the 60 candies land inside."
    )
    assert ": 100 % of the 60" in choice_sentence(one_direction, choice)


def test_why_there_is_no_pour(tray: Containability, block: Containability, pours: PourGrid) -> None:
    assert pours_sentence(block, None, None) == (
        "No pours were imagined because the object is not an open container."
    )
    assert "have not been imagined yet" in pours_sentence(tray, None, None)
    assert pours_sentence(tray, pours, None) == "Pours were imagined but none was chosen."


@pytest.mark.parametrize(
    ("angle_rad", "text"), [(0.0, "0°"), (-0.001, "0°"), (-0.2, "349°"), (6.283, "0°"), (7.0, "41°")]
)
def test_directions_are_whole_degrees(angle_rad: float, text: str) -> None:
    assert direction_text(angle_rad) == text


@pytest.mark.parametrize(
    ("verdict", "words"), [(True, "Open container"), (False, "Not a container"), (None, "No verdict yet")]
)
def test_the_verdict_in_two_or_three_words(verdict: bool | None, words: str) -> None:
    assert verdict_words(verdict) == words


@pytest.mark.parametrize(
    ("facts", "said"),
    [
        (
            (True, 0.4, 0.034, None, None),
            "Open container: 40 % of the candies stayed; in a container more than 3.4 % stay.",
        ),
        (
            (False, 0.4, 0.034, 0.05, 0.1),
            "Not a container: hollow for 5 % of its bulk (containers: over 10 %).",
        ),
        ((None, None, None, None, None), "No verdict yet: nothing has been imagined."),
    ],
)
def test_the_verdict_in_a_list_of_sessions(facts: tuple[float | None, ...], said: str) -> None:
    assert verdict_summary(*facts).replace("\u00a0", " ") == said  # type: ignore[arg-type]


def test_where_omega_decides_the_reason_says_what_had_to_stay(
    tray: Containability, block: Containability
) -> None:
    assert verdict_reason(tray, 0).replace("\u00a0", " ") == (
        "More than 0 % of the candies have to stay inside; 47 % did."
    )
    assert verdict_reason(block, 7).replace("\u00a0", " ") == (
        "More than 0 % of the candies have to stay inside; not one of the 64 did. "
        "7 lie on top, with no wall around them; the others fell past it or rolled off."
    )
    few = replace(block, retained=np.arange(block.n_drop) == 3, omega_threshold=0.03)
    assert "only 1.6 % did. The others fell past it" in verdict_reason(few, 0).replace("\u00a0", " ")
    # beside Omega's bar, which has the numbers
    assert verdict_reason(replace(tray, verdict=Verdict(0.6, 0.1, 137.2, 146.4)), 0) == (
        f"{omega_verdict_sentence(tray).partition(' (Omega')[0]}."
    )


@pytest.mark.parametrize(
    ("share", "text"),
    [(0, "0 %"), (0.03, "3 %"), (0.034, "3.4 %"), (0.004, "0.4 %"), (0.0001, "0.01 %"), (1, "100 %")],
)
def test_per_cent_have_the_decimals_they_need(share: float, text: str) -> None:
    assert percent(share).replace("\u00a0", " ") == text


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.2, "1 s"),
        (40.4, "40 s"),
        (59.6, "1 min"),
        (829, "14 min"),
        (3580, "1 h 0 min"),
        (4800, "1 h 20 min"),
    ],
)
def test_durations_are_said_as_people_say_them(seconds: float, text: str) -> None:
    assert duration_text(seconds) == text


def test_level_and_heap_are_two_figures_and_balls_make_no_heap(tray):
    pan = Verdict(0.9, 0.1, 1310.0, 1442.0, level_candies=740.0, level_ml=805.0)
    assert held_text(pan) == "level with its rim it holds 740 candies (805 ml), heaped 1310"
    assert held_text(replace(pan, has_stand_ins=True)) == "level with its rim it holds 740 candies (805 ml)"
    lid = Verdict(0.03, 0.1, 12.0, 13.0, level_candies=0.0, level_ml=0.0)
    assert held_text(lid) == "12 candies stay on it, with no closed rim around them"
    assert "level with its rim" in verdict_sentence(replace(tray, verdict=pan))


def test_what_was_not_seen_is_said_with_both_answers(tray):
    unseen = Verdict(0.02, 0.1, 3.0, 3.2, unseen_ml=240.0, other_share=0.6)
    assert verdict_sentence(replace(tray, verdict=unseen)) == (
        "Cannot tell: 240 ml inside were not seen. If that is solid, it is no container; if not, a "
        "container. Look again from further views."
    )
    bottomless = Verdict(0.6, 0.1, 90.0, 95.0, unseen_ml=40.0, other_share=0.0)
    found = replace(tray, verdict=bottomless)
    assert verdict_sentence(found).startswith(
        "Cannot tell: 40 ml inside were not seen. If that is solid, it is a"
    )
    assert not found.is_open_container
    assert pours_sentence(found, None, None) == (
        "No pours were imagined because too little of the inside was seen."
    )
    assert verdict_words(found.is_open_container, found.is_undecided) == "Cannot tell"


@pytest.mark.parametrize(
    ("known_s", "said"),
    [
        ({}, ""),
        ({"scan": 0.0}, ""),
        ({"judgement": 3.6}, "After the last view: the verdict 4 s."),
        (
            {"scan": 0.0, "reconstruction": 1.2, "judgement": 4.0, "pouring": 8.0, "risk": 75.0},
            "After the last view: the model 1 s, the verdict 4 s and the chosen pour 1 min.",
        ),
    ],
)
def test_it_is_said_when_each_answer_was_known(known_s: dict[str, float], said: str) -> None:
    assert known_sentence(known_s) == said
