from dataclasses import replace

import numpy as np
import pytest

from core.imagination.results import Containability, PourChoice, PourGrid
from core.report import choice_sentence, pours_sentence, verdict_sentence
from core.report.sentences import direction_text


def test_verdict(tray: Containability, block: Containability) -> None:
    assert verdict_sentence(tray) == (
        "Open container: 146 of 308 candies stayed (Omega 0.47, the threshold is 0.00)."
    )
    assert verdict_sentence(block) == (
        "Not an open container: 0 of 64 candies stayed (Omega 0.00, the threshold is 0.00)."
    )


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
