from dataclasses import replace
from math import radians

import numpy as np
import pytest

from core.collision import from_parts
from core.imagination.body import body_files
from core.imagination.drop import imagine_drop
from core.imagination.retention.imagine import imagine_retention, load_starts, load_task
from core.imagination.retention.result import retention_sentence
from core.parameters import Parameters, apply_settings
from tests.core.imagination.conftest import box
from tests.core.imagination.here import at_rest, here

PARAMETERS = apply_settings(
    Parameters(),
    {
        "seed": 3,
        "particle.shape": "ellipsoid",
        "particle.diameter_m": 0.0132,
        "particle.height_m": 0.007,
        "containability.n_max": 60,
        "containability.n_min": 10,
        "containability.rotation_rad": 0.0,
        "containability.counted": "room_above",
        "holding.n_load": 12,
        "holding.settle_s": 1.0,
        "holding.tilt_step_rad": radians(6),
        "holding.tilt_max_rad": radians(60),
        "holding.hold_s": 0.2,
        "holding.rest_m_s": 0.05,
    },
)


@pytest.fixture(scope="module")
def found(dish):
    return imagine_drop(here(PARAMETERS), dish)


@pytest.fixture(scope="module")
def retention(dish, found):
    return imagine_retention(here(PARAMETERS), dish, found)


def test_a_dish_holds_all_of_a_modest_load_when_it_tilts_as_a_hand_tilts_it(retention):
    assert (retention.n_asked, retention.n_load) == (12, 12)
    assert retention.share_at(radians(30)).tolist() == [1.0] * 8
    assert retention.n_left.shape == (8, 11)
    assert (np.diff(retention.n_left, axis=1) <= 0).all()
    assert retention_sentence(retention) == "Nothing falls out, even tilted 60 degrees."


def test_the_directions_start_at_the_footprints_principal_axis(retention, found):
    assert retention.direction_rad[0] == found.footprint.axis_rad
    assert np.diff(retention.direction_rad) == pytest.approx(np.full(7, np.pi / 4))


def test_the_same_bit_for_bit_here_and_in_two_processes(dish, found, retention, pool):
    again = imagine_retention(replace(here(PARAMETERS), runner=pool), dish, found)
    assert again.n_load == retention.n_load
    assert np.array_equal(again.n_left, retention.n_left)
    assert np.array_equal(again.direction_rad, retention.direction_rad)


def test_candies_start_clear_of_each_other_above_the_middle_of_the_footprint(found):
    starts = load_starts(found, apply_settings(PARAMETERS, {"holding.n_load": 40}))
    assert starts.shape == (40, 3)
    assert starts[:, 2].min() > found.aabb_m[1, 2] + 0.007 / 2
    between = starts[:, None] - starts[None]
    flat, height = np.hypot(between[..., 0], between[..., 1]), np.abs(between[..., 2])
    touching = (flat < 0.0132) & (height < 0.007)
    assert touching.sum() == 40  # each with itself
    farthest = np.linalg.norm(starts[:, :2] - found.footprint.center_m[:2], axis=1).max()
    kept_from = found.drop_positions_m[found.retained, :2]
    assert farthest < np.linalg.norm(kept_from - found.footprint.center_m[:2], axis=1).max()


@pytest.mark.parametrize(("counted", "is_loaded"), [("centre", True), ("room_above", False)])
def test_a_hollow_filled_to_the_brim_has_a_load_only_where_the_drop_counts_it(counted, is_loaded):
    """The hollow is 9 mm deep: a candy's centre lies inside, that of another on top of it does not."""
    walls = (box((0, 0, 0), (0.005, 0.1, 0.014)), box((0.095, 0, 0), (0.1, 0.1, 0.014)))
    model = from_parts((box((0, 0, 0), (0.1, 0.1, 0.005)), *walls))
    centre = apply_settings(PARAMETERS, {"containability.counted": "centre"})
    found = imagine_drop(here(centre), model)
    assert found.n_in > 4
    with body_files(object=(model.parts, False)) as files:
        chosen = apply_settings(PARAMETERS, {"containability.counted": counted})
        task = load_task(at_rest(model, files["object"], chosen), found, chosen)
        load = task.function(*task.arguments)
    assert (len(load) > 4) is is_loaded


def test_where_no_candy_stayed_there_is_nothing_to_tilt(block):
    found = imagine_drop(here(PARAMETERS), block)
    assert found.n_in == 0
    with pytest.raises(ValueError, match="no candy stayed"):
        imagine_retention(here(PARAMETERS), block, found)
