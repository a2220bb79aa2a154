import pytest

from core.errors import StageError
from core.imagination.amount.deciding import decide_amount, is_number_in_one_cup
from core.imagination.amount.reason import cup_limit
from core.parameters import Parameters, apply_settings
from tests.core.imagination.amount.conftest import cylinder


def asking(**pouring):
    return apply_settings(Parameters(), {f"pouring.{name}": value for name, value in pouring.items()})


def test_the_cup_gets_what_was_reasoned():
    capacity = cylinder(100)
    amount, parameters = decide_amount(capacity, asking(amount="half"))
    assert (amount.n_total, parameters.pouring.n_pour) == (50, 50)
    amount, parameters = decide_amount(capacity, asking(n_pour=60))
    assert (amount.n_total, parameters.pouring.n_pour) == (60, 60)


def test_what_one_cup_does_not_hold_is_poured_with_several():
    parameters = asking(n_pour=2 * cup_limit(Parameters()) - 1)
    assert not is_number_in_one_cup(parameters)
    amount, decided = decide_amount(cylinder(1000), parameters)
    assert amount.n_cups == 2
    assert decided.pouring.n_pour == cup_limit(Parameters())


def test_what_is_refused_may_be_looked_at():
    parameters = asking(n_pour=500)
    amount, decided = decide_amount(cylinder(100), parameters)
    assert "500" in amount.refusal
    assert decided.pouring.n_pour == cup_limit(Parameters())


def test_an_amount_by_capacity_needs_one():
    parameters = apply_settings(asking(amount="safe"), {"containability.verdict": "omega"})
    with pytest.raises(StageError, match=r"containability\.verdict"):
        decide_amount(None, parameters)
    assert decide_amount(None, asking()) == (None, asking())
