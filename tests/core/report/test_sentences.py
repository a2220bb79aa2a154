from dataclasses import replace

import numpy as np
import pytest

from core.imagination.results import Containability, PourChoice, PourGrid
from core.imagination.risk.results import PourRisk, joined
from core.imagination.verdict import Verdict
from core.report import (
    choice_sentence,
    paper_verdict_sentence,
    pours_sentence,
    risk_sentence,
    tries_sentence,
    verdict_sentence,
)
from core.report.sentences import direction_text


def test_verdict(tray: Containability, block: Containability) -> None:
    assert verdict_sentence(tray) == (
        "Open container: 146 of 308 candies stayed (Omega 0.47, the threshold is 0.00)."
    )
    assert verdict_sentence(block) == (
        "Not an open container: 0 of 64 candies stayed (Omega 0.00, the threshold is 0.00)."
    )


def test_a_verdict_by_capacity_says_what_it_holds_and_the_papers_stands_beside(tray: Containability) -> None:
    holds = replace(tray, verdict=Verdict(0.634, 0.1, 137.2, 146.4, 24, 1.0))
    assert verdict_sentence(holds).replace("\u00a0", " ") == (
        "Open container: it holds 137 candies (146 ml), 63 % of its convex hull; "
        "a container holds more than 10 %."
    )
    assert paper_verdict_sentence(holds).startswith("By the paper's rule an open container: 146 of 308")
    lies_on = replace(tray, verdict=Verdict(0.034, 0.1, 47.0, 54.0, 23, 0.105))
    assert verdict_sentence(lies_on).replace("\u00a0", " ") == (
        "Not an open container: it holds 47 candies (54 ml), 3 % of its convex hull; "
        "a container holds more than 10 %, and tilted by more than 6 degrees it loses candies."
    )
    empty = replace(tray, verdict=Verdict(0.0, 0.1, 0.0, 0.0, 0, 0.0))
    assert "it holds no candy; a container holds more than 10" in verdict_sentence(empty)


def test_tries_say_how_sure_a_pour_is(pours: PourGrid, choice: PourChoice) -> None:
    tries = [[[0] for _ in range(3)] for _ in range(8)]
    tries[choice.i][choice.j] = [0] * 13
    tries[7][2] = [0, 4, 2]
    risk = PourRisk(60, joined(tries))
    assert risk_sentence(pours, risk, choice, choice).endswith("The paper's rule chooses the same.")
    surest = tries_sentence(risk, choice.i, choice.j).replace("\u00a0", " ")
    assert "nothing was spilled, so it spills nothing in at least 81 %" in surest
    assert "in 1 of them, 2.0 of 60 candies on average" in tries_sentence(risk, 7, 2)
    assert tries_sentence(risk, 0, 0 if (choice.i, choice.j) != (0, 0) else 1).startswith("Tried once")
    other = replace(choice, i=7, j=2)
    assert "of whose 3 tries 1 spilled nothing" in risk_sentence(pours, risk, choice, other)


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
        "No pours were imagined because the object is no open container."
    )
    assert "run the same command to continue" in pours_sentence(tray, None, None)
    assert pours_sentence(tray, pours, None) == "Pours were imagined but none was chosen."


@pytest.mark.parametrize(
    ("angle_rad", "text"), [(0.0, "0°"), (-0.001, "0°"), (-0.2, "349°"), (6.283, "0°"), (7.0, "41°")]
)
def test_directions_are_whole_degrees(angle_rad: float, text: str) -> None:
    assert direction_text(angle_rad) == text
