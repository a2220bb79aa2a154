import numpy as np
import pytest

from core.imagination.choice import choose_pour
from core.imagination.recording import Recorder, Recording
from core.imagination.results import Footprint, PourGrid
from core.parameters import Parameters

CUP = Parameters().pouring.cup


def grid_of(counts, packings=1):
    n_in = np.repeat(np.array(counts, dtype=np.int64)[:, :, None], packings, axis=2)
    thetas = np.arange(len(counts)) * np.pi / 4
    pivots = np.zeros((len(counts), 3, 3))
    return PourGrid(60, n_in, 60 - n_in, thetas, np.array([0.01, 0.02, 0.03]), pivots, ())


def test_the_footprint_has_its_principal_axes():
    generator = np.random.default_rng(0)
    cloud = generator.normal(size=(4000, 2)) * [0.05, 0.01]
    c, s = np.cos(0.4), np.sin(0.4)
    footprint = Footprint.of(cloud @ np.array([[c, s], [-s, c]]) + [1, 2], 0.3)
    assert footprint.axis_rad == pytest.approx(0.4, abs=0.02)
    assert footprint.center_m == pytest.approx([1, 2, 0.3], abs=0.005)
    assert footprint.deviations_m == pytest.approx([0.05, 0.01], rel=0.05)


def test_a_footprint_of_one_candy_is_a_point():
    footprint = Footprint.of(np.array([[0.1, 0.2]]), 0.3)
    assert footprint.deviations_m.tolist() == [0, 0]
    assert np.isfinite(footprint.axis_rad)


def test_the_choice_is_the_papers_argmax():
    counts = np.zeros((8, 3), dtype=int)
    counts[3] = [60, 10, 10]  # the best single pour
    counts[5] = [30, 55, 20]  # the best direction
    choice = choose_pour(grid_of(counts), CUP)
    assert (choice.i, choice.j) == (5, 1)


def test_ties_go_to_the_smaller_indent_then_to_the_principal_axis():
    counts = np.full((8, 3), 20)
    counts[1] = [0, 0, 60]
    counts[6] = [60, 0, 0]
    assert choose_pour(grid_of(counts), CUP).i == 6
    counts[3] = counts[4] = counts[6]
    choice = choose_pour(grid_of(counts), CUP)
    assert (choice.i, choice.j) == (4, 0)


def test_among_the_pours_the_arm_can_make_the_same_rule_chooses():
    counts = np.full((8, 3), 30)
    counts[5] = [60, 59, 58]
    counts[2] = [50, 50, 50]
    all_but_direction_5 = np.ones((8, 3), dtype=bool)
    all_but_direction_5[5] = False
    assert choose_pour(grid_of(counts), CUP, np.ones((8, 3), dtype=bool)).i == 5
    assert choose_pour(grid_of(counts), CUP, all_but_direction_5).i == 2
    assert choose_pour(grid_of(counts), CUP, np.zeros((8, 3), dtype=bool)) is None


def test_a_direction_whose_good_pours_the_arm_cannot_make_does_not_win_by_them():
    counts = np.full((8, 3), 10)
    counts[5] = [60, 60, 50]
    counts[2] = [50, 50, 50]
    feasible = np.ones((8, 3), dtype=bool)
    feasible[5, :2] = False
    choice = choose_pour(grid_of(counts), CUP, feasible)
    assert (choice.i, choice.j) == (2, 0)
    feasible[5] = [False, True, False]
    choice = choose_pour(grid_of(counts), CUP, feasible)
    assert (choice.i, choice.j) == (5, 1), (
        "its one feasible pour is as good as its best: its sum still counts"
    )


def test_the_choice_survives_its_table():
    choice = choose_pour(grid_of(np.full((8, 3), 5)), CUP)
    again = type(choice).from_table(choice.to_table())
    assert (again.i, again.j, again.theta_rad) == (choice.i, choice.j, choice.theta_rad)
    assert again.T_world_cup == pytest.approx(choice.T_world_cup)


def test_a_recording_is_kept_to_a_tenth_of_a_millimetre():
    recorder = Recorder(3)
    poses = np.array([[0.12345, -0.5, 0.3, 0, 0, 0, 1], [1, 2, 3, 0.5, 0.5, 0.5, 0.5], [np.nan] * 7])
    recorder.add(0.0, poses, np.eye(4))
    kept = Recording.from_arrays(recorder.recording().to_arrays("x_"), "x_")
    assert kept.positions_m[0, :2] == pytest.approx(poses[:2, :3], abs=6e-5)
    assert np.isnan(kept.positions_m[0, 2]).all()
    assert kept.quaternions[0, :2] == pytest.approx(poses[:2, 3:], abs=1e-4)
