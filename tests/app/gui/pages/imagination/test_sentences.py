from types import SimpleNamespace

import pytest

from app.gui.pages.imagination.sentences import Sentences, percent


def reason(n_in, n_drop, threshold, n_on_top=0):
    omega = n_in / n_drop
    found = SimpleNamespace(
        n_in=n_in,
        n_drop=n_drop,
        omega=omega,
        omega_threshold=threshold,
        is_open_container=omega > threshold,
        verdict=None,
    )
    return Sentences().reason(found, n_on_top).replace("\u00a0", " ")


def test_a_container_is_told_by_what_had_to_stay_and_what_did():
    assert reason(156, 308, 0.03) == "More than 3 % of the candies have to stay inside; 51 % did."


def test_an_object_that_holds_nothing_says_where_the_candies_are():
    assert reason(0, 144, 0.0, 7) == (
        "More than 0 % of the candies have to stay inside; not one of the 144 did. "
        "7 lie on top, with no wall around them; the others fell past it or rolled off."
    )


def test_too_few_are_told_in_per_cent():
    assert "only 1 % did. The others fell past it" in reason(2, 200, 0.03)


@pytest.mark.parametrize(
    ("share", "text"), [(0, "0 %"), (0.03, "3 %"), (0.004, "0.4 %"), (0.0001, "0.01 %"), (1, "100 %")]
)
def test_per_cent_have_the_decimals_they_need(share, text):
    assert percent(share).replace("\u00a0", " ") == text
