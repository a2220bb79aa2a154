import numpy as np
import pytest

from core.errors import StageError
from core.imagination.amount.reasoning import MOST_CUPS, cup_limit, reason_amount
from core.imagination.amount.result import HALF, SAFE, AmountRequest
from core.imagination.packing import cup_holds
from core.parameters import apply_settings
from tests.core.imagination.amount.conftest import capacity_of, cone, cylinder

LIMIT = 82


def number(n):
    return AmountRequest("number", n)


def with_n_pour(parameters, n):
    return apply_settings(parameters, {"pouring.n_pour": n})


def test_half_of_a_cylinder_is_half_of_its_height_and_of_a_cone_more(planned):
    half = reason_amount(HALF, cylinder(80), planned)
    assert (half.n_total, half.n_per_cup, half.n_fit) == (40, (40,), 80)
    assert half.fill_share == pytest.approx(0.5)
    assert half.fill_height_m == pytest.approx(0.05)
    assert half.share_of_capacity == pytest.approx(0.5)
    assert (half.warning, half.refusal) == ("", "")
    assert reason_amount(HALF, cone(80), planned).fill_share == pytest.approx(0.5 ** (1 / 3), abs=0.005)


def test_a_number_is_taken_as_asked_whatever_n_pour_says(planned):
    amount = reason_amount(number(17), cylinder(80), with_n_pour(planned, 500))
    assert (amount.n_total, amount.n_per_cup, amount.request) == (17, (17,), "17")
    assert amount.share_of_capacity == pytest.approx(17 / 80)
    assert amount.warning == ""


def test_the_cups_limit_is_the_last_number_it_has_room_for(planned):
    exact = apply_settings(planned, {"risk.candy_spread": 0.0})
    limit = cup_limit(with_n_pour(exact, 3))
    assert limit == 120
    assert cup_holds(with_n_pour(exact, limit))
    assert not cup_holds(with_n_pour(exact, limit + 1))


def test_the_cups_limit_leaves_room_for_larger_candies(planned):
    limit = cup_limit(planned)
    larger = apply_settings(
        planned, {"particle.diameter_m": 0.0132 * 1.05, "particle.height_m": 0.007 * 1.05}
    )
    assert limit == LIMIT < 120
    assert cup_holds(with_n_pour(larger, limit))
    assert not cup_holds(with_n_pour(larger, limit + 1))


def test_a_cup_smaller_than_a_candy_is_told(planned):
    small = apply_settings(planned, {"pouring.cup.mouth_radius_m": 0.01, "pouring.cup.length_m": 0.03})
    with pytest.raises(StageError, match="cannot hold a single candy; enlarge"):
        cup_limit(small)


@pytest.mark.parametrize(
    ("n", "cups"), [(82, (82,)), (83, (42, 41)), (185, (62, 62, 61)), (246, (82, 82, 82))]
)
def test_what_is_too_much_for_a_cup_goes_into_cups_of_about_equal_size(planned, n, cups):
    amount = reason_amount(number(n), cylinder(1000), planned)
    assert amount.n_per_cup == cups
    assert (amount.n_total, amount.n_cups) == (n, len(cups))
    assert amount.share_of_capacity == pytest.approx(n / 1000)


def test_more_cups_than_somebody_will_fill(planned):
    most = MOST_CUPS * LIMIT
    safe = reason_amount(SAFE, cylinder(8000, 0.15), planned)
    assert safe.n_safe > most
    assert safe.n_per_cup == (LIMIT,) * MOST_CUPS
    assert f"{MOST_CUPS} cups" in safe.warning
    assert f"{most}." in safe.warning
    assert reason_amount(number(most), cylinder(8000, 0.15), planned).refusal == ""
    refused = reason_amount(number(most + 1), cylinder(8000, 0.15), planned)
    assert refused.refusal.startswith(f"{most + 1} candies need more than {MOST_CUPS} cups")
    assert refused.n_per_cup == ()


def test_warnings_begin_where_errors_could_fill_it_and_tell_how_many_run_over(planned):
    capacity = cylinder(82, spread=1.0)
    # 80 / 1.05^3 = 69.1 are sure to fit.
    assert reason_amount(number(69), capacity, planned).warning == ""
    assert (
        "70 candies are nearly as many as the 82 that fit"
        in reason_amount(number(70), capacity, planned).warning
    )
    assert "nearly" in reason_amount(number(82), capacity, planned).warning
    over = reason_amount(number(90), capacity, planned)
    assert over.warning == "90 candies are more than the 82 that fit; up to 8 will run over."
    assert over.n_total == 90
    assert over.fill_share == 1.0


def test_1_3_times_an_odd_capacity_to_the_nearest_candy_is_warned_of(planned):
    # 1.3 * 82.4 = 107.1, 1.3 * 82 = 106.6.
    capacity = cylinder(82.4)
    assert "up to 25 will run over" in reason_amount(number(107), capacity, planned).warning
    assert reason_amount(number(108), capacity, planned).refusal


def test_1_3_times_the_capacity_is_warned_of_and_more_is_refused(planned):
    warned = reason_amount(number(130), cylinder(100), planned)
    assert "up to 30 will run over" in warned.warning
    assert warned.refusal == ""
    assert warned.n_total == 130
    refused = reason_amount(number(131), cylinder(100), planned)
    assert "131 candies are more than 1.3 times the 100 that fit: up to 31 would run over" in refused.refusal
    assert f"at most {refused.n_safe}" in refused.refusal
    assert (refused.n_total, refused.n_cups, refused.fill_share) == (0, 0, 0.0)
    assert (refused.share_of_capacity, refused.warning) == (0.0, "")


@pytest.mark.parametrize("request_", [SAFE, HALF, number(1)])
@pytest.mark.parametrize("n_candies", [0.0, 0.9])
def test_an_object_that_holds_nothing_is_refused(planned, request_, n_candies):
    amount = reason_amount(request_, capacity_of(n_candies), planned)
    assert amount.refusal.startswith("The object holds no candy")
    assert (amount.n_total, amount.n_per_cup) == (0, ())


@pytest.mark.parametrize("request_", [SAFE, HALF])
def test_at_least_one_candy(planned, request_):
    amount = reason_amount(request_, cylinder(1.0, 0.008, 0.01), planned)
    assert (amount.n_total, amount.refusal) == (1, "")


@pytest.mark.parametrize(("rim_m", "is_warned"), [(0.005, True), (0.0131, True), (0.0133, False)])
def test_a_rim_lower_than_a_candy_is_wide_is_told(planned, rim_m, is_warned):
    amount = reason_amount(SAFE, cylinder(100, 0.05, rim_m), planned)
    assert ("less than a candy is wide (13 mm)" in amount.warning) == is_warned
    assert amount.refusal == ""


def test_without_a_closed_rim_half_is_poured_with_a_warning(planned):
    amount = reason_amount(HALF, capacity_of(100.0), planned)
    assert (amount.n_total, amount.fill_share, amount.fill_height_m) == (50, 0.0, 0.0)
    assert amount.warning.startswith("The rim has gaps; a few candies may escape")


def test_a_refusal_never_advises_more_than_the_cups_hold(planned):
    refused = reason_amount(number(20_000), cylinder(8000, 0.15), planned)
    assert refused.refusal.endswith(f"ask for at most {MOST_CUPS * LIMIT}.")


def test_no_safe_amount_below_a_real_rim_is_warned_of(planned):
    for n in np.linspace(1, 400, 23):
        for capacity in (cylinder(n), cone(n), cylinder(n, 0.15, 0.02), cylinder(n, spread=n / 4)):
            amount = reason_amount(SAFE, capacity, planned)
            assert (amount.warning, amount.refusal) == ("", "")
            assert amount.n_total == amount.n_safe
