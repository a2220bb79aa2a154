import pytest

from core.errors import StageError
from core.imagination.amount.reasoning import cup_limit, is_one_cup_asked_for, plan_amount
from core.imagination.amount.result import PlannedAmount, amount_sentence
from core.parameters import Parameters, apply_settings
from tests.core.imagination.amount.conftest import cylinder


def asking(**pouring):
    return apply_settings(Parameters(), {f"pouring.{name}": value for name, value in pouring.items()})


def test_the_cup_gets_what_was_reasoned():
    capacity = cylinder(100)
    half = plan_amount(capacity, asking(amount="half"))
    assert (half.amount.n_total, half.n_pour, half.n_per_cup) == (50, 50, (50,))
    number = plan_amount(capacity, asking(n_pour=60, amount="number"))
    assert (number.amount.n_total, number.n_pour) == (60, 60)


def test_by_default_no_more_than_safely_fit_and_no_more_than_asked_for():
    roomy = plan_amount(cylinder(400), asking(n_pour=60))
    assert (roomy.amount.request, roomy.n_per_cup) == ("up to 60", (60,))
    assert "asked for" not in amount_sentence(roomy.amount)
    small = plan_amount(cylinder(40), asking(n_pour=60))
    assert small.n_pour == small.amount.n_total == small.amount.n_safe < 40
    assert amount_sentence(small.amount).endswith(
        f"60 candies were asked for; only {small.amount.n_safe} fit safely."
    )
    assert not small.amount.refusal


def test_what_one_cup_does_not_hold_is_poured_with_several():
    parameters = asking(n_pour=2 * cup_limit(Parameters()) - 1)
    assert not is_one_cup_asked_for(parameters)
    planned = plan_amount(cylinder(1000), parameters)
    assert len(planned.n_per_cup) == planned.amount.n_cups == 2
    assert planned.n_pour == cup_limit(Parameters())


def test_what_is_refused_may_be_looked_at():
    parameters = asking(n_pour=500, amount="number")
    planned = plan_amount(cylinder(100), parameters)
    assert "500" in planned.amount.refusal
    assert planned.n_pour == cup_limit(Parameters())


def test_an_amount_by_capacity_needs_one():
    parameters = apply_settings(asking(amount="safe"), {"containability.verdict": "omega"})
    with pytest.raises(StageError, match=r"containability\.verdict"):
        plan_amount(None, parameters)
    assert plan_amount(None, asking()) == PlannedAmount(60, None)


def test_an_amount_survives_the_disk(tmp_path):
    for planned in (plan_amount(cylinder(100), asking(amount="half")), PlannedAmount(60, None)):
        planned.save(tmp_path)
        assert PlannedAmount.load(tmp_path) == planned
