import json
from dataclasses import replace

import pytest

from core.errors import SessionError
from core.imagination.amount.reasoning import reason_amount
from core.imagination.amount.result import SAFE, Amount, amount_sentence
from tests.core.imagination.amount.conftest import cylinder

SIXTY = Amount("60", 192, 150, 60, (60,), 0.4, 0.04, 60 / 192, "", "")


def test_a_table_is_json_and_comes_back(planned):
    amount = reason_amount(SAFE, cylinder(200), planned)
    assert amount.n_cups == 2
    table = json.loads(json.dumps(amount.to_table(), allow_nan=False))
    assert table["n_cups"] == 2
    assert Amount.from_table(table) == amount


@pytest.mark.parametrize("change", [{"n_total": None}, {"n_candy": 3}, {"n_per_cup": 3}])
def test_a_damaged_table_is_told(change):
    table = SIXTY.to_table() | change
    table = {name: value for name, value in table.items() if value is not None}
    with pytest.raises(SessionError, match="table of the amount is damaged"):
        Amount.from_table(table)


def test_the_sentence_of_one_cup():
    assert amount_sentence(SIXTY) == (
        "Put 60 candies into the cup: they fill it to 40 % of its height (31 % of the 192 that fit)."
    )
    one = replace(SIXTY, n_total=1, n_per_cup=(1,), fill_share=0.01, share_of_capacity=1 / 192)
    assert amount_sentence(one).startswith("Put 1 candy into the cup: it fills it to 1 %")


def test_the_sentence_of_several_cups_and_of_what_reaches_the_rim():
    amount = replace(SIXTY, n_total=145, n_per_cup=(50, 50, 45), fill_share=1.0, share_of_capacity=145 / 192)
    assert amount_sentence(amount) == (
        "Pour 3 cups of 50, 50 and 45 candies: they fill it to its rim (76 % of the 192 that fit)."
    )


def test_without_a_rim_no_height_is_told():
    assert amount_sentence(replace(SIXTY, fill_share=0.0)) == (
        "Put 60 candies into the cup: 31 % of the 192 that fit."
    )


def test_a_refusal_is_all_that_is_said():
    refused = replace(SIXTY, n_total=0, n_per_cup=(), refusal="Nothing may move.")
    assert amount_sentence(refused) == "Nothing may move."
