from dataclasses import replace
from math import nan

from core.imagination.capacity.imagine import Facts, explain

AGREEING = Facts(
    filled_ml=300,
    heaped_ml=0,
    has_stand_ins=False,
    water_ml=310,
    hollow_ml=310,
    narrow_ml=0,
    shaken_off_ml=0,
    left_below=0,
    water_level_m=0.08,
    rim_m=0.08,
    mouth_m=0.07,
    candy_m=0.0132,
)


def test_nothing_is_said_where_the_volumes_agree():
    assert explain(AGREEING) == ""
    assert explain(replace(AGREEING, filled_ml=0, water_ml=0, hollow_ml=0)) == ""


def test_more_than_water_by_a_gap():
    gap = explain(replace(AGREEING, water_ml=100, water_level_m=0.03))
    assert "water runs out 30 mm above the foot" in gap
    assert "held up to 80 mm" in gap
    assert "at the bottom" in explain(replace(AGREEING, water_ml=0, water_level_m=nan))


def test_a_heap():
    assert explain(replace(AGREEING, heaped_ml=90)) == "Candies for 90 ml lie heaped above the rim."
    assert explain(replace(AGREEING, heaped_ml=90, has_stand_ins=True)) == "", "balls heap otherwise"
    flat = replace(AGREEING, filled_ml=0, water_ml=0, heaped_ml=9, rim_m=nan)
    assert "nothing is closed all around" in explain(flat)


def test_less_than_water():
    less = replace(AGREEING, filled_ml=100)
    assert "too narrow for a candy" in explain(replace(less, narrow_ml=150))
    assert "take off candies for 180 ml" in explain(replace(less, shaken_off_ml=180))
    assert "50 % of the candies lost left lower than the rim" in explain(replace(less, left_below=0.5))
    assert "the mouth is 20 mm wide" in explain(replace(less, mouth_m=0.02))


def test_no_candy_where_water_is():
    none = replace(AGREEING, filled_ml=0)
    assert "no candy stays" in explain(none)
    assert "none of the candies that stay lies where water would" in explain(replace(none, heaped_ml=9))


def test_an_unexplained_difference_is_said_to_be_one():
    assert "neither" in explain(replace(AGREEING, filled_ml=100))
