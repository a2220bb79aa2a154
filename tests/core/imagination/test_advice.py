"""A pour is held against the chance of spilling nothing that is wanted."""

from dataclasses import replace

import numpy as np

from core.imagination.advice import advice_against
from core.imagination.risk.result import NOT_TRIED, FewerCandies, PourRisk

CLEAN, DOUBTFUL, SPILLING = (0, 0), (0, 1), (0, 2)
RISK = PourRisk(
    60,
    np.array([[[0] * 13, [0, 0, 0, 2] + [NOT_TRIED] * 9, [9, 4, 7, 5] + [NOT_TRIED] * 9]]),
)


def test_a_sure_pour_is_not_advised_against():
    assert advice_against(RISK, *CLEAN, 0.6) == ""


def test_the_sentence_has_the_bound_the_trials_and_what_is_wanted():
    said = advice_against(RISK, *DOUBTFUL, 0.6)
    bound = 100 * RISK.clean_at_least[DOUBTFUL]
    assert f"at least {bound:.0f} % likely (3 of 4 trials clean), and at least 60 % is wanted" in said
    assert "(0 of 4 trials clean)" in advice_against(RISK, *SPILLING, 0.6)


def test_whoever_wants_no_certainty_or_tries_nothing_gets_no_advice():
    assert advice_against(RISK, *SPILLING, 0.0) == ""
    assert advice_against(None, *SPILLING, 0.6) == ""


def test_a_smaller_amount_that_is_sure_enough_is_named_with_its_trials():
    said = advice_against(replace(RISK, fewer=FewerCandies(40, 2, 1, 8, 8)), *DOUBTFUL, 0.6)
    assert said.endswith("Ask for 40 candies: with these it is at least 72 % likely (8 of 8 trials clean).")
    assert "Ask for" not in advice_against(RISK, *DOUBTFUL, 0.6)
