"""A level filling meets the inner walls, not the outer ones, a handle's or those of what holds nothing."""

from pathlib import Path

import numpy as np
import pytest

from core.files import read_arrays, write_arrays
from core.formats.arrays import check_arrays
from core.imagination.capacity.water import find_basin
from core.imagination.fill_line import fill_line
from core.imagination.hollow_map import HollowMap
from hardware.simulation.objects import builtin_object
from tests.core.imagination.capacity.conftest import turned

CANDY_M, POINTS = 0.0132, 400_000


@pytest.fixture(scope="module")
def cup():
    """80 mm wide inside and 80 mm deep, with walls of 2 mm."""
    return turned([(0, 0), (0.042, 0), (0.042, 0.082), (0.04, 0.082), (0.04, 0.002), (0, 0.002)])


@pytest.fixture(scope="module")
def hollows(cup) -> HollowMap:
    return find_basin(cup, CANDY_M, 1.0, POINTS).hollow_map


def length_m(line) -> float:
    return float(np.linalg.norm(line.ends_m[:, 1] - line.ends_m[:, 0], axis=1).sum())


def test_in_a_cup_it_goes_once_around_the_inside(cup, hollows):
    line = fill_line(cup, hollows, hollows.lowest_m + 0.02)
    assert length_m(line) == pytest.approx(2 * np.pi * 0.04, rel=0.01)
    np.testing.assert_allclose(line.ends_m[..., 2], hollows.lowest_m + 0.02)
    assert ((line.normals * line.ends_m.mean(axis=1)).sum(axis=1) < 0).all(), "they point into the hollow"


@pytest.mark.parametrize("above_m", [-0.001, 0.09])
def test_below_the_floor_and_above_the_rim_there_is_none(cup, hollows, above_m):
    assert length_m(fill_line(cup, hollows, hollows.lowest_m + above_m)) == 0


def test_a_mugs_handle_and_outside_have_none():
    mug = builtin_object("mug")
    hollows = find_basin(mug, CANDY_M, 1.0, POINTS).hollow_map
    line = fill_line(mug, hollows, hollows.lowest_m + 0.03)
    from_axis_m = np.linalg.norm(line.ends_m[..., :2].reshape(-1, 2), axis=1)
    assert np.ptp(from_axis_m) < 0.001, "one wall alone"
    outside_m = np.linalg.norm(mug.vertices_m[:, :2], axis=1)
    assert from_axis_m.max() < np.median(outside_m[outside_m > from_axis_m.max()])


def test_a_map_is_kept_in_a_file(hollows, tmp_path):
    write_arrays(tmp_path / "capacity.npz", **hollows.to_arrays())
    again = HollowMap.from_arrays(read_arrays(tmp_path / "capacity.npz"))
    np.testing.assert_allclose(again.rim_m, hollows.rim_m, atol=1e-6)
    np.testing.assert_allclose(again.floor_m, hollows.floor_m, atol=1e-6)
    np.testing.assert_array_equal(again.origin_m, hollows.origin_m)
    assert again.pitch_m == hollows.pitch_m
    np.testing.assert_array_equal(again.is_open, hollows.is_open)


def test_in_a_map_of_an_earlier_version_all_that_holds_is_open(hollows):
    arrays = {name: array for name, array in hollows.to_arrays().items() if name != "hollow_is_open"}
    again = HollowMap.from_arrays(arrays)
    np.testing.assert_array_equal(again.is_open, np.isfinite(hollows.rim_m))


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("hollow_pitch_m", np.array(0.0), "pitch"),
        ("hollow_rim_m", np.zeros((1, 1)), "another shape"),
        ("hollow_floor_m", np.full((3, 2), np.nan), "NaN"),
        ("hollow_is_open", np.zeros((1, 1), dtype=bool), "another shape"),
    ],
)
def test_a_damaged_map_is_refused(name, value, said):
    hollows = HollowMap(
        np.zeros(2), 0.01, np.full((3, 2), 0.04), np.full((3, 2), 0.01), np.ones((3, 2), dtype=bool)
    )
    arrays = {"heights_m": np.zeros(2), "volumes_ml": np.zeros(2), **hollows.to_arrays()}
    path = Path("judgement") / "capacity.npz"
    check_arrays(path, arrays)
    with pytest.raises(ValueError, match=said):
        check_arrays(path, arrays | {name: value})
